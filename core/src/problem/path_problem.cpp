// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/problem/path_problem.hpp"

#include <algorithm>
#include <cmath>

#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/problem/axis_frames.hpp"

namespace swivel {

namespace {

/// Returns the angle between the z axes of two waypoints, rad.
double angle_between_axes(const Waypoint& a, const Waypoint& b) {
  const Vector3d one = a.orientation * Vector3d::UnitZ(), other = b.orientation * Vector3d::UnitZ();
  return std::atan2(one.cross(other).norm(), one.dot(other));
}

/// Gives the last waypoint of a closed path the pose of the first, of which with `axis_alone` the
/// turn about the z axis does not count. Throws InputError where the two
/// are not one pose, or allow different rolls.
void close_at_first_pose(std::vector<Waypoint>& waypoints, bool axis_alone,
                         const std::string& source) {
  constexpr double kOnePose = 1e-6;  // m and rad
  const Waypoint& first = waypoints.front();
  Waypoint& last = waypoints.back();
  const double apart = (last.position - first.position).norm(),
               angle = axis_alone ? angle_between_axes(last, first)
                                  : last.orientation.angularDistance(first.orientation);
  if (!(apart <= kOnePose && angle <= kOnePose))
    throw InputError(source, "path.closed: waypoint " + std::to_string(waypoints.size() - 1) +
                                 ", the last, is " +
                                 formatted("%.3g m and %.3g rad", apart, angle) +
                                 " from the first: allowed is at most 1e-6 m and 1e-6 rad");
  if (last.roll != first.roll)
    throw InputError(source,
                     "path.closed: the last waypoint allows other rolls than the first: allowed is "
                     "one range at both");
  last.position = first.position;
  last.orientation = first.orientation;
}

}  // namespace

std::vector<Waypoint> given_waypoints_in_base(const PathProblem& problem) {
  Pose frame = Pose::Identity();
  if (problem.path_frame != problem.base_link && !problem.path_frame.empty()) {
    const auto object = std::find_if(problem.scene.begin(), problem.scene.end(),
                                     [&](const auto& o) { return o.name == problem.path_frame; });
    if (object == problem.scene.end())
      throw InputError(problem.source,
                       "path.frame: unknown frame '" + problem.path_frame +
                           "': allowed are the base link and the names of scene objects");
    frame = object->pose;
  }
  std::vector<Waypoint> result;
  result.reserve(problem.waypoints.size());
  for (std::size_t k = 0; k < problem.waypoints.size(); ++k) {
    const Waypoint& w = problem.waypoints[k];
    const double norm = w.orientation.norm();
    if (!w.position.allFinite() || !std::isfinite(norm) || std::abs(norm - 1) > 1e-3)
      throw InputError(
          problem.source,
          "path: waypoint " + std::to_string(k) +
              ": not a pose: allowed are finite numbers and a quaternion of length 1 within 1e-3");
    Waypoint moved = w;
    moved.position = frame * w.position;
    moved.orientation = (Quaterniond(frame.linear()) * w.orientation.normalized()).normalized();
    result.push_back(moved);
  }
  if (result.size() < 2)
    throw InputError(problem.source, "path: " + std::to_string(result.size()) +
                                         " waypoint(s): allowed are at least two");
  if (problem.closed) close_at_first_pose(result, axis_alone(problem), problem.source);
  return result;
}

bool axis_alone(const PathProblem& problem) {
  return problem.roll && problem.roll->circle() && problem.cost.roll == 0;
}

std::vector<Waypoint> waypoints_in_base(const PathProblem& problem) {
  std::vector<Waypoint> waypoints = given_waypoints_in_base(problem);
  if (axis_alone(problem)) carry_frames(waypoints);
  return waypoints;
}

}  // namespace swivel
