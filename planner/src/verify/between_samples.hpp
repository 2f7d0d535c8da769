// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>

#include "swivel/collision/world/world.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"

namespace swivel {

/// The problem as it is asked of samples, from which joints move straight to the next: they are so near each other that motions
/// are proved within the band by which clearances may be missed.
inline Problem problem_of_samples(const Problem& problem) {
  Problem of_samples = with_motion_defaults(problem);
  of_samples.limits.edge_tolerance = std::min(problem.limits.edge_tolerance, kVerdictBand);
  return of_samples;
}

}  // namespace swivel
