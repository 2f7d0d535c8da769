// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "plan/stopwatch.hpp"
#include "refine/refine_until_timed.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/time_workcell.hpp"
#include "workcell/plan_and_measure.hpp"
#include "workcell/timed_workcell.hpp"

namespace swivel {

namespace {

using RowsOfBoth = std::array<std::vector<TrajectoryRow>, 2>;

/// What follows the plan of two arms: refinement, motion, proof and measures.
class AfterPlan {
 public:
  AfterPlan(const PreparedWorkcell& prepared, const PlanOptions& options, const Budget& budget,
            Answer& answer)
      : prepared_(prepared),
        options_(options),
        budget_(budget),
        answer_(answer),
        planned_(rows_of_arms(answer)) {}

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
      measure_workcell(prepared_, options_.evidence, budget_, answer_);
      answer_.time_ms["report"] += watch.lap();
    } catch (const Stopped&) {
    }
  }

 private:
  void refine_and_time(bool refined) {
    auto& time_ms = answer_.time_ms;
    const std::optional<TimingOptions>& timing = answer_.timing;
    if (refined && timing) {
      RefinedWorkcellMotion found = refine_until_timed(prepared_, planned_, *timing, budget_);
      answer_.refinement = std::move(found.refinement);
      answer_.motion = std::move(found.timing);
      time_ms["refine"] += found.refine_ms;
    } else if (refined) {
      Stopwatch watch;
      answer_.refinement = refine_workcell(prepared_, planned_, budget_);
      time_ms["refine"] += watch.lap();
    } else {
      answer_.motion = time_workcell(prepared_, planned_, *timing, budget_);
    }
    if (timing) time_ms["time"] += answer_.motion->time_ms + answer_.motion->check_ms;
  }
  [[nodiscard]] bool is_refined() const { return answer_.refinement && answer_.refinement->any(); }

  /// Proves the refined rows and the motion; the planned rows are proved already.
  void prove() {
    Stopwatch watch;
    const CheckOptions options{.margins = false, .budget = budget_};
    if (is_refined()) {
      const auto& arms = answer_.refinement->runs;
      require_passed(check_workcell(prepared_, {arms[0].rows, arms[1].rows}, options));
    }
    if (const Motion* const motion = answer_.timed())
      require_passed(
          check_workcell_motion(prepared_, {motion->arms[0].rows, motion->arms[1].rows}, options));
    answer_.time_ms["check"] += watch.lap();
  }

  /// Notes that time ran out: the planned rows stay, without refinement and motion.
  void stop(bool refined) {
    answer_.stopped = true;
    answer_.motion.reset();
    if (!refined) return;
    RefinedRuns& none = answer_.refinement.emplace();
    for (std::size_t k = 0; k < 2; ++k)
      none.runs.push_back(not_refined(planned_[k], answer_.arms[k].cost(), "stopped"));
    none.cost_before = none.cost = answer_.cost;
  }

  /// Replaces rows and costs by the refined ones, where arms were refined.
  void take() {
    for (std::size_t k = 0; k < 2; ++k) {
      const Refined& arm = answer_.refinement->runs[k];
      if (!arm.refined) continue;
      Part& part = answer_.arms[k].parts.front();
      part.rows = arm.rows;
      part.cost = arm.cost;
    }
    if (!is_refined()) return;
    answer_.refined = true;
    answer_.cost = answer_.refinement->cost;
  }

  const PreparedWorkcell& prepared_;
  const PlanOptions& options_;
  const Budget& budget_;
  Answer& answer_;
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
        prepared, {found.refinement.runs[0].rows, found.refinement.runs[1].rows}, options, budget);
    found.timing.time_ms += time_ms;
    found.timing.check_ms += check_ms;
    const auto& failure = found.timing.failure;
    if (!failure || !failure->too_near || extra > kMostExtra) return found;
  }
}

Answer plan_workcell_motion(const PreparedWorkcell& prepared, const PlanOptions& options,
                            bool refined, const std::optional<TimingOptions>& timing,
                            ProblemView* view) {
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
  Answer answer = plan_workcell(prepared, first, view);
  answer.timing = timing;
  if (answer.has_rows() && (refined || timing))
    AfterPlan(prepared, options, budget, answer).run(refined);
  return answer;
}

}  // namespace swivel
