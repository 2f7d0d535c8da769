// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/refine/motion.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "measure/measure_rows.hpp"
#include "plan/layout/keeps_branch.hpp"
#include "plan/stopwatch.hpp"
#include "refine/motion_faults.hpp"
#include "refine/refine_until_timed.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "verify/answer_check.hpp"
#include "verify/between_samples.hpp"

namespace swivel {

namespace {

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// Returns the rolls of rows at the layers of a path, rad, counted from its frames.
std::vector<double> rolls_on(const Chain& chain, const ToolPath& path,
                             std::vector<TrajectoryRow> rows) {
  if (rows.size() == static_cast<std::size_t>(path.size())) count_from_path(chain, path, rows);
  return rolls_of(rows);
}

/// Returns the rolls of the rows, rad, moved so that the spline through them stays within the range
/// and the waypoints' windows: where it leaves them, the rolls beside are moved by as much, again
/// and again. In a window no wider than the spline's own bends it may stay outside a little.
std::vector<double> rolls_for_motion(const Chain& chain, const ToolPath& path,
                                     const std::vector<TrajectoryRow>& rows, bool ends_given) {
  constexpr int kMost = 40;
  constexpr double kFurther = 1.2;  // so that it ends
  const Roll& range = *chain.free_roll;
  std::vector<double> rolls = rolls_on(chain, path, rows);
  if (range.circle() || rolls.size() != static_cast<std::size_t>(path.size())) return rolls;
  const auto into = [&range](const Roll& window, double roll) {
    const double lower = std::max(range.lower, window.lower),
                 upper = std::min(range.upper, window.upper);
    return std::clamp(roll, lower, std::max(lower, upper));
  };
  for (int round = 0; round < kMost; ++round) {
    const ToolPath turned = path.with_rolls(rolls);
    bool inside = true;
    for (int i = 0; i + 1 < path.size(); ++i) {
      const PathLayer &from = path.layer(i), &to = path.layer(i + 1);
      double outside = 0;
      for (const double t : {0.2, 0.4, 0.6, 0.8}) {
        const double travel = from.travel + t * (to.travel - from.travel),
                     roll = turned.roll_at(travel);
        if (const double by = into(path.window_at(travel), roll) - roll;
            std::abs(by) > std::abs(outside))
          outside = by;
      }
      if (outside == 0) continue;
      inside = false;
      for (const int layer : {i, i + 1}) {
        double& roll = rolls[static_cast<std::size_t>(layer)];
        const bool given = layer == 0 || (ends_given && layer + 1 == path.size());
        if (!given)  // the first may be a start's
          roll = into(path.layer(layer).window, roll + kFurther * outside);
      }
    }
    if (inside) break;
  }
  return rolls;
}

/// Returns the motion of time_path(). If the tool would leave the path's tolerances between
/// samples, as it may at few samples a second, returns a slower one, or none if that does so too.
TimingResult time_within_tolerances(const PreparedRobot& robot, const PathProblem& problem,
                                    const PathMotion& motion, const JointRates& rates,
                                    const TimingOptions& options, const Budget& budget) {
  TimingResult timed = time_path(motion, rates, options, budget);
  if (!timed.motion || !strays_between(robot, problem, *timed.motion, budget)) return timed;
  if (const auto& tolerance = problem.limits.tool_path_error; tolerance && *tolerance > 0) {
    TimingOptions slower = options;
    slower.chord = std::min(*tolerance / 2, options.chord.value_or(*tolerance));
    timed = time_path(motion, rates, slower, budget);
    if (!timed.motion) return timed;
    timed.motion->warnings.emplace_back(
        "the motion is slowed down: at this rate the tool would leave limits.tool_path_error "
        "between samples");
    if (!strays_between(robot, problem, *timed.motion, budget)) return timed;
  }
  return {
      std::nullopt,
      NoMotion{
          0,
          "the tool would leave its path's tolerances between samples: a higher rate brings less"}};
}

/// Times the rows of a path, and proves the motion's samples. Tries several motions through the
/// rows, the smoothest first, until one is without fault.
class RowTimer {
 public:
  RowTimer(const PreparedRobot& robot, const PathProblem& problem,
           const std::vector<TrajectoryRow>& rows, const TimingOptions& asked, const Budget& budget)
      : robot_(robot),
        problem_(problem),
        rows_(rows),
        budget_(budget),
        options_(within_limits(asked, problem.limits, lowered_)),
        path_(problem_path(problem, robot.arm().chain, budget, PathSmoothing{})),
        rates_(joint_rates(robot.arm().chain, problem.limits, problem.source)),
        of_samples_(problem_of_samples(problem)) {
    if (problem.start) require_start_on_path();
  }

