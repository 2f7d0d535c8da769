// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/answer/given_answer.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/planner/problem/prepared_problem.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {

/// Computes what `given` does not state of its rows, as complete_rows(), complete_motion(),
/// complete_parts() and complete_job_motion() do, and which strokes are run backwards: those at
/// whose last waypoint the tool begins. `prepared` is that of given.problem; of two arms whose rows
/// have times, that of with_motion_defaults(given.problem). Throws as those functions do.
[[nodiscard]] GivenAnswer complete_answer(const PreparedProblem& prepared, GivenAnswer given,
                                          const Budget& budget = {});

/// Proves an answer from its problem alone, or tells what is wrong with it: one path as
/// check_trajectory() and check_motion() do, strokes as check_job(), check_process() and
/// check_job_motion(), two arms as check_workcell() and check_workcell_motion(). `given` is
/// complete_answer(), `prepared` as there. Throws as those functions do.
[[nodiscard]] AnswerCheck check_answer(const PreparedProblem& prepared, const GivenAnswer& given,
                                       const CheckOptions& options = {});

}  // namespace swivel
