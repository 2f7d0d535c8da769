// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "robots.hpp"

namespace swivel::test {

/// Draws a posture near the middles of the joints' ranges, with joints 2, 4 and 6 bent by some 0.8
/// rad. A slide is within a third of its range of the middle.
inline Config inner_posture(const Chain& chain, Random& random) {
  Config q;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    const double middle = limit.continuous ? 0 : (limit.lower + limit.upper) / 2;
    q[j] = middle + random.uniform(-0.6, 0.6) +
           (j == 1 || j == 3 || j == 5 ? (random.coin() ? 0.8 : -0.8) : 0.0);
    if (limit.slides) q[j] = middle + random.uniform(-1, 1) * (limit.upper - limit.lower) / 3;
  }
  return q;
}

/// Draws a vector of any direction with this length.
inline Vector3d random_vector(Random& random, double length) {
  return length *
         Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
}

}  // namespace swivel::test
