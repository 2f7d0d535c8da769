// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/motion.hpp"

namespace swivel {

/// Returns a line about the motion of a job with these parts: how long it takes on strokes (their
/// lines of approach and retract included) and in transitions; or which part has none, and why.
[[nodiscard]] std::string job_motion_text(const MotionTiming& timing,
                                          const std::vector<Part>& parts, const Problem& job);

}  // namespace swivel
