// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

/// Returns what a move of the joints by `move`, rad, costs by the definition, without the rounding
/// of lattices: checks share nothing with planners.
inline double move_cost(const Cost& cost, const Chain& chain, const Config& move) {
  const std::array<double, kDof> weights = joint_weights(cost, chain);
  double squares = 0, sum = 0, most = 0;
  for (std::size_t j = 0; j < kDof; ++j) {
    const double dq = move[static_cast<Eigen::Index>(j)];
    const double scaled = cost.metric != CostMetric::kTime ? weights[j] * dq
                          : chain.roll && j + 1 == kDof    ? 0
                                                           : dq / chain.limit[j].velocity;
    squares += scaled * scaled;
    sum += std::abs(scaled);
    most = std::max(most, std::abs(scaled));
  }
  return cost.metric == CostMetric::kL2   ? std::sqrt(squares)
         : cost.metric == CostMetric::kL1 ? sum
                                          : most;
}

}  // namespace swivel