  /// Returns the motion, or the fault of the last that was tried. `between_layers`: where the
  /// motion is at fault between the rows, it may be led through other postures there.
  MotionResult run(bool between_layers) {
    constexpr double kFarOff = 0.03;  // rad
    Tried tried = attempt(kApart, kOffLimits);
    Tried smoothest = between_layers && tried.at_fault ? tried : Tried{};
    // A motion through every row is less smooth, so it comes second.
    if (tried.failure && !tried.all_rows && !tried.jumps) tried = attempt(0, kOffLimits);
    // The third keeps as far off limits as splines through a jagged path overshoot.
    if (tried.failure && !tried.failure->too_near && !tried.jumps && !robot_.arm_class().srs) {
      if (const Tried last = attempt(kApart, kFarOff); !last.failure) tried = last;
    }
    if (tried.failure && smoothest.at_fault)
      tried = lead_between(std::move(smoothest), *tried.failure);
    result_.failure = std::move(tried.failure);
    if (result_.motion)
      result_.motion->warnings.insert(result_.motion->warnings.begin(), lowered_.begin(),
                                      lowered_.end());
    return std::move(result_);
  }

 private:
  static constexpr double kApart = 0.005, kOffLimits = 1e-3;  // m, rad

  /// Throws InputError where the start is not on the motion's path: beside a corner it may be on
  /// the path of the rows and off the rounded one.
  void require_start_on_path() const {
    const Chain& chain = robot_.arm().chain;
    TrajectoryRow row;
    row.q = *problem_.start;
    const Pose& there = path_.layer(0).tool;
    const Pose tool = chain.tool(counted_from_path(chain, path_, path_.layer(0).travel, row).q);
    const double distance = (tool.translation() - there.translation()).norm(),
                 angle = Eigen::AngleAxisd(there.linear().transpose() * tool.linear()).angle();
    constexpr double kRounding = 1e-6;  // rad, of a roll as rows have it
    if (distance <= problem_.start_tolerance && angle <= problem_.start_tolerance + kRounding)
      return;
    const std::string text = formatted(
        "start.joints: the tool is %.3g m and %.3g rad from the path of a motion, whose corners "
        "are rounded: allowed are %g m and rad (start_tolerance)",
        distance, angle, problem_.start_tolerance);
    throw InputError(problem_.source, text);
  }

  /// A motion that was tried.
  struct Tried {
    std::optional<NoMotion> failure;
    bool all_rows = false, jumps = false;  ///< goes through every row; changes the branch at once
    std::vector<TimedRow> samples;         ///< of a motion at fault
    std::optional<std::size_t> at_fault;   ///< the sample at fault
  };

  /// Times a motion through rows that are at least `apart` apart (m) and through the postures
  /// `between`, `off_limits` inside joint limits (rad). Sets the result's motion if it is without
  /// fault.
  Tried attempt(double apart, double off_limits, const std::vector<BetweenRow>& between = {}) {
    auto start = std::chrono::steady_clock::now();
    const auto motion = make_path_motion(robot_.arm().chain, robot_.arm_class(), path_, rows_,
                                         apart, problem_.limits.joint_margin + off_limits, between);
    TimingResult timed =
        time_within_tolerances(robot_, problem_, *motion, rates_, options_, budget_);
    result_.time_ms += ms_since(std::exchange(start, std::chrono::steady_clock::now()));
    Tried tried{std::move(timed.failure),
                motion->knots().size() == rows_.size(),
                !motion->jumps().empty(),
                {},
                {}};
    if (timed.motion) {
      if (const auto fault = first_fault(robot_, of_samples_, timed.motion->rows, budget_)) {
        tried.failure = fault->what;
        tried.at_fault = fault->row;
        tried.samples = std::move(timed.motion->rows);
      }
    }
    result_.check_ms += ms_since(start);
    if (!tried.failure) result_.motion = std::move(timed.motion);
    return tried;
  }

