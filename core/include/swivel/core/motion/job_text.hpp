// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "swivel/core/answer/job_result.hpp"
#include "swivel/core/motion/job_motion.hpp"

namespace swivel {

/// Returns the answer of a job for people: first the verdict, then a table with a line for each
/// stroke, in the order in which they are run, and a line about the transitions. Where there is no
/// motion it says which stroke has no path and why, or between which two there is no way.
[[nodiscard]] std::string job_text(const JobResult& result, const Problem& job);

/// Returns a line about the motion of a job with these parts: how long it takes on strokes (their
/// lines of approach and retract included) and in transitions; or which part has none, and why.
[[nodiscard]] std::string job_motion_text(const JobTimingResult& timing,
                                          const std::vector<JobPart>& parts, const Problem& job);

}  // namespace swivel
