// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// Says which of the postures that a problem gives, its start and its end, the first and the last
/// of these rows do not have; nothing if they have both. Joints agree within 1e-6 rad; at the end
/// those without limits, and those of over 64 turns, may be whole turns away. There must be rows.
inline std::vector<std::string> faults_of_given_ends(const Problem& problem, const Chain& chain,
                                                     const std::vector<TrajectoryRow>& rows) {
  constexpr double kSame = 1e-6;  // rad
  std::vector<std::string> faults;
  if (problem.start && !((rows.front().q - *problem.start).lpNorm<Eigen::Infinity>() <= kSame))
    faults.emplace_back("row 0: joints are not the given start");
  if (!problem.end) return faults;
  Config off = rows.back().q - *problem.end;
  for (std::size_t j = 0; j < kDof; ++j) {
    double& by = off[static_cast<Eigen::Index>(j)];
    if (chain.limit[j].continuous || chain.limit[j].wide()) by = std::remainder(by, kTwoPi);
  }
  if (!(off.lpNorm<Eigen::Infinity>() <= kSame))
    faults.push_back(formatted("row %zu, the last: joints are not the given end", rows.size() - 1));
  return faults;
}

}  // namespace swivel
