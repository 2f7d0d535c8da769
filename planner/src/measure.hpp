// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/collision/world.hpp"
#include "swivel/core/budget.hpp"
#include "swivel/core/plan.hpp"
#include "swivel/core/tool_path.hpp"
#include "swivel/planner/prepared_robot.hpp"

namespace swivel {

/// What `wanted` asks for of result.trajectory, whose rows are the layers of the path; fills it in, and says in result.evidence
/// what is known. Throws Stopped.
void measure(const PreparedRobot& robot, const ToolPath& path, const World& world, const Evidence& wanted, const Budget& budget,
             PlanResult& result);

/// Fills nearest_limit and top_tool_speed of a result that has its trajectory.
void measure_margins(const Chain& chain, const ToolPath& path, PlanResult& result);

}  // namespace swivel
