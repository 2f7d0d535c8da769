// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/plan/plan_options.hpp"
#include "swivel/planner/plan/problem_view.hpp"

namespace swivel {

class PreparedRobot;

/// Plans the strokes of a job: in their order, or in the cheapest one that is found, with lift-offs
/// where the job allows and needs some. With `one_branch`, no run of an S-R-S arm changes its
/// branch, and there must be no check by the caller's hook. `view`, if given, gets what was found
/// out about the runs.
[[nodiscard]] Answer plan_strokes(const PreparedRobot& robot, const Problem& job,
                                  const PlanOptions& options, const Budget& budget, bool one_branch,
                                  ProblemView* view);

}  // namespace swivel
