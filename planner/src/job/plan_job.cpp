// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/job/plan_job.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "job/job_refiner.hpp"
#include "job/plan_strokes.hpp"
#include "measure/measure_rows.hpp"
#include "plan/answer.hpp"
#include "plan/layout/keeps_branch.hpp"
#include "plan/stopwatch.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/time_job.hpp"
#include "swivel/planner/plan/problem_view.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "verify/answer_check.hpp"

namespace swivel {

namespace {

/// What follows the plan of a job: refinement, motion, proof and measures.
class AfterJobPlan {
 public:
  /// `job` is the problem of which the answer's parts are, and `view` that of its plan.
  AfterJobPlan(const PreparedRobot& robot, const Problem& job, const PlanOptions& options,
               const Budget& budget, const ProblemView& view, Answer& answer)
      : robot_(robot),
        job_(job),
        options_(options),
        budget_(budget),
        view_(view),
        answer_(answer),
        planned_(answer.arm().parts) {}

  void run(bool refined) {
    try {
      refine_and_time(refined);
      if (options_.check) prove();
    } catch (const Stopped&) {
      stop(refined);
    }
    if (!refined) return;
    take();
    try {
      Stopwatch watch;
      measure();
      answer_.time_ms["report"] += watch.lap();
    } catch (const Stopped&) {
    }
  }

 private:
  [[nodiscard]] std::vector<Part>& parts() { return answer_.arm().parts; }

  void refine_and_time(bool refined) {
    const std::optional<TimingOptions>& timing = answer_.timing;
    const bool own_cost = options_.hooks.cost != nullptr;
    if (refined && own_cost) answer_.refinement = unrefined(kOwnCostReason);
    RefineOptions refining;
    refining.check = options_.hooks.check;
    Stopwatch watch;
    double refine_ms = 0;
    if (refined && !own_cost && timing) {
      RefinedJobMotion found =
          refine_and_time_job(robot_, job_, planned_, *timing, refining, budget_);
      parts() = std::move(found.parts);
      answer_.refinement = std::move(found.refinement);
      answer_.motion = std::move(found.timing);
      refine_ms = found.refine_ms;
    } else if (refined && !own_cost) {
      answer_.refinement = refine_job(robot_, job_, parts(), refining, budget_);
      refine_ms = watch.lap();
    } else if (timing) {
      answer_.motion = time_job(robot_, job_, planned_, *timing, budget_);
    }
    if (refined) answer_.time_ms["refine"] = refine_ms;
    if (timing) answer_.time_ms["time"] = watch.lap() - refine_ms;
  }
  /// Returns what is said of runs that are not refined.
  [[nodiscard]] RefinedRuns unrefined(const char* reason) const {
    RefinedRuns none;
    for (const Part& part : planned_) {
      if (!part.run) continue;
      none.runs.push_back(not_refined(part.rows, part.cost, reason));
      none.cost += part.cost;
    }
    none.cost_before = none.cost;
    return none;
  }
  [[nodiscard]] bool is_refined() const { return answer_.refinement && answer_.refinement->any(); }

  /// Proves the refined rows and the motion; the planned rows are proved already.
  void prove() {
    CheckOptions options{.margins = false, .budget = budget_};
    Stopwatch watch;
    if (is_refined()) {
      require_passed(check_job(robot_, job_, parts(), options));
      answer_.time_ms["check"] += watch.lap();
    }
    const Motion* const motion = answer_.timed();
    if (motion == nullptr) return;
    if (answer_.timing->speed > 0) options.speed = answer_.timing->speed;
    std::vector<StrokeRun> order;
    for (const RunAnswer& run : answer_.arm().runs) order.push_back(run.run);
    require_passed(check_job_motion(robot_, job_, order, motion->arms.front(), options));
    answer_.time_ms["check motion"] = watch.lap();
  }

  /// Notes that time ran out: the planned rows stay, without refinement and motion.
  void stop(bool refined) {
    answer_.stopped = true;
    answer_.motion.reset();
    parts() = planned_;
    if (refined) answer_.refinement = unrefined("stopped");
  }

