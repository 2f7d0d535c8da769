// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/given_answer.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/planner/problem/prepared_problem.hpp"
#include "swivel/planner/problem/problem_planner.hpp"

namespace swivel {

/// An answer that was timed.
struct TimedAnswer {
  /// Its parts are at the layers that were timed; it has the refinement and the motion that were
  /// asked for, and nothing of what a search finds out.
  Answer answer;
  /// Why the motion of strokes does not pass check_job_motion(): transitions of rows without times
  /// may keep less clearance than motions must. Empty where it passes, and where it is not checked.
  std::string fault;
};
/// Makes the rows of an answer, whose own times are left aside, a motion in time; refines them
/// before if asked. `asked.timing` must be set. Where `proves`, the motion is checked.
/// `prepared` is that of given.problem; of two arms that of with_motion_defaults(given.problem).
/// Throws as complete_answer(), rows_at_layers(), refine(), time_trajectory(), time_job() and
/// time_workcell() do, InputError for strokes that do not pass check_job(), and std::logic_error
/// where the motion of one path or of two arms does not pass its check.
[[nodiscard]] TimedAnswer time_answer(const PreparedProblem& prepared, GivenAnswer given,
                                      const MotionRequest& asked, bool proves,
                                      const Budget& budget = {});

}  // namespace swivel
