// SPDX-License-Identifier: BSD-3-Clause
#include "refine/motion_faults.hpp"

#include <algorithm>
#include <cmath>

#include "measure/first_clearance_violation.hpp"
#include "swivel/core/kinematics/newton/nearest_allowed_posture.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "verify/answer_check.hpp"

namespace swivel {

namespace {

/// Returns which joint limit a sample exceeds, or that its manipulability is too low; none if it
/// keeps both. Limits are narrower by `inside`, rad.
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

/// Returns the travel at s, m; none if the path only turns there.
std::optional<double> travel_at(const ToolPath& path, double s) {
  for (int i = 0; i + 1 < path.size(); ++i) {
    const PathLayer &from = path.layer(i), &to = path.layer(i + 1);
    if (s < to.s && from.step_length > 0)
      return from.travel +
             std::max(0.0, (s - from.s) / (to.s - from.s)) * (to.travel - from.travel);
  }
  return std::nullopt;
}

}  // namespace

std::optional<Fault> first_fault(const PreparedRobot& robot, const PathProblem& of_samples,
                                 const std::vector<TimedRow>& rows, const Budget& budget) {
  std::vector<Config> samples;
  for (const TimedRow& row : rows) {
    if (auto fault = fault_of_joints(robot.arm().chain, of_samples.limits, row.row))
      return Fault{*fault, samples.size()};
    samples.push_back(row.row.q);
  }
  const World world(robot.world(), of_samples, budget, kVerdictBand);
  const auto found = first_clearance_violation(world, world.edge_rule(robot.radii()),
                                               of_samples.limits, samples, budget);
  if (!found) return std::nullopt;
  const auto names = world.names(found->pair);
  NoMotion fault{rows[found->row].row.s, "'" + names[0] + "' and '" + names[1] + "' come too near" +
                                             (found->between ? " between samples" : "")};
  fault.too_near = true;
  return Fault{std::move(fault), found->row};
}

std::optional<BetweenRow> Bisection::posture(const std::vector<TimedRow>& rows, std::size_t first) {
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

bool Bisection::allowed(const Config& q) {
  // rad and m, so that the samples beside are allowed as well
  constexpr double kInside = 1e-4, kClear = 1e-4;
  TrajectoryRow row;
  row.q = q;
  return !fault_of_joints(*chain_, problem_->limits, row, kInside) &&
         !query_.find_violating_pair(q, Threshold(ClearanceRule::kNode, kClear));
}

bool strays_between(const PreparedRobot& robot, const PathProblem& problem, const TimedPath& motion,
                    const Budget& budget) {
  // Beside a corner, the distance half way between samples is at least this share of the largest.
  constexpr double kShare = 0.5;
  const Limits& limits = problem.limits;
  if (!(limits.tool_path_error && motion.between_position > kShare * *limits.tool_path_error) &&
      !(limits.tool_angle_error && motion.between_angle > kShare * *limits.tool_angle_error))
    return false;
  const CheckResult check = check_motion_in(robot.world(), robot, problem, motion.rows,
                                            {.margins = false, .budget = budget});
  return check.worst_path_error > 0 || check.worst_path_angle > 0;  // of moves that fail
}

TimingOptions within_limits(TimingOptions options, const Limits& limits,
                            std::vector<std::string>& warnings) {
  const auto lower = [&](double& asked, const std::optional<double>& limit, const char* format) {
    if (!limit || asked <= *limit) return;
    warnings.push_back(formatted(format, asked, *limit));
    asked = *limit;
  };
  double fastest = options.speed;
  for (const SpeedFrom& from : options.speeds) fastest = std::max(fastest, from.speed);
  lower(fastest, limits.tool_speed,
        "a tool speed of %.6g m/s is asked for: limits.tool_speed allows %.6g m/s, which is kept");
  options.speed = std::min(options.speed, fastest);
  for (SpeedFrom& from : options.speeds) from.speed = std::min(from.speed, fastest);
  if (!options.turn_speed) options.turn_speed = limits.tool_turn_speed;
  if (options.turn_speed)
    lower(*options.turn_speed, limits.tool_turn_speed,
          "a turn speed of %.6g rad/s is asked for: limits.tool_turn_speed allows %.6g rad/s, "
          "which is kept");
  return options;
}

void require_positive(const TimingOptions& options) {
  const auto positive = [](double value, const char* name) {
    if (!(value > 0) || !std::isfinite(value))
      throw InvalidArgument(std::string("TimingOptions: ") + name + " is " +
                            formatted("%.9g", value) + ": allowed is a finite number > 0");
  };
  positive(options.speed, "speed");
  for (const SpeedFrom& from : options.speeds) positive(from.speed, "speeds");
  positive(options.turn_speed.value_or(1), "turn_speed");
  positive(options.rate, "rate");
  positive(options.chord.value_or(1), "chord");
}

}  // namespace swivel
