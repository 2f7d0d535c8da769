// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "swivel/core/answer/refined.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"

namespace swivel {

/// Returns cheaper and smoother trajectories near valid ones of both arms: each is refined as
/// refine() does while the other one moves as it is given, in turns until one gains less than a
/// thousandth. The result is valid, between the arms as well, and never dearer. `rows` are those of
/// plan_workcell(). `extra_clearance`: RefineOptions::extra_clearance of both arms, m, between the
/// arms as well. Throws as refine() does, InputError where the motion of an arm is given, and
/// Stopped.
[[nodiscard]] RefinedRuns refine_workcell(const PreparedWorkcell& prepared,
                                          const std::array<std::vector<TrajectoryRow>, 2>& rows,
                                          const Budget& budget = {},
                                          double extra_clearance = RefineOptions{}.extra_clearance);

}  // namespace swivel
