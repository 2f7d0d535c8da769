// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel {

/// Options of compute_cartesian_path().
struct CartesianPathOptions {
  double max_step = 0.005;  ///< largest distance between rows, m (Resolution::ds)
  Limits limits;
  /// False: nothing is kept clear of anything, neither the scene nor the robot's own bodies.
  bool avoid_collisions = true;
  /// By name of a joint: a range, rad or m, in which it must stay besides its limits.
  std::map<std::string, Joint::Range> bands;
  /// Whether the rows are refined and made a motion in time. The problem is then completed by
  /// with_motion_defaults().
  bool timed = false;
  /// Speed of the tool in the motion, m/s; unset: as fast as the joints allow.
  std::optional<double> tool_speed;
  /// Parts of the joints' speeds and accelerations that the motion uses, > 0, at most 1.
  double speed_scale = 1, acceleration_scale = 1;
  double rate = 250;  ///< samples of the motion a second
  PlanOptions plan;   ///< its time-out is for everything
};

/// How far an arm follows straight lines, and the joints that do.
struct CartesianPath {
  /// The share of the path's rows, after the first, that can be reached: 1 exactly where the whole
  /// path was planned.
  double fraction = 0;
  /// Rows from the begin of the path on, as far as it can be followed. None where the begin itself
  /// has no valid posture.
  std::vector<TrajectoryRow> rows;
  /// The motion along the rows, if it was asked for and there is one.
  std::optional<TimedPath> motion;
  /// Why the path is not followed to its end, or why there is no motion; empty: neither is so.
  std::string cause;
  PlanResult plan;  ///< of the whole path
  /// The problem whose path ends where the rows end: check_trajectory(problem, rows) proves them,
  /// if they are at least two.
  PathProblem problem;
};

/// Follows straight lines through waypoints as far as possible, as the function of this name does
/// that other software has: the tool moves straight, and turns evenly, from each pose to the next.
/// `waypoints` are poses of the tool in the robot's base link. With `start` (joints, rad, base to
/// tip) they follow the pose that the tool has there; without, the path begins at the first of
/// them, in the posture that suits it best.
///
/// Throws InputError and InvalidArgument for what no problem may have, and InvalidArgument for a
/// band of an unknown joint, an empty band, and a scale that is not above 0 and at most 1.
[[nodiscard]] CartesianPath compute_cartesian_path(const Robot& robot,
                                                   const std::vector<SceneObject>& scene,
                                                   const std::vector<Waypoint>& waypoints,
                                                   const std::optional<Config>& start,
                                                   const CartesianPathOptions& options = {});
/// Follows straight lines as the function above does, with a planner that is kept, whose scene
/// counts and whose task is replaced. Its robot must be cartesian_robot() of the same options,
/// which are not applied to it again. Throws as that function does.
[[nodiscard]] CartesianPath compute_cartesian_path(Planner& planner,
                                                   const std::vector<Waypoint>& waypoints,
                                                   const std::optional<Config>& start,
                                                   const CartesianPathOptions& options = {});

/// Returns the robot with the bands of the options as limits of its joints, and, where they say
/// that collisions are not avoided, without any bodies. Throws InvalidArgument for a null model, a
/// band of an unknown joint and a band that leaves a joint no position.
[[nodiscard]] Robot cartesian_robot(Robot robot, const CartesianPathOptions& options);

}  // namespace swivel
