// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

/// Says which joints of the last row of a closed path differ from those of the first; nothing if
/// none do. Joints agree within 1e-9 rad; those without limits may be whole turns away.
inline std::vector<std::string> faults_of_closed_ends(const Chain& chain,
                                                      const std::vector<TrajectoryRow>& rows) {
  constexpr double kSame = 1e-9;  // rad
  std::vector<std::string> faults;
  for (std::size_t j = 0; j < kDof; ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    double by = rows.back().q[k] - rows.front().q[k];
    if (chain.limit[j].continuous) by = std::remainder(by, kTwoPi);
    if (!(std::abs(by) <= kSame))
      faults.push_back(
          formatted("row %zu, the last: joint '%s' is %.3g rad from the first row, "
                    "and the path is closed",
                    rows.size() - 1, chain.joint_names[j].c_str(), by));
  }
  return faults;
}

/// Says which of the postures that a problem gives, its start and its end, the first and the last
/// of these rows do not have, and where rows of a closed path do not close; nothing if they have
/// both and close. Joints agree with given ones within 1e-6 rad; at the end those without limits,
/// and those of over 64 turns, may be whole turns away. There must be rows.
inline std::vector<std::string> faults_of_given_ends(const PathProblem& problem, const Chain& chain,
                                                     const std::vector<TrajectoryRow>& rows) {
  constexpr double kSame = 1e-6;  // rad
  std::vector<std::string> faults;
  if (problem.closed) faults = faults_of_closed_ends(chain, rows);
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
