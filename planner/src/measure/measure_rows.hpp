// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

/// Notes in measures.asked what `wanted` selects of rows, and in measures.evidence what is known
/// before they are looked at: that no bodies touch if none may.
void ask_for(const Evidence& wanted, bool may_touch, Measures& measures);

/// Computes what `wanted` selects for rows at the layers of the path, and records in
/// measures.evidence what is known. Throws Stopped.
void measure_rows(const PreparedRobot& robot, const ToolPath& path, const World& world,
                  const std::vector<TrajectoryRow>& rows, const Evidence& wanted,
                  const Budget& budget, Measures& measures);

/// Fills in measures.nearest_limit and measures.top_tool_speed, which takes hardly any time.
void measure_margins(const Chain& chain, const ToolPath& path,
                     const std::vector<TrajectoryRow>& rows, Measures& measures);

}  // namespace swivel
