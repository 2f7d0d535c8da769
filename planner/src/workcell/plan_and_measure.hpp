// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "swivel/planner/workcell/time_workcell.hpp"

namespace swivel {

/// Plans a workcell as plan_workcell() does, but does not diagnose an arm that has no path by
/// itself, and measures nothing. Returns and throws as plan_workcell() does.
[[nodiscard]] Answer decide_workcell(const PreparedWorkcell& prepared, const PlanOptions& options,
                                     const Budget& budget);
/// Refines rows at the layers of both paths and times them: again with more clearance where bodies
/// come too near between samples. Throws as refine_workcell() and time_workcell() do.
[[nodiscard]] RefinedWorkcellMotion refine_until_timed(
    const PreparedWorkcell& prepared, const std::array<std::vector<TrajectoryRow>, 2>& rows,
    const TimingOptions& options, const Budget& budget);
/// Returns why the given motion of a workcell does not keep the limits of its arm by itself, with
/// the row at fault; nothing where it does, or none is given. plan_workcell() refuses such a one.
/// Throws Stopped.
[[nodiscard]] std::optional<std::string> fault_of_given_motion(const PreparedWorkcell& prepared,
                                                               const Budget& budget);
/// Measures the trajectories of a result, of each arm by itself and between both, as far as
/// `wanted` asks for it. Throws Stopped.
void measure_workcell(const PreparedWorkcell& prepared, const Evidence& wanted,
                      const Budget& budget, Answer& result);
/// Finds the row and the bodies of both arms with the least margin. Throws Stopped.
void measure_between_arms(const PreparedWorkcell& prepared, const Budget& budget, Answer& result);

}  // namespace swivel
