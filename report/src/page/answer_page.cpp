// SPDX-License-Identifier: BSD-3-Clause
#include "page/job_page.hpp"
#include "page/workcell_page.hpp"
#include "swivel/report/page.hpp"

namespace swivel {

std::string to_page(const ProblemPlanner& planner, const Answer& answer,
                    const std::string& result_json, const LatticeMap* map, const Budget& budget,
                    const PageWords& words) {
  const ProblemView& view = planner.view();
  const Problem problem = executed_problem(planner.problem(), answer);
  const Motion* const motion = answer.timed();
  if (problem.arms.size() == 2)
    return to_workcell_page({planner.two_arms(), problem, answer, view, motion}, result_json,
                            budget, words);
  const ArmMotion* const of_arm = motion != nullptr ? &motion->arms.front() : nullptr;
  if (!is_path(problem))
    return to_job_page({planner.robot(), problem, answer, view, of_arm}, result_json, budget,
                       words);
  const PageMotion shown{.refined = answer.refined ? &answer.arm().rows() : nullptr,
                         .motion = of_arm};
  const PlanView& run = view.runs.front();
  return map != nullptr
             ? to_page(run, *map, result_json, shown, budget, words)
             : to_page(run, make_map(run, false, budget), result_json, shown, budget, words);
}

}  // namespace swivel
