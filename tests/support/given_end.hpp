// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "robots.hpp"

namespace swivel::test {

/// Ends the path in a posture at its last waypoint where the joints' limits and margins allow it.
inline void end_at(PathProblem& problem, const Chain& chain, const Config& q) {
  bool fits = true;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    fits = fits && (limit.continuous || (q[j] >= limit.lower + problem.limits.joint_margin &&
                                         q[j] <= limit.upper - problem.limits.joint_margin));
  }
  if (fits) problem.end = q;
}

}  // namespace swivel::test
