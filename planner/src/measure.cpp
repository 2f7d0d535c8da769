// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "measure_rows.hpp"
#include "swivel/core/angle.hpp"
#include "swivel/core/invalid_argument.hpp"
#include "swivel/core/lattice.hpp"
#include "swivel/core/validate.hpp"

namespace swivel {

namespace {

/// Measured between the base's vertical and the elbow, in the plane normal to S->W: the convention of vendors and of Shimizu 2008.
double conventional_arm_angle(const SrsArm& arm, const Pose& tool, const Config& q) {
  const double axis_angle = first_plane(arm, tool).angle_of(arm.elbow_axis(q));
  return wrap_angle(axis_angle +
                    (std::sin(arm.elbow_angle(q)) > 0 ? kPi : 0));  // axis 4 stands at a right angle to the elbow, by its sign
}

void measure_tool_path_error(const Chain& chain, const ToolPath& path, const std::vector<TrajectoryRow>& trajectory,
                             const Budget& budget, Measures& result) {
  double sum = 0;
  std::int64_t samples = 0;
  const int rows = static_cast<int>(trajectory.size());
  for (int i = 0; i + 1 < rows; ++i) {
    if (i % 64 == 0) budget.poll(Stage::kMeasuring, i, rows);
    const Config& q = trajectory[static_cast<std::size_t>(i)].q;
    for (const double error : path_deviation(chain, path, i, q, trajectory[static_cast<std::size_t>(i) + 1].q - q)) {
      sum += error;
      ++samples;
      if (1e3 * error <= result.tool_path_error_mm.max) continue;
      result.tool_path_error_mm.max = 1e3 * error;
      result.tool_path_error_mm.row = i;
    }
  }
  result.tool_path_error_mm.mean = 1e3 * sum / static_cast<double>(samples);
  result.evidence.tool_path_error = true;
}

void measure_postures(const PreparedRobot& robot, const ToolPath& path, const World& world,
                      const std::vector<TrajectoryRow>& trajectory, const Budget& budget, Measures& result) {
  World::Query query(world, Certificates::kOn);
  std::optional<double> least;
  std::optional<LeastMargin> margin;
  double manipulability = std::numeric_limits<double>::infinity();
  std::vector<double> arm_angle;
  const int rows = static_cast<int>(trajectory.size());
  for (int i = 0; i < rows; ++i) {
    budget.poll(Stage::kMeasuring, i, rows);
    const Config& q = trajectory[static_cast<std::size_t>(i)].q;
    manipulability = std::min(manipulability, robot.arm().chain.manipulability(q));
    if (const auto& srs = robot.arm_class().srs) arm_angle.push_back(conventional_arm_angle(*srs, path.layer(i).tool, q));
    const auto clearance = query.clearance(q);
    if (!clearance) continue;
    least = std::min(least.value_or(clearance->least), clearance->least);
    if (!margin || clearance->margin() < margin->margin)
      margin = {clearance->margin(), clearance->distance, clearance->required, world.names(clearance->pair), i};
  }
  result.min_clearance = least;
  result.min_margin = std::move(margin);
  result.min_manipulability = manipulability;
  result.arm_angle = std::move(arm_angle);
  result.evidence.postures = true;
}

std::optional<NearestLimit> nearest_limit(const Chain& chain, const std::vector<TrajectoryRow>& rows) {
  std::optional<NearestLimit> nearest;
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t k = 0; k < kDof; ++k) {
      if (chain.limit[k].continuous || chain.limit[k].wide()) continue;
      const double q = rows[i].q[static_cast<Eigen::Index>(k)];
      const double to_lower = q - chain.limit[k].lower, to_upper = chain.limit[k].upper - q, margin = std::min(to_lower, to_upper);
      if (nearest && margin >= nearest->margin) continue;
      nearest = {margin, chain.joint_names[k], to_lower <= to_upper ? Cause::Side::kLower : Cause::Side::kUpper,
                 static_cast<int>(i)};
    }
  return nearest;
}

std::optional<TopToolSpeed> top_tool_speed(const Chain& chain, const ToolPath& path, const std::vector<TrajectoryRow>& rows) {
  std::optional<TopToolSpeed> top;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const double length = path.layer(static_cast<int>(i)).step_length;
    if (length <= 0) continue;                                          // a turn in place asks for no speed
    for (std::size_t k = 0; k < (chain.roll ? kDof - 1 : kDof); ++k) {  // the roll has no speed of its own
      const double velocity = chain.limit[k].velocity;
      if (velocity <= 0) return std::nullopt;
      const auto j = static_cast<Eigen::Index>(k);
      const double moved = std::abs(rows[i + 1].q[j] - rows[i].q[j]);
      if (top ? length * velocity < top->speed * moved : moved > 0)
        top = {length * velocity / moved, chain.joint_names[k], static_cast<int>(i)};
    }
  }
  return top;
}

}  // namespace

void measure_margins(const Chain& chain, const ToolPath& path, const std::vector<TrajectoryRow>& rows, Measures& measures) {
  measures.nearest_limit = nearest_limit(chain, rows);
  measures.top_tool_speed = top_tool_speed(chain, path, rows);
}

void measure_rows(const PreparedRobot& robot, const ToolPath& path, const World& world, const std::vector<TrajectoryRow>& rows,
                  const Evidence& wanted, const Budget& budget, Measures& measures) {
  if (wanted.tool_path_error) measure_tool_path_error(robot.arm().chain, path, rows, budget, measures);
  if (wanted.postures) measure_postures(robot, path, world, rows, budget, measures);
}

Measures measure(const PreparedRobot& robot, const Problem& problem, const std::vector<TrajectoryRow>& rows, const Evidence& wanted,
                 const Budget& budget) {
  validate(problem);
  robot.require_prepared_for(problem);
  const Chain& chain = robot.arm().chain;
  const ToolPath path = problem_path(problem, chain, budget);
  if (rows.size() != static_cast<std::size_t>(path.size()))
    throw InvalidArgument("measure: " + std::to_string(rows.size()) + " rows: allowed are as many as the path has layers, " +
                          std::to_string(path.size()));
  Measures measures;
  measures.tool_path_error_mm.allowed = problem.limits.tool_path_error;
  measure_margins(chain, path, rows, measures);
  measure_rows(robot, path, World(robot.world(), problem, budget), rows, wanted, budget, measures);
  return measures;
}

}  // namespace swivel
