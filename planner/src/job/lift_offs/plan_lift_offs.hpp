// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/plan/plan_options.hpp"
#include "swivel/planner/plan/problem_view.hpp"

namespace swivel {

class PreparedRobot;

/// Plans a job by `plan`; where Problem::lift allows it and strokes have no path by themselves,
/// with the least number of lift-offs of these strokes, at the cheapest places found. `plan` gets a
/// job without strokes to be cut, and a view to fill or null.
[[nodiscard]] Answer plan_with_lift_offs(
    const PreparedRobot& robot, const Problem& job, const PlanOptions& options,
    const Budget& budget, ProblemView* view,
    const std::function<Answer(const Problem&, ProblemView*)>& plan);

}  // namespace swivel
