// SPDX-License-Identifier: BSD-3-Clause
#include "page/job_page.hpp"
#include "page/workcell_page.hpp"
#include "swivel/report/page.hpp"

namespace swivel {

std::string to_page(const ProblemPlanner& planner, const Answer& answer,
                    const std::string& result_json, std::span<const RunMap> maps,
                    const Budget& budget, const PageWords& words) {
  const ProblemView& view = planner.view();
  const Problem problem = executed_problem(planner.problem(), answer);
  const Motion* const motion = answer.timed();
  std::vector<RunMap> made;
  if (maps.empty()) maps = made = make_maps(view, answer, problem, false, budget);
  if (problem.arms.size() == 2)
    return to_workcell_page({planner.two_arms(), problem, answer, view, maps, motion}, result_json,
                            budget, words);
  const ArmMotion* const of_arm = motion != nullptr ? &motion->arms.front() : nullptr;
  if (!is_path(problem))
    return to_job_page({planner.robot(), problem, answer, view, maps, of_arm}, result_json, budget,
                       words);
  const PageMotion shown{.refined = answer.refined ? &answer.arm().rows() : nullptr,
                         .motion = of_arm};
  return to_page(view.runs.front(), maps.front().map, result_json, shown, budget, words);
}

}  // namespace swivel