  /// Leads a motion that is at fault through other postures between the rows, one after the other.
  /// Returns the last motion that was tried. `failure` is what the result would be without.
  Tried lead_between(Tried tried, const NoMotion& failure) {
    constexpr std::size_t kMost = 64;
    Bisection bisection(robot_, of_samples_, path_, budget_);
    std::vector<BetweenRow> between;
    while (tried.at_fault && between.size() < kMost) {
      const auto one = bisection.posture(tried.samples, *tried.at_fault);
      if (!one) break;
      between.push_back(*one);
      tried = attempt(kApart, kOffLimits, between);
    }
    if (!tried.failure) {
      const std::string text =
          formatted("at s = %.4f m the motion would be at fault between layers (", failure.s);
      result_.motion->warnings.push_back(text + failure.reason + "): it is led through " +
                                         std::to_string(between.size()) + " other posture" +
                                         (between.size() == 1 ? "" : "s") + " there");
    }
    return tried;
  }

  const PreparedRobot& robot_;
  const PathProblem& problem_;
  const std::vector<TrajectoryRow>& rows_;
  const Budget& budget_;
  std::vector<std::string> lowered_;  ///< warnings about speeds that were lowered
  const TimingOptions options_;
  const ToolPath path_;
  const JointRates rates_;
  const PathProblem of_samples_;
  MotionResult result_;
};

/// Times a trajectory as time_trajectory() says. `between_layers`: where the motion is at fault
/// between the rows, it may be led through other postures there.
MotionResult time_rows(const PreparedRobot& robot, const PathProblem& problem,
                       const std::vector<TrajectoryRow>& rows, const TimingOptions& asked,
                       bool between_layers, const Budget& budget) {
  validate(problem);
  robot.require_prepared_for(problem);
  if (robot.arm().chain.free_roll && problem.rolls.empty()) {  // stays as it was chosen
    PathProblem turned = problem;
    turned.rolls =
        rolls_for_motion(robot.arm().chain, problem_path(problem, robot.arm().chain, budget), rows,
                         problem.end.has_value());
    return time_rows(robot, turned, rows, asked, between_layers, budget);
  }
  require_positive(asked);
  require_tool_speed(robot.arm().chain, asked.speed, "speed");
  return RowTimer(robot, problem, rows, asked, budget).run(between_layers);
}

}  // namespace

MotionResult time_trajectory(const PreparedRobot& robot, const PathProblem& problem,
                             const std::vector<TrajectoryRow>& rows, const TimingOptions& options,
                             const Budget& budget) {
  return time_rows(robot, problem, rows, options, true, budget);
}

void refine_until_timed(const PreparedRobot& robot, const PathProblem& problem,
                        const std::vector<TrajectoryRow>& rows,
                        std::optional<RefineOptions> refining,
                        const std::optional<TimingOptions>& timing, const Budget& budget,
                        RefinedMotion& found) {
  constexpr double kMostExtra = 2e-3;  // m
  Stopwatch watch;
  for (;; refining->extra_clearance *= 4) {
    if (refining) {
      found.refinement = refine(robot, problem, rows, *refining, budget);
      found.refine_ms += watch.lap();
    }
    if (!timing) return;
    const std::vector<TrajectoryRow>& timed = refining ? found.refinement->rows : rows;
    // More clearance at the layers makes smoother motions than postures between them: these come
    // last.
    const bool last = !refining || refining->extra_clearance > kMostExtra;
    found.motion = time_rows(robot, problem, timed, *timing, last, budget);
    if (!last && found.motion->failure && !found.motion->failure->too_near)
      found.motion = time_rows(robot, problem, timed, *timing, true, budget);
    found.time_ms += watch.lap();
    if (last || !found.motion->failure || !found.motion->failure->too_near) return;
  }
}

namespace {

/// Notes that time ran out: the lattice's path stays, without refinement and motion.
void stop(MotionPlan& plan, bool refined, bool timed) {
  plan.stopped = true;
  if (refined) plan.refinement = not_refined(plan.lattice_path, plan.result.cost, "stopped");
  if (timed) plan.motion.emplace().failure = NoMotion{0, "stopped"};
}

/// Proves the refined path and the motion; the lattice's path is proved already. If time runs out,
/// they are dropped. Throws std::logic_error if one fails.
void check(const PlanView& view, const Budget& budget, MotionPlan& plan) {
  const bool refined = plan.refinement && plan.refinement->refined,
             timed = plan.motion && plan.motion->motion;
  const auto start = std::chrono::steady_clock::now();
  try {
    if (refined) check_answer(view.world, view.robot, view.problem, plan.refinement->rows, budget);
    if (timed)
      check_answer(view.world, view.robot, view.problem, plan.motion->motion->rows, budget);
  } catch (const Stopped&) {
    stop(plan, refined, plan.motion.has_value());
  }
  plan.result.time_ms["check"] += ms_since(start);
}

/// Replaces the trajectory of the result by the refined one, if the path was refined.
void take(const Refined& refined, const PlanView& view, PlanResult& result) {
  if (!refined.refined) return;
  result.trajectory = refined.rows;
  result.cost = refined.cost;
  measure_margins(view.robot.arm().chain, view.lattice.path_of_rows(), result.trajectory, result);
}

/// Throws InvalidArgument for a problem that makes no sense, and as require_tool_speed() does for a
/// speed of its tool, m/s.
void require_tool_speed_of(const PathProblem& problem, double speed) {
  validate(problem);
  require_tool_speed(build_arm(*problem.model, problem.base_link, problem.tip_link, problem.hold,
                               problem.tool, problem.roll)
                         .chain,
                     speed, "speed");
}

/// Plans a path, refines it and times it as plan_motion() does. `one_branch`: if set, of an S-R-S
/// arm, which then never changes its branch.
MotionPlan attempt(Planner& planner, const PlanOptions& options, bool refined,
                   const std::optional<TimingOptions>& timing, const Budget& budget,
                   const std::shared_ptr<KeepsBranch>& one_branch) {
  // The caller's own cost is not known off the lattice.
  const bool own_cost = refined && options.hooks.cost;
  refined = refined && !own_cost;
  // The refined path is measured later, in place of the lattice's.
  PlanOptions first = options;
  if (one_branch) first.hooks.check = one_branch;
  if (refined) first.evidence = {.layers = options.evidence.layers};
  MotionPlan plan;
  PlanResult& result = plan.result;
  result = planner.plan(first);
  if (result.status != PlanStatus::kSolved) return plan;
  plan.lattice_path = result.trajectory;
  const PlanView view = planner.view();
  if (own_cost) plan.refinement = not_refined(plan.lattice_path, result.cost, kOwnCostReason);
  RefinedMotion found;
  const auto take_times = [&] {
    if (found.refinement) plan.refinement = std::move(found.refinement);
    plan.motion = std::move(found.motion);
    if (found.refine_ms > 0) result.time_ms["refine"] += found.refine_ms;
    if (found.time_ms > 0) result.time_ms["time"] += found.time_ms;
  };
  try {
    std::optional<RefineOptions> refining;
    if (refined) refining.emplace().check = options.hooks.check;
    refine_until_timed(view.robot, view.problem, plan.lattice_path, refining, timing, budget,
                       found);
    take_times();
  } catch (const Stopped&) {
    take_times();
    stop(plan, refined && !plan.refinement, timing && (!plan.motion || !plan.motion->motion));
  }
  if (options.check) check(view, budget, plan);
  if (!refined) return plan;
  take(*plan.refinement, view, result);
  try {
    measure_rows(view.robot, view.lattice.path_of_rows(), view.world, result.trajectory,
                 options.evidence, budget, result);
  } catch (const Stopped&) {
  }
  return plan;
}

/// Returns true if there is a path, and no motion along it, whatever the time.
bool has_no_motion(const MotionPlan& plan) {
  return plan.motion && plan.motion->failure && !plan.stopped && !plan.motion->failure->too_near;
}

}  // namespace

MotionPlan plan_motion(Planner& planner, const PlanOptions& options, bool refined,
                       const std::optional<TimingOptions>& timing) {
  if (timing) require_tool_speed_of(planner.problem(), timing->speed);
  const Budget budget = options.budget();
  MotionPlan plan = attempt(planner, options, refined, timing, budget, nullptr);
  if (!has_no_motion(plan) || !changes_branch(plan.lattice_path) || options.hooks.check)
    return plan;
  const ArmClass& arm = planner.view().robot.arm_class();
  if (!arm.srs) return plan;  // signs of other arms change along a motion
  MotionPlan other =
      attempt(planner, options, refined, timing, budget, std::make_shared<KeepsBranch>(*arm.srs));
  if (!other.motion || !other.motion->motion) {
    static_cast<void>(planner.plan(options));  // for its view
    return plan;
  }
  other.result.warnings.push_back(
      formatted("the path found first, of cost %.6g, asks joints to jump, which no controller can "
                "follow: this one keeps its branch",
                plan.result.cost));
  return other;
}

Answer answer_of(MotionPlan plan, const std::optional<TimingOptions>& timing) {
  Answer answer = answer_of(std::move(plan.result));
  answer.timing = timing;
  answer.stopped = plan.stopped;
  if (plan.refinement) {
    RefinedRuns& refined = answer.refinement.emplace();
    refined.turns = 1;
    refined.cost_before = plan.refinement->cost_before;
    refined.cost = plan.refinement->cost;
    refined.runs.push_back(*std::move(plan.refinement));
    answer.refined = refined.any();
  }
  if (!plan.motion) return answer;
  MotionTiming& timed = answer.motion.emplace();
  timed.failure = std::move(plan.motion->failure);
  timed.time_ms = plan.motion->time_ms;
  timed.check_ms = plan.motion->check_ms;
  if (!plan.motion->motion) return answer;
  Motion& motion = timed.motion.emplace();
  ArmMotion& arm = motion.arms.emplace_back();
  static_cast<TimedPath&>(arm) = *std::move(plan.motion->motion);
  motion.rate = arm.rate;
  motion.duration = arm.duration;
  motion.ideal = arm.ideal;
  return answer;
}

std::vector<TrajectoryRow> rows_on_path(const PreparedRobot& robot, const PathProblem& problem,
                                        const std::vector<TrajectoryRow>& rows) {
  validate(problem);
  robot.require_prepared_for(problem);
  if (robot.arm().chain.free_roll && problem.rolls.empty()) {
    PathProblem turned = problem;
    turned.rolls = rolls_on(robot.arm().chain, problem_path(problem, robot.arm().chain), rows);
    return rows_on_path(robot, turned, rows);
  }
  const ToolPath path = problem_path(problem, robot.arm().chain);
  const auto motion = make_path_motion(robot.arm().chain, robot.arm_class(), path, rows);
  std::vector<TrajectoryRow> laid;
  for (int i = 0; i < path.size(); ++i) {
    const double travel = path.layer(i).travel;
    const auto q = motion->joints(travel);
    if (!q)
      throw InputError(problem.source, "path.smooth: the arm has no solution at s = " +
                                           formatted("%.9g", path.layer(i).s) +
                                           ": allowed are smaller tolerances");
    laid.push_back(motion->row(travel, *q));
    laid.back().s = path.layer(i).s;
  }
  return laid;
}

}  // namespace swivel
