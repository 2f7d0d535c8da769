// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/problem/given_answer.hpp"

#include <utility>
#include <vector>

#include "problem/given_rows.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/complete_job.hpp"
#include "swivel/planner/verify/complete_rows.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "swivel/planner/workcell/complete_workcell.hpp"

namespace swivel {

namespace {

/// Completes the rows or the motion of an arm with strokes.
void complete_strokes(const PreparedRobot& robot, const Problem& problem, GivenArm& arm,
                      const Budget& budget) {
  if (!arm.motion) {
    for (Part& part : arm.parts)
      if (part.run && !arm.states_directions)
        part.run->reversed = begins_at_last_waypoint(robot, problem, part.run->stroke, part.rows);
    arm.parts = complete_parts(robot, problem, std::move(arm.parts), arm.stated, budget);
    return;
  }
  if (!arm.states_directions) {
    std::vector<std::size_t> strokes;
    for (const StrokeRun& run : arm.order) strokes.push_back(run.stroke);
    arm.order = runs_of_motion(robot, problem, strokes, *arm.motion);
  }
  arm.motion =
      complete_job_motion(robot, problem, arm.order, *std::move(arm.motion), arm.stated, budget);
}

void complete_two_arms(const PreparedWorkcell& prepared, GivenAnswer& given, const Budget& budget) {
  if (given.has_times()) {
    auto motions = complete_motion(prepared, timed_of_both(given), stated_of_both(given), budget);
    for (std::size_t k = 0; k < 2; ++k) given.arms[k].motion->rows = std::move(motions[k]);
  } else {
    auto rows = complete_rows(prepared, rows_of_both(given), stated_of_both(given), budget);
    for (std::size_t k = 0; k < 2; ++k) given.arms[k].parts.front().rows = std::move(rows[k]);
  }
}

AnswerCheck check_path(const PreparedRobot& robot, const GivenAnswer& given,
                       const CheckOptions& options) {
  const PathProblem path = path_of(given);
  const GivenArm& arm = given.arms.front();
  AnswerCheck check;
  check.runs.push_back(arm.motion ? check_motion(robot, path, arm.motion->rows, options)
                                  : check_trajectory(robot, path, arm.parts.front().rows, options));
  check.passed = check.runs.front().passed;
  check.cost = check.runs.front().cost;
  return check;
}

AnswerCheck check_strokes(const PreparedRobot& robot, const GivenAnswer& given,
                          const CheckOptions& options) {
  const GivenArm& arm = given.arms.front();
  if (arm.motion) return check_job_motion(robot, given.problem, arm.order, *arm.motion, options);
  AnswerCheck check = check_job(robot, given.problem, arm.parts, options);
  check_process(given.problem, arm.parts, arm.process, check);
  return check;
}

}  // namespace

GivenAnswer complete_answer(const PreparedProblem& prepared, GivenAnswer given,
                            const Budget& budget) {
  if (prepared.has_two_arms()) {
    complete_two_arms(prepared.two_arms(), given, budget);
    return given;
  }
  const PreparedRobot& robot = prepared.robot();
  GivenArm& arm = given.arms.front();
  if (!is_path(given.problem))
    complete_strokes(robot, given.problem, arm, budget);
  else if (arm.motion)
    arm.motion->rows =
        complete_motion(robot, path_of(given), std::move(arm.motion->rows), arm.stated, budget);
  else
    arm.parts.front().rows =
        complete_rows(robot, path_of(given), std::move(arm.parts.front().rows), arm.stated, budget);
  return given;
}

AnswerCheck check_answer(const PreparedProblem& prepared, const GivenAnswer& given,
                         const CheckOptions& options) {
  if (prepared.has_two_arms())
    return given.has_times()
               ? check_workcell_motion(prepared.two_arms(), timed_of_both(given), options)
               : check_workcell(prepared.two_arms(), rows_of_both(given), options);
  return is_path(given.problem) ? check_path(prepared.robot(), given, options)
                                : check_strokes(prepared.robot(), given, options);
}

}  // namespace swivel
