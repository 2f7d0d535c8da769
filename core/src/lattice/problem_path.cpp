// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/problem_path.hpp"

#include <algorithm>
#include <string>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/messages/invalid_argument.hpp"

namespace swivel {

namespace {

Pose pose_of(const Waypoint& waypoint) {
  Pose pose = Pose::Identity();
  pose.linear() = waypoint.orientation.toRotationMatrix();
  return pose;
}

/// Returns a row with `angle` (rad) added to its roll.
TrajectoryRow turned_row(const Chain& chain, TrajectoryRow row, double angle) {
  if (angle == 0) return row;
  if (!chain.roll) {
    row.roll = wrap_angle(row.roll + angle);
    return row;
  }
  row.q[kDof - 1] += angle;
  row.phi += angle;
  return row;
}

double travel_of(const ToolPath& path, std::size_t layer) {
  return path.layer(static_cast<int>(layer)).travel;
}

}  // namespace

TrajectoryRow counted_from_waypoints(const Chain& chain, const ToolPath& path, double travel,
                                     TrajectoryRow row) {
  return turned_row(chain, row, -path.waypoint_turn(travel));
}

void count_from_waypoints(const Chain& chain, const ToolPath& path,
                          std::vector<TrajectoryRow>& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i] = counted_from_waypoints(chain, path, travel_of(path, i), rows[i]);
}

TrajectoryRow counted_from_path(const Chain& chain, const ToolPath& path, double travel,
                                TrajectoryRow row) {
  return turned_row(chain, row, path.waypoint_turn(travel));
}

void count_from_path(const Chain& chain, const ToolPath& path, std::vector<TrajectoryRow>& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i] = counted_from_path(chain, path, travel_of(path, i), rows[i]);
}

ToolPath problem_path(const PathProblem& problem, const Chain& chain, const Budget& budget,
                      const std::optional<PathSmoothing>& otherwise) {
  const std::vector<Waypoint> waypoints = waypoints_in_base(problem);
  ToolPath path(waypoints, problem.resolution, problem.source, budget,
                problem.smooth ? problem.smooth : otherwise, problem.roll && problem.roll->circle(),
                problem.steps);
  if (problem.closed) path.close();
  if (axis_alone(problem)) {
    std::vector<double> turns;
    const std::vector<Waypoint> given = given_waypoints_in_base(problem);
    for (std::size_t k = 0; k < waypoints.size(); ++k)
      turns.push_back(roll_between(pose_of(waypoints[k]), pose_of(given[k])));
    path.set_waypoint_turns(turns);
  }
  if (problem.start) {
    Pose tool = chain.tool(*problem.start);
    if (chain.free_roll || path.has_waypoint_turns()) {  // compare poses without the roll
      const double s = problem.start_at.value_or(0);
      int i = 0;
      while (i + 2 < path.size() && path.layer(i + 1).s < s) ++i;
      const double length = path.layer(i).step_length,
                   t = length > 0 ? std::clamp((s - path.layer(i).s) / length, 0.0, 1.0) : 0;
      const Pose there = path.at(i, t);
      tool = rolled(tool, -roll_between(there, tool));
      if (chain.roll) {  // which the start states, from the waypoint's own frame at its place
        ToolPath rest = path;
        rest.begin_at(problem.start_at, tool, problem.start_tolerance, problem.source);
        TrajectoryRow row;
        row.q = *problem.start;
        tool = chain.tool(counted_from_path(chain, rest, rest.layer(0).travel, row).q);
      }
    }
    path.begin_at(problem.start_at, tool, problem.start_tolerance, problem.source);
  }
  if (!problem.rolls.empty()) {
    if (problem.rolls.size() != static_cast<std::size_t>(path.size()))
      throw InvalidArgument("Task: " + std::to_string(problem.rolls.size()) +
                            " rolls: allowed is one for each layer, " +
                            std::to_string(path.size()));
    return path.with_rolls(problem.rolls);
  }
  return path;
}

}  // namespace swivel
