// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "swivel/core/answer/refined.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"

namespace swivel {

/// The refined trajectories of two arms, and how they changed.
struct RefinedWorkcell {
  /// The rows of each arm, refined or not, with the cost before and now, and the work of all turns.
  std::array<Refined, 2> arms;
  int turns = 0;                     ///< times that both arms were refined, one after the other
  double cost_before = 0, cost = 0;  ///< of both paths together
};

/// Returns cheaper and smoother trajectories near valid ones of both arms: each is refined as
/// refine() does while the other one moves as it is given, in turns until one gains less than a
/// thousandth. The result is valid, between the arms as well, and never dearer. `rows` are those of
/// plan_workcell(). Throws as refine() does, InputError where the motion of an arm is given, and
/// Stopped.
[[nodiscard]] RefinedWorkcell refine_workcell(const PreparedWorkcell& prepared,
                                              const std::array<std::vector<TrajectoryRow>, 2>& rows,
                                              const Budget& budget = {});

}  // namespace swivel
