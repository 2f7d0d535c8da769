// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>

#include "swivel/collision/world/world.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"

namespace swivel {

/// Returns the problem that samples of a timed motion are checked against: completed by
/// with_motion_defaults(), with an edge tolerance of at most kVerdictBand. Samples are so near each
/// other that motions between them can be proved with the band by which clearances may be missed.
inline PathProblem problem_of_samples(const PathProblem& problem) {
  PathProblem of_samples = with_motion_defaults(problem);
  of_samples.limits.edge_tolerance = std::min(problem.limits.edge_tolerance, kVerdictBand);
  return of_samples;
}

}  // namespace swivel
