// SPDX-License-Identifier: BSD-3-Clause
// MoveIt's messages to and from the words of PathService, for the structs of ROS 1 (gencpp) and of
// ROS 2 (rosidl), whose members have the same names. C++17.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "swivel/ros/path_service.hpp"

namespace swivel::ros {

namespace detail {

// SWIVEL_ROS_HAS(NAME): has_NAME<Message> is true if the message has a member of this name, which
// the messages of some distributions lack.
#define SWIVEL_ROS_HAS(member)                                                        \
  template <class Message, class = void>                                              \
  struct Has_##member : std::false_type {};                                           \
  template <class Message>                                                            \
  struct Has_##member<Message, std::void_t<decltype(std::declval<Message>().member)>> \
      : std::true_type {};                                                            \
  template <class Message>                                                            \
  constexpr bool has_##member = Has_##member<Message>::value;
SWIVEL_ROS_HAS(max_velocity_scaling_factor)
SWIVEL_ROS_HAS(max_cartesian_speed)
SWIVEL_ROS_HAS(revolute_jump_threshold)
SWIVEL_ROS_HAS(nanosec)
SWIVEL_ROS_HAS(pose)
#undef SWIVEL_ROS_HAS

template <class Strings>
std::vector<std::string> strings(const Strings& from) {
  return {from.begin(), from.end()};
}

/// Sets a duration of either ROS, s.
template <class Duration>
void set_duration(double seconds, Duration& duration) {
  const auto nanoseconds = static_cast<std::int64_t>(std::llround(seconds * 1e9));
  duration.sec = static_cast<decltype(duration.sec)>(nanoseconds / 1000000000);
  const auto rest = nanoseconds % 1000000000;
  if constexpr (has_nanosec<Duration>)
    duration.nanosec = static_cast<decltype(duration.nanosec)>(rest);
  else
    duration.nsec = static_cast<decltype(duration.nsec)>(rest);
}

}  // namespace detail

/// Returns a geometry_msgs/Pose as it is.
template <class Pose>
Pose7 to_pose7(const Pose& pose) {
  return {pose.position.x,    pose.position.y,    pose.position.z,   pose.orientation.w,
          pose.orientation.x, pose.orientation.y, pose.orientation.z};
}

/// Moves a pose into the frame of which a geometry_msgs/Transform says where it is. The length of
/// its quaternion stays, which tells a pose that makes no sense.
template <class Transform>
void place(const Transform& at, Pose7& pose) {
  const auto &t = at.translation, &r = at.rotation;
  const auto turned = [&](double w, double x, double y, double z) {
    return Pose7{0,
                 0,
                 0,
                 r.w * w - r.x * x - r.y * y - r.z * z,
                 r.w * x + r.x * w + r.y * z - r.z * y,
                 r.w * y - r.x * z + r.y * w + r.z * x,
                 r.w * z + r.x * y - r.y * x + r.z * w};
  };
  const Pose7 turn = turned(pose.qw, pose.qx, pose.qy, pose.qz);
  const Pose7 v = turned(0, pose.x, pose.y, pose.z);  // times the conjugate: the turned position
  pose.x = t.x - v.qw * r.x + v.qx * r.w - v.qy * r.z + v.qz * r.y;
  pose.y = t.y - v.qw * r.y + v.qx * r.z + v.qy * r.w - v.qz * r.x;
  pose.z = t.z - v.qw * r.z - v.qx * r.y + v.qy * r.x + v.qz * r.w;
  pose.qw = turn.qw, pose.qx = turn.qx, pose.qy = turn.qy, pose.qz = turn.qz;
}

/// Returns the names and positions of a sensor_msgs/JointState.
template <class JointState>
JointValues to_joints(const JointState& state) {
  return {detail::strings(state.name), {state.position.begin(), state.position.end()}};
}

/// Returns a moveit_msgs/CollisionObject.
template <class CollisionObject>
Body to_body(const CollisionObject& object) {
  Body body;
  body.id = object.id;
  body.frame = object.header.frame_id;
  if constexpr (detail::has_pose<CollisionObject>) body.pose = to_pose7(object.pose);
  body.operation = static_cast<int>(object.operation);
  const auto wrong = [&](const char* what, std::size_t count, std::size_t poses) {
    if (count != poses && !(count == 1 && poses == 0))
      body.unsupported = "has " + std::to_string(count) + " " + what + " and " +
                         std::to_string(poses) + " poses of them";
  };
  wrong("primitives", object.primitives.size(), object.primitive_poses.size());
  wrong("meshes", object.meshes.size(), object.mesh_poses.size());
  if (!object.planes.empty()) body.unsupported = "has planes: allowed are primitives and meshes";
  if (!body.unsupported.empty()) return body;
  for (std::size_t k = 0; k < object.primitives.size(); ++k) {
    Solid& solid = body.solids.emplace_back();
    solid.kind = static_cast<int>(object.primitives[k].type);
    solid.dimensions.assign(object.primitives[k].dimensions.begin(),
                            object.primitives[k].dimensions.end());
    if (k < object.primitive_poses.size()) solid.pose = to_pose7(object.primitive_poses[k]);
    if (solid.kind < Solid::kBox || solid.kind > Solid::kCone)
      body.unsupported = "has a primitive of type " + std::to_string(solid.kind) +
                         ": allowed are box, sphere, cylinder and cone";
  }
  for (std::size_t k = 0; k < object.meshes.size(); ++k) {
    Solid& solid = body.solids.emplace_back();
    solid.kind = Solid::kMesh;
    for (const auto& vertex : object.meshes[k].vertices)
      solid.vertices.insert(solid.vertices.end(), {vertex.x, vertex.y, vertex.z});
    for (const auto& triangle : object.meshes[k].triangles)
      solid.triangles.insert(solid.triangles.end(), triangle.vertex_indices.begin(),
                             triangle.vertex_indices.end());
    if (k < object.mesh_poses.size()) solid.pose = to_pose7(object.mesh_poses[k]);
  }
  return body;
}

/// Returns a moveit_msgs/AttachedCollisionObject.
template <class AttachedCollisionObject>
Body to_attached(const AttachedCollisionObject& attached) {
  Body body = to_body(attached.object);
  body.link = attached.link_name;
  body.touch_links = detail::strings(attached.touch_links);
  return body;
}

/// Returns a request of moveit_msgs/GetCartesianPath.
template <class Request>
Query to_query(const Request& request) {
  Query query;
  query.frame = request.header.frame_id;
  query.group = request.group_name;
  query.link = request.link_name;
  query.start = to_joints(request.start_state.joint_state);
  query.start_is_diff = request.start_state.is_diff;
  for (const auto& attached : request.start_state.attached_collision_objects)
    query.attached.push_back(to_attached(attached));
  for (const auto& pose : request.waypoints) query.waypoints.push_back(to_pose7(pose));
  query.max_step = request.max_step;
  query.jump_factor = request.jump_threshold;
  if constexpr (detail::has_revolute_jump_threshold<Request>)
    query.revolute_jump = request.revolute_jump_threshold;
  query.avoid_collisions = request.avoid_collisions;
  if constexpr (detail::has_max_velocity_scaling_factor<Request>) {
    query.speed_scale = request.max_velocity_scaling_factor;
    query.acceleration_scale = request.max_acceleration_scaling_factor;
  }
  if constexpr (detail::has_max_cartesian_speed<Request>) {
    query.tool_speed = request.max_cartesian_speed;
    query.speed_link = request.cartesian_speed_limited_link;
  }
  const auto& constraints = request.path_constraints;
  for (const auto& joint : constraints.joint_constraints)
    query.bands.push_back(
        {joint.joint_name, joint.position, joint.tolerance_above, joint.tolerance_below});
  const auto refuse = [&](bool given, const char* what) {
    if (given) query.unsupported.emplace_back(what);
  };
  refuse(!constraints.position_constraints.empty(), "position_constraints");
  refuse(!constraints.orientation_constraints.empty(), "orientation_constraints");
  refuse(!constraints.visibility_constraints.empty(), "visibility_constraints");
  refuse(!request.start_state.multi_dof_joint_state.joint_names.empty(),
         "start_state.multi_dof_joint_state");
  return query;
}

/// Fills in a response of moveit_msgs/GetCartesianPath.
template <class Response>
void fill(const Answer& answer, Response& response) {
  response.error_code.val = answer.code;
  response.fraction = answer.fraction;
  auto& state = response.start_state.joint_state;
  state.header.frame_id = answer.frame;
  state.name.assign(answer.start.names.begin(), answer.start.names.end());
  state.position.assign(answer.start.positions.begin(), answer.start.positions.end());
  auto& trajectory = response.solution.joint_trajectory;
  trajectory.header.frame_id = answer.frame;
  trajectory.joint_names.assign(answer.joints.begin(), answer.joints.end());
  trajectory.points.resize(answer.points.size());
  for (std::size_t k = 0; k < answer.points.size(); ++k) {
    const Point& from = answer.points[k];
    auto& point = trajectory.points[k];
    point.positions.assign(from.positions.begin(), from.positions.end());
    point.velocities.assign(from.velocities.begin(), from.velocities.end());
    point.accelerations.assign(from.accelerations.begin(), from.accelerations.end());
    detail::set_duration(from.time, point.time_from_start);
  }
}

/// A moveit_msgs/PlanningScene.
struct SceneChange {
  std::vector<Body> bodies;
  AllowedPairs allowed;
  bool diff = false;
  std::string unchecked;              ///< what is not checked for collisions; empty: nothing
  bool says_unchecked = false;        ///< `unchecked` is new
  std::vector<std::string> warnings;  ///< what is passed over, one line each
};

/// Returns what an AllowedCollisionMatrix says.
template <class Matrix>
AllowedPairs to_allowed(const Matrix& matrix) {
  AllowedPairs allowed;
  allowed.given = !matrix.entry_names.empty() || !matrix.default_entry_names.empty();
  for (std::size_t k = 0; k < matrix.default_entry_names.size(); ++k)
    if (k < matrix.default_entry_values.size() && matrix.default_entry_values[k])
      allowed.with_all.push_back(matrix.default_entry_names[k]);
  const std::size_t count = matrix.entry_values.size();
  for (std::size_t i = 0; i < matrix.entry_names.size() && i < count; ++i)
    for (std::size_t j = i + 1; j < matrix.entry_names.size() && j < count; ++j) {
      const auto& row = matrix.entry_values[i].enabled;
      if (j >= row.size()) continue;
      auto& pairs = row[j] ? allowed.pairs : allowed.apart;
      pairs.emplace_back(matrix.entry_names[i], matrix.entry_names[j]);
    }
  return allowed;
}

/// Returns a moveit_msgs/PlanningScene.
template <class PlanningScene>
SceneChange to_scene(const PlanningScene& scene) {
  SceneChange change;
  change.diff = scene.is_diff;
  for (const auto& object : scene.world.collision_objects) change.bodies.push_back(to_body(object));
  for (const auto& attached : scene.robot_state.attached_collision_objects)
    change.bodies.push_back(to_attached(attached));
  change.allowed = to_allowed(scene.allowed_collision_matrix);
  const bool octomap = !scene.world.octomap.octomap.data.empty();
  change.says_unchecked = octomap || !scene.is_diff;
  if (octomap) change.unchecked = "an octomap";
  for (const auto& link : scene.link_padding)
    if (link.padding != 0)
      change.warnings.push_back("the padding of link '" + link.link_name +
                                "' is passed over: ~clearance holds for all bodies");
  for (const auto& link : scene.link_scale)
    if (link.scale != 1)
      change.warnings.push_back("the scale of link '" + link.link_name + "' is passed over");
  return change;
}

}  // namespace swivel::ros
