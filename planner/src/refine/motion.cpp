// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/refine/motion.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "measure/first_clearance_violation.hpp"
#include "measure/measure_rows.hpp"
#include "swivel/core/kinematics/newton/nearest_allowed_posture.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/motion/time_path.hpp"
#include "swivel/core/problem/validate.hpp"
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

/// A joint's limits and the manipulability at a sample. Limits are narrower by `inside`, rad.
std::optional<NoMotion> fault_of_joints(const Chain& chain, const Limits& limits,
                                        const TrajectoryRow& row, double inside = 0) {
  constexpr double kLimit = 1e-9;  // rad
  for (std::size_t j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[j];
    const double q = row.q[static_cast<Eigen::Index>(j)], margin = limits.joint_margin + inside;
    if (!limit.continuous &&
        !(q >= limit.lower + margin - kLimit && q <= limit.upper - margin + kLimit))
      return NoMotion{row.s,
                      "joint '" + chain.joint_names[j] + "' leaves its limits between layers"};
  }
  if (limits.manipulability > 0 && chain.manipulability(row.q) < limits.manipulability - 1e-9)
    return NoMotion{row.s, "manipulability is too low between layers"};
  return std::nullopt;
}

struct Fault {
  NoMotion what;
  std::size_t row = 0;
};

/// What is wrong with a motion first.
std::optional<Fault> first_fault(const PreparedRobot& robot, const Problem& problem,
                                 const std::vector<TimedRow>& rows, const Budget& budget) {
  std::vector<Config> samples;
  for (const TimedRow& row : rows) {
    if (auto fault = fault_of_joints(robot.arm().chain, problem.limits, row.row))
      return Fault{*fault, samples.size()};
    samples.push_back(row.row.q);
  }
  const World world(robot.world(), problem, budget, kVerdictBand);
  const auto found = first_clearance_violation(world, world.edge_rule(robot.radii()),
                                               problem.limits, samples, budget);
  if (!found) return std::nullopt;
  const auto names = world.names(found->pair);
  NoMotion fault{rows[found->row].row.s, "'" + names[0] + "' and '" + names[1] + "' come too near" +
                                             (found->between ? " between samples" : "")};
  fault.too_near = true;
  return Fault{std::move(fault), found->row};
}

/// Where on the path s is, m of travel; none where the path only turns there.
std::optional<double> travel_at(const ToolPath& path, double s) {
  for (int i = 0; i + 1 < path.size(); ++i) {
    const PathLayer &from = path.layer(i), &to = path.layer(i + 1);
    if (s < to.s && from.step_length > 0)
      return from.travel +
             std::max(0.0, (s - from.s) / (to.s - from.s)) * (to.travel - from.travel);
  }
  return std::nullopt;
}

/// Finds postures for the stretches between layers on which a motion is at fault.
class Bisection {
 public:
  Bisection(const PreparedRobot& robot, const Problem& of_samples, const ToolPath& path,
            const Budget& budget)
      : chain_(&robot.arm().chain),
        problem_(&of_samples),
        path_(&path),
        world_(robot.world(), of_samples, budget),
        query_(world_) {}

  /// In the middle of the samples at fault, one after the other, from this one on: the posture
  /// nearest to the sample there that keeps what is asked, and a little more. None where there is
  /// none, or one is there already.
  std::optional<BetweenRow> posture(const std::vector<TimedRow>& rows, std::size_t first) {
    constexpr double kFarthest = 0.5, kSame = 1e-6;  // rad, m
    std::size_t last = first;
    while (last + 1 < rows.size() && !allowed(rows[last + 1].row.q)) ++last;
    const TrajectoryRow& middle = rows[(first + last) / 2].row;
    const auto travel = travel_at(*path_, middle.s);
    if (!travel) return std::nullopt;
    for (const double other : found_)
      if (std::abs(*travel - other) < kSame) return std::nullopt;
    const auto q = nearest_allowed_posture(*chain_, middle.q, kFarthest,
                                           [this](const Config& one) { return allowed(one); });
    if (!q) return std::nullopt;
    found_.push_back(*travel);
    return BetweenRow{*travel, *q};
  }

 private:
  bool allowed(const Config& q) {
    constexpr double kInside = 1e-4,
                     kClear = 1e-4;  // rad, m: so that samples beside are allowed as well
    TrajectoryRow row;
    row.q = q;
    return !fault_of_joints(*chain_, problem_->limits, row, kInside) &&
           !query_.find_violating_pair(q, Threshold(ClearanceRule::kNode, kClear));
  }