  /// Makes the answer's cost that of its parts.
  void take() {
    if (!is_refined()) return;
    answer_.refined = true;
    for (std::size_t k = 0; k < planned_.size(); ++k)
      answer_.cost += parts()[k].cost - planned_[k].cost;
  }

  /// Measures the refined runs as plans measure theirs.
  void measure() {
    std::vector<RunAnswer>& runs = answer_.arm().runs;
    // Where time runs out, all runs say what was asked of them.
    for (std::size_t k = 0; k < runs.size(); ++k)
      ask_for(options_.evidence, !view_.runs.at(k).world.allowed().empty(), runs[k]);
    std::size_t k = 0;
    for (const Part& part : parts()) {
      if (!part.run) continue;
      const PlanView& run = view_.runs.at(k);
      Measures& measures = runs[k++];
      const ToolPath& path = run.lattice.path_of_rows();
      measure_margins(robot_.arm().chain, path, part.rows, measures);
      measure_rows(robot_, path, run.world, part.rows, options_.evidence, budget_, measures);
    }
  }

  const PreparedRobot& robot_;
  const Problem& job_;
  const PlanOptions& options_;
  const Budget& budget_;
  const ProblemView& view_;
  Answer& answer_;
  const std::vector<Part> planned_;
};

/// Returns true if the rows of a run of the job are not all on one branch.
bool any_changes_branch(const Answer& job) {
  return std::any_of(job.arm().parts.begin(), job.arm().parts.end(),
                     [](const Part& part) { return part.run && changes_branch(part.rows); });
}

/// Returns true if there are rows, and no motion through them, whatever the time.
bool has_no_motion(const Answer& job) {
  return job.motion && job.motion->failure && !job.stopped && !job.motion->failure->too_near;
}

}  // namespace

Answer plan_job(const PreparedRobot& robot, const Problem& job, const PlanOptions& options,
                ProblemView* view) {
  return plan_job_motion(robot, job, options, false, {}, view);
}

Answer plan_job(const Problem& job, const PlanOptions& options) {
  validate(job);
  return plan_job(PreparedRobot(problem_of_run(job, {0, false})), job, options);
}

Answer plan_job_motion(const PreparedRobot& robot, const Problem& job, const PlanOptions& options,
                       bool refined, const std::optional<TimingOptions>& timing,
                       ProblemView* view) {
  validate(job);
  if (timing) require_speeds(job, *timing);
  const Problem completed = timing ? with_motion_defaults(job) : job;
  robot.require_prepared_for(problem_of_run(completed, {0, false}));
  const Budget budget = options.budget();
  ProblemView own;
  if (view == nullptr && refined) view = &own;
  bool changes_branch = false;
  const auto attempt = [&](bool one_branch, ProblemView* its_view) {
    // The refined rows are measured later, in place of the planned ones.
    PlanOptions first = options;
    if (refined) first.evidence = {.layers = options.evidence.layers};
    Answer answer = plan_strokes(robot, completed, first, budget, one_branch, its_view);
    answer.timing = timing;
    if (!answer.has_rows() || !(refined || timing)) return answer;
    changes_branch = robot.arm_class().srs && any_changes_branch(answer);
    const Problem executed = executed_problem(completed, answer);
    AfterJobPlan(robot, executed, options, budget, its_view == nullptr ? own : *its_view, answer)
        .run(refined);
    return answer;
  };
  Answer answer = attempt(false, view);
  if (!changes_branch || options.hooks.check || !has_no_motion(answer)) return answer;
  ProblemView other_view;
  Answer other = attempt(true, view == nullptr ? nullptr : &other_view);
  if (other.timed() == nullptr) return answer;
  if (view != nullptr) std::swap(*view, other_view);
  other.warnings.push_back(
      formatted("the cheapest job, of cost %.6g, asks joints to jump, which no controller can "
                "follow: this is the cheapest that keeps a branch in each stroke",
                answer.cost));
  return other;
}

}  // namespace swivel
