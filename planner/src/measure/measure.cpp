// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/measure/measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "measure/deepest_contact.hpp"
#include "measure/measure_rows.hpp"
#include "measure/nearest_approach.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/lattice/places_near.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/validate.hpp"

namespace swivel {

namespace {

void measure_tool_path_error(const Chain& chain, const ToolPath& path,
                             const std::vector<TrajectoryRow>& trajectory, const Budget& budget,
                             Measures& result) {
  double sum = 0;
  std::int64_t samples = 0;
  const int rows = static_cast<int>(trajectory.size());
  for (int i = 0; i + 1 < rows; ++i) {
    if (i % 64 == 0) budget.poll(Stage::kMeasuring, i, rows);
    const Config& q = trajectory[static_cast<std::size_t>(i)].q;
    for (const double error :
         path_deviation(chain, path, i, q, trajectory[static_cast<std::size_t>(i) + 1].q - q)) {
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
                      const std::vector<TrajectoryRow>& trajectory, const Budget& budget,
                      Measures& result) {
  double manipulability = std::numeric_limits<double>::infinity();
  std::vector<double> arm_angle;
  const int rows = static_cast<int>(trajectory.size());
  for (int i = 0; i < rows; ++i) {
    if (i % 64 == 0) budget.poll(Stage::kMeasuring, i, rows);
    const Config& q = trajectory[static_cast<std::size_t>(i)].q;
    manipulability = std::min(manipulability, robot.arm().chain.manipulability(q));
    if (const auto& srs = robot.arm_class().srs)
      arm_angle.push_back(conventional_arm_angle(
          *srs,
          rolled(path.layer(i).tool,
                 counted_from_path(robot.arm().chain, path, path.layer(i).travel,
                                   trajectory[static_cast<std::size_t>(i)])
                     .roll),
          q));
  }
  if (const auto nearest = nearest_approach(world, trajectory, Seek::kMarginAndLeast, budget)) {
    const World::Query::Clearance& c = nearest->clearance;
    result.min_clearance = nearest->least;
    result.min_margin = {c.margin(), c.distance, c.required, world.names(c.pair), nearest->row};
  }
  result.min_manipulability = manipulability;
  result.arm_angle = std::move(arm_angle);
  result.evidence.postures = true;
}

void measure_contact(const World& world, const std::vector<TrajectoryRow>& trajectory,
                     const Budget& budget, Measures& result) {
  std::vector<Config> joints;
  for (const TrajectoryRow& row : trajectory) joints.push_back(row.q);
  result.deepest_contact = deepest_contact(world, joints, budget);
  result.evidence.contact = true;
}

/// Returns the nearest limit of the joints that turn, or of those that slide.
std::optional<NearestLimit> nearest_limit(const Chain& chain,
                                          const std::vector<TrajectoryRow>& rows, bool slides) {
  double least = std::numeric_limits<double>::infinity();
  std::size_t row = 0, joint = 0;
  for (std::size_t k = 0; k < kDof; ++k) {
    const JointLimit& limit = chain.limit[k];
    if (limit.continuous || limit.wide() || limit.slides != slides) continue;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double q = rows[i].q[static_cast<Eigen::Index>(k)],
                   margin = std::min(q - limit.lower, limit.upper - q);
      if (std::tie(margin, i, k) < std::tie(least, row, joint)) least = margin, row = i, joint = k;
    }
  }
  if (std::isinf(least)) return std::nullopt;
  const double q = rows[row].q[static_cast<Eigen::Index>(joint)];
  const bool is_lower = q - chain.limit[joint].lower <= chain.limit[joint].upper - q;
  return NearestLimit{least, chain.joint_names[joint],
                      is_lower ? Cause::Side::kLower : Cause::Side::kUpper, static_cast<int>(row),
                      slides};
}

std::optional<TopToolSpeed> top_tool_speed(const Chain& chain, const ToolPath& path,
                                           const std::vector<TrajectoryRow>& rows) {
  const std::size_t joints = chain.roll ? kDof - 1 : kDof;  // the roll has no speed limit
  double speed = std::numeric_limits<double>::infinity();
  std::size_t row = 0, joint = 0;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const PathLayer& step = path.layer(static_cast<int>(i));
    const double length = step.step_length;
    if (length <= 0 || turns_on_the_spot(step)) continue;  // bounds no speed
    for (std::size_t k = 0; k < joints; ++k) {
      const double velocity = chain.limit[k].velocity;
      if (velocity <= 0) return std::nullopt;
      const auto j = static_cast<Eigen::Index>(k);
      const double moved = std::abs(rows[i + 1].q[j] - rows[i].q[j]);
      if (moved > 0 && length * velocity < speed * moved)
        speed = length * velocity / moved, row = i, joint = k;
    }
  }
  if (std::isinf(speed)) return std::nullopt;
  return TopToolSpeed{speed, chain.joint_names[joint], static_cast<int>(row)};
}

}  // namespace

void measure_margins(const Chain& chain, const ToolPath& path,
                     const std::vector<TrajectoryRow>& rows, Measures& measures) {
  measures.nearest_limit = nearest_limit(chain, rows, false);
  measures.nearest_slide_limit = nearest_limit(chain, rows, true);
  measures.top_tool_speed = top_tool_speed(chain, path, rows);
}

void ask_for(const Evidence& wanted, bool may_touch, Measures& measures) {
  measures.asked = wanted;
  measures.asked.layers = false;  // where there is a trajectory, no layers are empty
  measures.evidence.contact = wanted.contact && !may_touch;
}

void measure_rows(const PreparedRobot& robot, const ToolPath& path, const World& world,
                  const std::vector<TrajectoryRow>& rows, const Evidence& wanted,
                  const Budget& budget, Measures& measures) {
  ask_for(wanted, !world.allowed().empty(), measures);
  if (wanted.tool_path_error)
    measure_tool_path_error(robot.arm().chain, path, rows, budget, measures);
  if (wanted.postures) measure_postures(robot, path, world, rows, budget, measures);
  if (wanted.contact && !measures.evidence.contact) measure_contact(world, rows, budget, measures);
}

Measures measure(const PreparedRobot& robot, const PathProblem& problem,
                 const std::vector<TrajectoryRow>& rows, const Evidence& wanted,
                 const Budget& budget) {
  validate(problem);
  robot.require_prepared_for(problem);
  const Chain& chain = robot.arm().chain;
  const ToolPath path = problem_path(problem, chain, budget);
  if (rows.size() != static_cast<std::size_t>(path.size()))
    throw InvalidArgument("measure: " + std::to_string(rows.size()) +
                          " rows: allowed are as many as the path has layers, " +
                          std::to_string(path.size()));
  Measures measures;
  measures.tool_path_error_mm.allowed = problem.limits.tool_path_error;
  measure_margins(chain, path, rows, measures);
  measure_rows(robot, path, World(robot.world(), problem, budget), rows, wanted, budget, measures);
  return measures;
}

}  // namespace swivel
