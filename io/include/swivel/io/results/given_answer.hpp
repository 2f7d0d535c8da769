// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <vector>

#include "swivel/core/answer/given_answer.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

/// Loads a trajectory or a motion of a problem: all that Swivel writes, and files of other
/// programs, as load_trajectory_file(), load_executed_rows() and load_workcell_rows() do.
/// `joint_names` has those of each arm. Throws InputError as they do, and for a stroke that the
/// problem does not have.
[[nodiscard]] GivenAnswer load_answer(const std::filesystem::path& file, const Problem& problem,
                                      const std::vector<JointNames>& joint_names);

}  // namespace swivel::io
