// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/plan.hpp"

namespace swivel::test {

/// Returns the cost of rows by the definition: seven joints of weight 1, or six and a roll of
/// weight 0.
inline double cost_of_joints(const std::vector<TrajectoryRow>& rows, bool six) {
  double sum = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    Config move = rows[i].q - rows[i - 1].q;
    if (six) move[kDof - 1] = 0;
    sum += joint_norm(move);
  }
  return sum;
}

}  // namespace swivel::test