  const Chain* chain_;
  const Problem* problem_;
  const ToolPath* path_;
  World world_;
  World::Query query_;
  std::vector<double> found_;  // m of travel
};

/// What rows say, moved off the ends of the range and of the waypoints' windows where the spline
/// through it would leave them: as far as it does, again and again. Where a window is no wider than
/// its own bends that does not end, and they stay outside a little.
std::vector<double> rolls_for_motion(const Roll& range, const ToolPath& path,
                                     const std::vector<TrajectoryRow>& rows) {
  constexpr int kMost = 40;
  constexpr double kFurther = 1.2;  // so that it ends
  std::vector<double> rolls = rolls_of(rows);
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
        if (layer > 0)
          roll = into(path.layer(layer).window,
                      roll + kFurther * outside);  // the first may be a start's
      }
    }
    if (inside) break;
  }
  return rolls;
}

/// Whether the check finds that the tool leaves the tolerances of its path between the samples of a
/// motion.
bool strays_between(const PreparedRobot& robot, const Problem& problem, const TimedPath& motion,
                    const Budget& budget) {
  constexpr double kShare = 0.5;  // of the true distance: what is measured half way between samples
                                  // beside a corner, at least
  const Limits& limits = problem.limits;
  if (!(limits.tool_path_error && motion.between_position > kShare * *limits.tool_path_error) &&
      !(limits.tool_angle_error && motion.between_angle > kShare * *limits.tool_angle_error))
    return false;
  const CheckResult check = check_motion_in(robot.world(), robot, problem, motion.rows,
                                            {.margins = false, .budget = budget});
  return check.worst_path_error > 0 || check.worst_path_angle > 0;  // of moves that fail
}

