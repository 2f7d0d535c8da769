// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/job/refine_job.hpp"

#include <utility>

#include "job/job_refiner.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

std::optional<MotionResult> JobRefiner::refine(std::size_t k,
                                               const std::optional<TimingOptions>& timing) {
  Part& part = parts_[k];
  RefineOptions options = options_;
  options.keeps_begin = k > 0;
  options.keeps_end = k + 1 < parts_.size();
  RefinedMotion found;
  refine_until_timed(robot_, problem_of_run(job_, *part.run), part.rows, options, timing, budget_,
                     found);
  refine_ms_ += found.refine_ms;
  if (found.refinement->refined) {
    part.rows = found.refinement->rows;
    part.cost = found.refinement->cost;
  }
  refined_[k] = std::move(found.refinement);
  return std::move(found.motion);
}

void JobRefiner::refine_others() {
  for (std::size_t k = 0; k < parts_.size(); ++k)
    if (parts_[k].run && !refined_[k]) refine(k, {});
}

RefinedRuns JobRefiner::runs() const {
  RefinedRuns all;
  all.turns = 1;
  for (const std::optional<Refined>& one : refined_) {
    if (!one) continue;
    all.runs.push_back(*one);
    all.cost_before += one->cost_before;
    all.cost += one->cost;
  }
  return all;
}

RefinedRuns refine_job(const PreparedRobot& robot, const Problem& job, std::vector<Part>& parts,
                       const RefineOptions& options, const Budget& budget) {
  const TraceSpan span("refine job");
  validate(job);
  JobRefiner refiner(robot, job, parts, options, budget);
  refiner.refine_others();
  return refiner.runs();
}

}  // namespace swivel
