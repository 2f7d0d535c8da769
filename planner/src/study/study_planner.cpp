// SPDX-License-Identifier: BSD-3-Clause
#include "study/study_planner.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "plan/require_no_hooks.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "workcell/plan_and_measure.hpp"

namespace swivel {

namespace {

StudiedAnswer plan_two_arms(const Problem& problem, const PlanOptions& options,
                            const Budget& budget) {
  const PreparedWorkcell prepared(problem, budget);
  const auto fault = fault_of_given_motion(prepared, budget);
  if (!fault) return {plan_workcell(prepared, options)};
  Answer barred;
  barred.arms.assign(2, {});
  for (std::size_t k = 0; k < 2; ++k) barred.arms[k].name = prepared.name(k);
  const std::size_t given = *prepared.given_arm();
  barred.arms[given].given = true;
  const std::string what = "given motion of '" + prepared.name(given) + "'";
  return {
      std::move(barred),
      StudyFailure{
          .reached_s = {}, .cause = "given_motion", .by = what, .reason = what + ": " + *fault}};
}

}  // namespace

bool StudiedAnswer::known(const Budget& budget) const {
  if (fault) return true;
  const bool decided =
      answer.status == PlanStatus::kSolved || answer.status == PlanStatus::kInfeasible;
  if (!decided || !answer.time_ms.contains("report")) return false;
  const auto explained = [](const RunAnswer& run) {
    return (!run.diagnosis || run.diagnosis->complete) && words_of_unmeasured(run).empty();
  };
  return !budget.spent() ||
         std::all_of(answer.arms.begin(), answer.arms.end(), [&](const ArmAnswer& arm) {
           return std::all_of(arm.runs.begin(), arm.runs.end(), explained);
         });
}

StudyPlanner::StudyPlanner(std::shared_ptr<const PreparedRobot> robot, const Problem& like,
                           const PlanOptions& options, std::shared_ptr<LatticeCache> lattices)
    : robot_(std::move(robot)) {
  validate(like);
  if (like.arms.size() == 2) {
    require_no_hooks(options);
    return;
  }
  const PathProblem first = problem_of_run(like, {0, false});
  robot_->require_prepared_for(first);
  if (!is_path(like)) return;
  planner_.emplace(robot_, first);
  if (lattices) planner_->share_lattices(std::move(lattices));
}

StudiedAnswer StudyPlanner::plan(const Problem& problem, const PlanOptions& options,
                                 const Budget& budget) {
  if (!robot_) return plan_two_arms(problem, options, budget);
  if (!planner_) return {plan_job(*robot_, problem, options)};
  planner_->set_problem(problem_of_run(problem, {0, false}));
  return {answer_of(planner_->plan(options))};
}

}  // namespace swivel
