// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/motion.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <span>
#include <utility>

#include "between_samples.hpp"
#include "measure_rows.hpp"
#include "swivel/core/input_error.hpp"
#include "swivel/core/invalid_argument.hpp"
#include "swivel/core/validate.hpp"
#include "swivel/planner/refine.hpp"

namespace swivel {

namespace {

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Looks for what is wrong with a motion first, in the order of time.
class Proof {
 public:
  Proof(const PreparedRobot& robot, const Problem& problem, const std::vector<TimedRow>& rows, const Budget& budget)
      : limits_(&problem.limits),
        chain_(&robot.arm().chain),
        rows_(&rows),
        world_(robot.world(), problem, budget, kVerdictBand),
        rule_(world_.edge_rule(robot.radii())),
        at_(world_, Certificates::kOn),
        between_(world_, Certificates::kOn),
        budget_(&budget),
        grouped_(limits_->edges == EdgeMode::kContinuous && limits_->d_edge() <= limits_->clearance &&
                 limits_->d_self_edge() <= limits_->d_self()) {
    for (const TimedRow& row : rows)
      moved_.push_back(moved_.empty() ? 0 : moved_.back() + rule_.motion(last_, row.row.q)), last_ = row.row.q;
  }

  std::optional<NoMotion> first_fault() {
    for (const TimedRow& row : *rows_)
      if (auto fault = joints_at(row.row)) return fault;
    auto fault = collision(0, rows_->size() - 1);
    if (fault) fault->too_near = true;
    return fault;
  }

 private:
  [[nodiscard]] std::optional<NoMotion> joints_at(const TrajectoryRow& row) const {
    constexpr double kLimit = 1e-9;  // rad
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain_->limit[j];
      const double q = row.q[static_cast<Eigen::Index>(j)];
      if (!limit.continuous &&
          !(q >= limit.lower + limits_->joint_margin - kLimit && q <= limit.upper - limits_->joint_margin + kLimit))
        return NoMotion{row.s, "joint '" + chain_->joint_names[j] + "' leaves its limits between layers"};
    }
    if (limits_->manipulability > 0 && chain_->manipulability(row.q) < limits_->manipulability - 1e-9)
      return NoMotion{row.s, "manipulability is too low between layers"};
    return std::nullopt;
  }

  /// From sample `first` to sample `last`. All of it is free where the middle is clear by as much as anything moves from there.
  std::optional<NoMotion> collision(std::size_t first, std::size_t last) {
    budget_->poll();
    const auto row = [&](std::size_t k) -> const TrajectoryRow& { return (*rows_)[k].row; };
    const std::size_t middle = (first + last) / 2;
    if (grouped_ && last > first) {
      const double most = std::max(moved_[middle] - moved_[first], moved_[last] - moved_[middle]);
      if (!at_.next_below(row(middle).q, Level(Keep::kNode, most))) return std::nullopt;
    }
    if (last > first + 1) {
      auto fault = collision(first, middle);
      return fault ? fault : collision(middle, last);
    }
    for (std::size_t k = first; k <= last; ++k)
      if (const auto pair = at_.next_below(row(k).q, Keep::kNode)) return NoMotion{row(k).s, too_near(*pair)};
    if (last > first && limits_->edges == EdgeMode::kContinuous)
      if (const auto pair = edge_blocked(between_, rule_, row(first).q, row(last).q, *budget_))
        return NoMotion{row(last).s, too_near(*pair) + " between samples"};
    return std::nullopt;
  }

  [[nodiscard]] std::string too_near(const BodyPair& pair) const {
    const auto names = world_.names(pair);
    return "'" + names[0] + "' and '" + names[1] + "' come too near";
  }

  const Limits* limits_;
  const Chain* chain_;
  const std::vector<TimedRow>* rows_;
  World world_;
  EdgeRule rule_;
  World::Query at_, between_;
  const Budget* budget_;
  bool grouped_;               // what is clear enough at samples is so between them
  std::vector<double> moved_;  // up to each sample: a bound on the way of any point, m
  Config last_ = Config::Zero();
};

}  // namespace

void keep_clearance_between_layers(Limits& limits) {
  if (!limits.edge_clearance && !limits.self_clearance) limits.edge_clearance = limits.clearance;
}

Problem with_motion_defaults(Problem problem) {
  if (!problem.smooth) problem.smooth.emplace();
  keep_clearance_between_layers(problem.limits);
  return problem;
}

