// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <vector>

#include "swivel/core/lattice/lattice.hpp"

namespace swivel::test {

/// Expresses a cost in steps of 2^-24 units of the lattice's costs, rounded to a whole number.
inline double in_steps(const Lattice& lattice, double x) {
  return std::round(std::ldexp(x / lattice.cost_unit(), 24));
}

/// Measures by the definition how far joints are from the middles of their ranges, weighted as
/// costs are, in steps of in_steps().
inline double off_middle(const Lattice& lattice, const Config& q) {
  double heaviest = 0, sum = 0;
  for (const double weight : lattice.cost_scale()) heaviest = std::max(heaviest, weight);
  for (std::size_t j = 0; j < kDof; ++j) {
    const JointLimit& limit = lattice.chain().limit[j];
    if (limit.continuous || limit.upper - limit.lower > 64 * kTwoPi) continue;
    const double weight = heaviest > 0 ? std::max(lattice.cost_scale()[j], 0.01 * heaviest) : 1;
    const double margin = lattice.limits().joint_margin, x = q[static_cast<Eigen::Index>(j)];
    double nearest = std::numeric_limits<double>::infinity();
    const int most =
        lattice.continuous()[j] ? 70 : 0;  // turns: a bounded joint may be taken as a circle
    for (int turn = -most; turn <= most; ++turn) {
      const double image = x + turn * kTwoPi;
      if (most > 0 && !(image >= limit.lower + margin && image <= limit.upper - margin)) continue;
      nearest = std::min(
          nearest, in_steps(lattice, weight * std::abs(image - (limit.lower + limit.upper) / 2)));
    }
    sum += nearest;
  }
  return sum;
}

/// Finds by the definition the node of layer 0 that the answer begins at; -1 where there is none.
/// Node k has the joints joints(k), and the cheapest path from it costs cost[k], infinity where
/// there is none.
template <class Joints>
int first_of_answer(const Lattice& lattice, const std::vector<double>& cost, const Joints& joints) {
  using Order = std::tuple<double, double, int>;  // coarse cost, off_middle, slot
  Order first{std::numeric_limits<double>::infinity(), 0, -1};
  for (int k = 0; k < static_cast<int>(cost.size()); ++k) {
    const double steps = in_steps(lattice, cost[static_cast<std::size_t>(k)]);
    if (steps <= std::get<0>(first) && std::isfinite(steps))
      first = std::min(first, Order{steps, off_middle(lattice, joints(k)), k});
  }
  return std::get<2>(first);
}

}  // namespace swivel::test
