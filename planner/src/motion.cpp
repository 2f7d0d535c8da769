// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/motion.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "swivel/core/input_error.hpp"
#include "swivel/core/invalid_argument.hpp"
#include "swivel/core/validate.hpp"

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
    return collision(0, rows_->size() - 1);
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
  MotionResult result;
  auto start = std::chrono::steady_clock::now();
  const Chain& chain = robot.arm().chain;
  const ToolPath path = problem_path(problem, chain, budget, PathSmoothing{});
  const PathMotion motion(chain, robot.srs(), path, rows);
  TimingResult timed = time_path(motion, joint_rates(chain, problem.limits, problem.source), options, budget);
  result.time_ms = ms_since(start);
  result.failure = timed.failure;
  if (!timed.motion) return result;
  start = std::chrono::steady_clock::now();
  result.failure = Proof(robot, problem, timed.motion->rows, budget).first_fault();
  result.check_ms = ms_since(start);
  if (!result.failure) result.motion = std::move(timed.motion);
  return result;
}

std::vector<TrajectoryRow> rows_on_path(const PreparedRobot& robot, const Problem& problem,
                                        const std::vector<TrajectoryRow>& rows) {
  validate(problem);
  robot.require_prepared_for(problem);
  const ToolPath path = problem_path(problem, robot.arm().chain);
  const PathMotion motion(robot.arm().chain, robot.srs(), path, rows);
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