/// time_path(), slower where the tool would leave the path's tolerances between samples, as at few
/// samples a second; no motion where it would do so all the same.
TimingResult time_within_tolerances(const PreparedRobot& robot, const Problem& problem,
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

/// The timing asked for, the tool no faster than limits.tool_speed and limits.tool_turn_speed
/// allow; what was lowered is told.
TimingOptions within_limits(TimingOptions options, const Limits& limits,
                            std::vector<std::string>& warnings) {
  const auto lower = [&](double& asked, const std::optional<double>& limit, const char* format) {
    if (!limit || asked <= *limit) return;
    warnings.push_back(formatted(format, asked, *limit));
    asked = *limit;
  };
  lower(options.speed, limits.tool_speed,
        "a tool speed of %.6g m/s is asked for: limits.tool_speed allows %.6g m/s, which is kept");
  if (!options.turn_speed) options.turn_speed = limits.tool_turn_speed;
  if (options.turn_speed)
    lower(*options.turn_speed, limits.tool_turn_speed,
          "a turn speed of %.6g rad/s is asked for: limits.tool_turn_speed allows %.6g rad/s, "
          "which is kept");
  return options;
}

/// `between_layers`: where the motion through the rows is at fault between them, it may be led
/// through postures of its own there.
MotionResult time_rows(const PreparedRobot& robot, const Problem& problem,
                       const std::vector<TrajectoryRow>& rows, const TimingOptions& asked,
                       bool between_layers, const Budget& budget) {
  validate(problem);
  robot.require_prepared_for(problem);
  if (robot.arm().chain.free_roll && problem.rolls.empty()) {  // stays as it was chosen
    Problem turned = problem;
    turned.rolls = rolls_for_motion(*robot.arm().chain.free_roll,
                                    problem_path(problem, robot.arm().chain, budget), rows);
    return time_rows(robot, turned, rows, asked, between_layers, budget);
  }
  const auto positive = [&](double value, const char* name) {
    if (!(value > 0) || !std::isfinite(value))
      throw InvalidArgument(std::string("TimingOptions: ") + name + " is " +
                            formatted("%.9g", value) + ": allowed is a finite number > 0");
  };
  positive(asked.speed, "speed");
  positive(asked.turn_speed.value_or(1), "turn_speed");
  positive(asked.rate, "rate");
  positive(asked.chord.value_or(1), "chord");
  std::vector<std::string> lowered;
  const TimingOptions options = within_limits(asked, problem.limits, lowered);
  const Chain& chain = robot.arm().chain;
  const ToolPath path = problem_path(problem, chain, budget, PathSmoothing{});
  const JointRates rates = joint_rates(chain, problem.limits, problem.source);
  const Problem of_samples = problem_of_samples(problem);
  MotionResult result;
  struct Tried {
    std::optional<NoMotion> failure;
    bool all_rows = false, jumps = false;
    std::vector<TimedRow> samples;  // the one at fault with what comes before it and after
    std::optional<std::size_t> at_fault;
  };
  const auto try_it = [&](double apart, double off_limits,
                          const std::vector<BetweenRow>& between = {}) {
    auto start = std::chrono::steady_clock::now();
    const auto motion = make_path_motion(chain, robot.arm_class(), path, rows, apart,
                                         problem.limits.joint_margin + off_limits, between);
    TimingResult timed = time_within_tolerances(robot, problem, *motion, rates, options, budget);
    result.time_ms += ms_since(std::exchange(start, std::chrono::steady_clock::now()));
    Tried tried{std::move(timed.failure),
                motion->knots().size() == rows.size(),
                !motion->jumps().empty(),
                {},
                {}};
    if (timed.motion) {
      if (const auto fault = first_fault(robot, of_samples, timed.motion->rows, budget)) {
        tried.failure = fault->what;
        tried.at_fault = fault->row;
        tried.samples = std::move(timed.motion->rows);
      }
    }
    result.check_ms += ms_since(start);
    if (!tried.failure) result.motion = std::move(timed.motion);
    return tried;
  };
  constexpr double kApart = 0.005, kOffLimits = 1e-3, kFarOff = 0.03;  // m, rad
  Tried tried = try_it(kApart, kOffLimits);
  Tried bisected = between_layers && tried.at_fault ? tried : Tried{};
  // Through every row only where the smoother motion will not do.
  if (tried.failure && !tried.all_rows && !tried.jumps) tried = try_it(0, kOffLimits);
  // Rows as far off limits as splines through a jagged path overshoot.
  if (tried.failure && !tried.failure->too_near && !tried.jumps && !robot.arm_class().srs) {
    if (const Tried last = try_it(kApart, kFarOff); !last.failure) tried = last;
  }
  if (tried.failure && bisected.at_fault) {
    constexpr std::size_t kMost = 64;
    Bisection bisection(robot, of_samples, path, budget);
    std::vector<BetweenRow> between;
    while (bisected.at_fault && between.size() < kMost) {
      const auto one = bisection.posture(bisected.samples, *bisected.at_fault);
      if (!one) break;
      between.push_back(*one);
      bisected = try_it(kApart, kOffLimits, between);
    }
    if (!bisected.failure) {
      const std::string text = formatted(
          "at s = %.4f m the motion would be at fault between layers (", tried.failure->s);
      result.motion->warnings.push_back(text + tried.failure->reason + "): it is led through " +
                                        std::to_string(between.size()) + " other posture" +
                                        (between.size() == 1 ? "" : "s") + " there");
    }
    tried = std::move(bisected);
  }
  result.failure = std::move(tried.failure);
  if (result.motion)
    result.motion->warnings.insert(result.motion->warnings.begin(), lowered.begin(), lowered.end());
  return result;
}

}  // namespace

MotionResult time_trajectory(const PreparedRobot& robot, const Problem& problem,
                             const std::vector<TrajectoryRow>& rows, const TimingOptions& options,
                             const Budget& budget) {
  return time_rows(robot, problem, rows, options, true, budget);
}

namespace {

/// Refuses steps from a branch to another, whatever made the lattice cross a singularity there.
class KeepsBranch final : public StateCheck {
 public:
  explicit KeepsBranch(const SrsArm& arm) : arm_(&arm) {}
  [[nodiscard]] std::string name() const override { return "branch"; }
  [[nodiscard]] bool concurrent() const override { return true; }
  void states(std::span<const Config> states, std::span<bool> allowed) override {
    std::fill_n(allowed.begin(), states.size(), true);
  }
  [[nodiscard]] bool checks_motions() const override { return true; }
  void motions(std::span<const Motion> motions, std::span<bool> allowed) override {
    for (std::size_t k = 0; k < motions.size(); ++k)
      allowed[k] = arm_->branch(motions[k].from) == arm_->branch(motions[k].to);
  }

