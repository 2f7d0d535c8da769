// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"

namespace swivel {

/// A lattice's path, refined or not, and how it changed.
struct Refined {
  std::vector<TrajectoryRow> rows;         ///< the refined rows, or those given
  std::vector<TrajectoryRow> rows_before;  ///< those given
  bool refined = false;
  std::string reason;                ///< why the rows are those given
  double cost_before = 0, cost = 0;  ///< by the problem's cost metric
  /// The largest second divided difference of the joints over the tool's travel, rad/m^2.
  double bend_before = 0, bend = 0;
  int rounds = 0;  ///< rounds of optimising and asking
  std::int64_t nodes_asked = 0, edges_asked = 0;
  bool from_second_seed = false;
};

/// The refined trajectories of the arms of an answer, and how they changed.
struct RefinedArms {
  /// The rows of each arm, refined or not, with the cost before and now, and the work of all turns.
  std::vector<Refined> arms;
  int turns = 0;                     ///< times that both arms were refined, one after the other
  double cost_before = 0, cost = 0;  ///< of all arms together
  /// Returns whether the rows of any arm are refined ones.
  [[nodiscard]] bool any() const {
    return std::any_of(arms.begin(), arms.end(), [](const Refined& arm) { return arm.refined; });
  }
};

}  // namespace swivel
