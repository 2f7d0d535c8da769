// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "plan/stopwatch.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/time_workcell.hpp"
#include "workcell/plan_and_measure.hpp"
#include "workcell/timed_workcell.hpp"

namespace swivel {

namespace {

using RowsOfBoth = std::array<std::vector<TrajectoryRow>, 2>;

/// What follows the plan of a workcell: refinement, motion, proof and measures.
class AfterPlan {
 public:
  AfterPlan(const PreparedWorkcell& prepared, const PlanOptions& options, const Budget& budget,
            WorkcellMotionPlan& plan)
      : prepared_(prepared),
        options_(options),
        budget_(budget),
        plan_(plan),
        planned_(rows_of_arms(plan.result)) {}

  void run(bool refined, const std::optional<TimingOptions>& timing) {
    try {
      refine_and_time(refined, timing);
      if (options_.check) prove();
    } catch (const Stopped&) {
      stop(refined);
    }
    if (!refined) return;
    take();
    try {
      Stopwatch watch;
      measure_workcell(prepared_, options_.evidence, budget_, plan_.result);
      plan_.result.time_ms["report"] += watch.lap();
    } catch (const Stopped&) {
    }
  }

 private:
  void refine_and_time(bool refined, const std::optional<TimingOptions>& timing) {
    auto& time_ms = plan_.result.time_ms;
    if (refined && timing) {
      RefinedWorkcellMotion found = refine_until_timed(prepared_, planned_, *timing, budget_);
      plan_.refinement = std::move(found.refinement);
      plan_.timing = std::move(found.timing);
      time_ms["refine"] += found.refine_ms;
    } else if (refined) {
      Stopwatch watch;
      plan_.refinement = refine_workcell(prepared_, planned_, budget_);
      time_ms["refine"] += watch.lap();
    } else {
      plan_.timing = time_workcell(prepared_, planned_, *timing, budget_);
    }
    if (timing) time_ms["time"] += plan_.timing->time_ms + plan_.timing->check_ms;
  }
  [[nodiscard]] RowsOfBoth refined_rows() const {
    return {plan_.refinement->arms[0].rows, plan_.refinement->arms[1].rows};
  }
  [[nodiscard]] bool is_refined() const {
    return plan_.refinement &&
           (plan_.refinement->arms[0].refined || plan_.refinement->arms[1].refined);
  }

  /// Proves the refined rows and the motion; the planned rows are proved already.
  void prove() {
    Stopwatch watch;
    const CheckOptions options{.margins = false, .budget = budget_};
    if (is_refined()) require_passed(check_workcell(prepared_, refined_rows(), options));
    if (plan_.timing && plan_.timing->motion) {
      const auto& arms = plan_.timing->motion->arms;
      require_passed(check_workcell_motion(prepared_, {arms[0].rows, arms[1].rows}, options));
    }
    plan_.result.time_ms["check"] += watch.lap();
  }

  /// Notes that time ran out: the planned rows stay, without refinement and motion.
  void stop(bool refined) {
    plan_.stopped = true;
    plan_.timing.reset();
    if (!refined) return;
    RefinedWorkcell& none = plan_.refinement.emplace();
    for (std::size_t k = 0; k < 2; ++k) {
      const double cost = plan_.result.arms[k].cost();
      none.arms[k] = {.rows = planned_[k], .reason = "stopped", .cost_before = cost, .cost = cost};
    }
    none.cost_before = none.cost = plan_.result.cost;
  }

  /// Replaces trajectories and costs of the result by the refined ones, where arms were refined.
  void take() {
    Answer& result = plan_.result;
    for (std::size_t k = 0; k < 2; ++k) {
      const Refined& arm = plan_.refinement->arms[k];
      if (!arm.refined) continue;
      Part& part = result.arms[k].parts.front();
      part.rows = arm.rows;
      part.cost = arm.cost;
    }
    if (!is_refined()) return;
    result.refined = true;
    result.cost = plan_.refinement->cost;
  }

  const PreparedWorkcell& prepared_;
  const PlanOptions& options_;
  const Budget& budget_;
  WorkcellMotionPlan& plan_;
  const RowsOfBoth planned_;
};

}  // namespace

RefinedWorkcellMotion refine_until_timed(const PreparedWorkcell& prepared, const RowsOfBoth& rows,
                                         const TimingOptions& options, const Budget& budget) {
  constexpr double kMostExtra = 2e-3;  // m
  RefinedWorkcellMotion found;
  for (double extra = RefineOptions{}.extra_clearance;; extra *= 4) {
    Stopwatch watch;
    found.refinement = refine_workcell(prepared, rows, budget, extra);
    found.refine_ms += watch.lap();
    const double time_ms = found.timing.time_ms, check_ms = found.timing.check_ms;
    found.timing = time_workcell(
        prepared, {found.refinement.arms[0].rows, found.refinement.arms[1].rows}, options, budget);
    found.timing.time_ms += time_ms;
    found.timing.check_ms += check_ms;
    const auto& failure = found.timing.failure;
    if (!failure || !failure->too_near || extra > kMostExtra) return found;
  }
}

WorkcellMotionPlan plan_workcell_motion(const PreparedWorkcell& prepared,
                                        const PlanOptions& options, bool refined,
                                        const std::optional<TimingOptions>& timing,
                                        WorkcellView* view) {
  if (refined) require_refinable(prepared);
  if (timing) {
    require_positive(*timing);
    require_tool_speed_of_arms(prepared, timing->speed);
    require_motion_defaults(prepared);
  }
  const Budget budget = options.budget();
  // The refined rows are measured later, in place of the planned ones.
  PlanOptions first = options;
  if (refined) first.evidence = {};
  WorkcellMotionPlan plan;
  plan.result = plan_workcell(prepared, first, view);
  if (plan.result.status == PlanStatus::kSolved && (refined || timing))
    AfterPlan(prepared, options, budget, plan).run(refined, timing);
  return plan;
}

}  // namespace swivel
