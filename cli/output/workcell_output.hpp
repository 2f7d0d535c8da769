// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/motion.hpp"
#include "swivel/core/answer/refined.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::cli {

/// Returns what refining the arms of a workcell brought, for people. `names` are those of both
/// arms.
[[nodiscard]] std::string refined_workcell_text(const RefinedArms& refined,
                                                const std::array<std::string, 2>& names);

/// Returns the figures of a workcell's motion for people, or why there is none. `joint_names` and
/// `names` are those of both arms.
[[nodiscard]] std::string workcell_motion_text(const MotionTiming& timing,
                                               const std::array<io::JointNames, 2>& joint_names,
                                               const std::array<std::string, 2>& names);

}  // namespace swivel::cli