MotionResult time_trajectory(const PreparedRobot& robot, const Problem& problem, const std::vector<TrajectoryRow>& rows,
                             const TimingOptions& options, const Budget& budget) {
  validate(problem);
  robot.require_prepared_for(problem);
  const auto positive = [&](double value, const char* name) {
    if (!(value > 0) || !std::isfinite(value))
      throw InvalidArgument(std::string("TimingOptions: ") + name + " is " + std::to_string(value) +
                            ": allowed is a finite number > 0");
  };
  positive(options.speed, "speed");
  positive(options.turn_speed.value_or(1), "turn_speed");
  positive(options.rate, "rate");
  const Chain& chain = robot.arm().chain;
  const ToolPath path = problem_path(problem, chain, budget, PathSmoothing{});
  const JointRates rates = joint_rates(chain, problem.limits, problem.source);
  const Problem of_samples = problem_of_samples(problem);
  MotionResult result;
  // Through every row only where the smoother motion will not do.
  for (const double apart : {0.005, 0.0}) {  // m
    auto start = std::chrono::steady_clock::now();
    const PathMotion motion(chain, robot.srs("timing a trajectory"), path, rows, apart);
    TimingResult timed = time_path(motion, rates, options, budget);
    result.time_ms += ms_since(std::exchange(start, std::chrono::steady_clock::now()));
    result.failure = timed.failure;
    if (timed.motion) result.failure = Proof(robot, of_samples, timed.motion->rows, budget).first_fault();
    result.check_ms += ms_since(start);
    if (!result.failure) result.motion = std::move(timed.motion);
    if (!result.failure || !motion.jumps().empty() || motion.knots().size() == rows.size()) break;
  }
  return result;
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
    for (std::size_t k = 0; k < motions.size(); ++k) allowed[k] = arm_->branch(motions[k].from) == arm_->branch(motions[k].to);
  }

 private:
  const SrsArm* arm_;
};

bool changes_branch(const std::vector<TrajectoryRow>& rows) {
  return std::any_of(rows.begin(), rows.end(), [&](const TrajectoryRow& row) { return row.branch != rows[0].branch; });
}

/// A path that never changes branch, where there is one: else the one there is.
PlanResult plan_executable(Planner& planner, const PlanOptions& options, bool one_branch) {
  PlanResult found = planner.plan(options);
  if (!one_branch || found.status != PlanStatus::kSolved || !changes_branch(found.trajectory) || options.hooks.check) return found;
  PlanOptions keeping = options;
  keeping.hooks.check = std::make_shared<KeepsBranch>(planner.view().robot.srs("timing"));
  PlanResult other = planner.plan(keeping);
  if (other.status != PlanStatus::kSolved) return planner.plan(options);  // for its view
  char text[160];
  std::snprintf(text, sizeof text,
                "the cheapest path, of cost %.6g, jumps to another branch, which no controller can follow: this is the cheapest "
                "that does not",
                found.cost);
  other.warnings.emplace_back(text);
  return other;
}

/// Puts refined rows in the place of the lattice's.
void take(const Refined& refined, const PlanView& view, PlanResult& result) {
  if (!refined.refined) return;
  result.trajectory = refined.rows;
  result.cost = refined.cost;
  measure_margins(view.robot.arm().chain, view.lattice.path(), result.trajectory, result);
}

}  // namespace

MotionPlan plan_motion(Planner& planner, const PlanOptions& options, bool refined, const std::optional<TimingOptions>& timing) {
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
        result.time_ms["refine"] += ms_since(std::exchange(start, std::chrono::steady_clock::now()));
      }
      if (!timing) break;
      plan.motion = time_trajectory(view.robot, view.problem, refined ? plan.refinement->rows : plan.lattice_path, *timing, budget);
      result.time_ms["time"] += ms_since(std::exchange(start, std::chrono::steady_clock::now()));
      if (!refined || !plan.motion->failure || !plan.motion->failure->too_near || margins.extra_clearance > kMostExtra) break;
    }
  } catch (const Stopped&) {
    plan.stopped = true;
    if (refined && !plan.refinement)
      plan.refinement = Refined{.rows = plan.lattice_path, .reason = "stopped", .cost_before = result.cost, .cost = result.cost};
    if (timing && (!plan.motion || !plan.motion->motion)) plan.motion.emplace().failure = NoMotion{0, "stopped"};
  }
  if (!refined) return plan;
  take(*plan.refinement, view, result);
  try {
    measure_rows(view.robot, view.lattice.path(), view.world, result.trajectory, options.evidence, budget, result);
  } catch (const Stopped&) {
  }
  return plan;
}

std::vector<TrajectoryRow> rows_on_path(const PreparedRobot& robot, const Problem& problem,
                                        const std::vector<TrajectoryRow>& rows) {
  validate(problem);
  robot.require_prepared_for(problem);
  const ToolPath path = problem_path(problem, robot.arm().chain);
  const PathMotion motion(robot.arm().chain, robot.srs("timing a trajectory"), path, rows);
  std::vector<TrajectoryRow> laid;
  for (int i = 0; i < path.size(); ++i) {
    const double travel = path.layer(i).travel;
    const auto q = motion.joints(travel);
    if (!q)
      throw InputError(problem.source + ": path.smooth: the arm has no solution at s = " + std::to_string(path.layer(i).s) +
                       ": allowed are smaller tolerances");
    laid.push_back(motion.row(travel, *q));
    laid.back().s = path.layer(i).s;
  }
  return laid;
}

}  // namespace swivel