 private:
  const SrsArm* arm_;
};

bool changes_branch(const std::vector<TrajectoryRow>& rows) {
  return std::any_of(rows.begin(), rows.end(),
                     [&](const TrajectoryRow& row) { return row.branch != rows[0].branch; });
}

/// A path that never changes branch, where there is one: else the one there is.
PlanResult plan_executable(Planner& planner, const PlanOptions& options, bool one_branch) {
  PlanResult found = planner.plan(options);
  if (!one_branch || found.status != PlanStatus::kSolved || !changes_branch(found.trajectory) ||
      options.hooks.check)
    return found;
  const ArmClass& arm = planner.view().robot.arm_class();
  if (!arm.srs) return found;  // signs of other arms change along a motion
  PlanOptions keeping = options;
  keeping.hooks.check = std::make_shared<KeepsBranch>(*arm.srs);
  PlanResult other = planner.plan(keeping);
  if (other.status != PlanStatus::kSolved) return planner.plan(options);  // for its view
  const std::string text = formatted(
      "the cheapest path, of cost %.6g, jumps to another branch, which no controller can follow: "
      "this is the cheapest "
      "that does not",
      found.cost);
  other.warnings.emplace_back(text);
  return other;
}

/// The lattice's path stays, and nothing is made of it.
void stop(MotionPlan& plan, bool refined, bool timed) {
  plan.stopped = true;
  const double cost = plan.result.cost;
  if (refined)
    plan.refinement =
        Refined{.rows = plan.lattice_path, .reason = "stopped", .cost_before = cost, .cost = cost};
  if (timed) plan.motion.emplace().failure = NoMotion{0, "stopped"};
}

/// Proves what was made of the lattice's path, which was proved itself. What is not proved in time
/// is not made.
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

/// Puts refined rows in the place of the lattice's.
void take(const Refined& refined, const PlanView& view, PlanResult& result) {
  if (!refined.refined) return;
  result.trajectory = refined.rows;
  result.cost = refined.cost;
  measure_margins(view.robot.arm().chain, view.lattice.path_of_rows(), result.trajectory, result);
}

}  // namespace

MotionPlan plan_motion(Planner& planner, const PlanOptions& options, bool refined,
                       const std::optional<TimingOptions>& timing) {
  const Budget budget = options.budget();
  const bool own_cost = refined && options.hooks.cost;  // off the lattice it is not known
  refined = refined && !own_cost;
  // Of the path that is executed, later.
  PlanOptions first = options;
  if (refined) first.evidence.tool_path_error = first.evidence.postures = false;
  MotionPlan plan;
  PlanResult& result = plan.result;
  result = plan_executable(planner, first, timing.has_value());
  if (result.status != PlanStatus::kSolved) return plan;
  plan.lattice_path = result.trajectory;
  const PlanView view = planner.view();
  RefineOptions margins;
  margins.check = options.hooks.check;
  if (own_cost)
    plan.refinement = Refined{.rows = plan.lattice_path,
                              .reason = "the caller's own cost is not refined",
                              .cost_before = result.cost,
                              .cost = result.cost};
  constexpr double kMostExtra = 2e-3;  // m
  auto start = std::chrono::steady_clock::now();
  try {
    for (;; margins.extra_clearance *= 4) {
      if (refined) {
        plan.refinement = refine(view.robot, view.problem, plan.lattice_path, margins, budget);
        result.time_ms["refine"] +=
            ms_since(std::exchange(start, std::chrono::steady_clock::now()));
      }
      if (!timing) break;
      const std::vector<TrajectoryRow>& rows = refined ? plan.refinement->rows : plan.lattice_path;
      // More clearance at the layers makes smoother motions than postures between them: these come
      // last.
      const bool last = !refined || margins.extra_clearance > kMostExtra;
      plan.motion = time_rows(view.robot, view.problem, rows, *timing, last, budget);
      if (!last && plan.motion->failure && !plan.motion->failure->too_near)
        plan.motion = time_rows(view.robot, view.problem, rows, *timing, true, budget);
      result.time_ms["time"] += ms_since(std::exchange(start, std::chrono::steady_clock::now()));
      if (!refined || !plan.motion->failure || !plan.motion->failure->too_near || last) break;
    }
  } catch (const Stopped&) {
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

std::vector<TrajectoryRow> rows_on_path(const PreparedRobot& robot, const Problem& problem,
                                        const std::vector<TrajectoryRow>& rows) {
  validate(problem);
  robot.require_prepared_for(problem);
  if (robot.arm().chain.free_roll && problem.rolls.empty()) {
    Problem turned = problem;
    turned.rolls = rolls_of(rows);
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
