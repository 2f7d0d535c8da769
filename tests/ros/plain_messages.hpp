// SPDX-License-Identifier: BSD-3-Clause
// Structs with the members that MoveIt's messages have, as far as a service of
// compute_cartesian_path reads or writes them. C++17.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace swivel::test::plain {

struct Header {
  std::string frame_id;
};
struct Vector {
  double x = 0, y = 0, z = 0;
};
struct Quaternion {
  double x = 0, y = 0, z = 0, w = 0;
};
struct Pose {
  Vector position;
  Quaternion orientation;
};
struct Duration {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};
struct JointState {
  Header header;
  std::vector<std::string> name;
  std::vector<double> position;
};
struct MultiDOFJointState {
  std::vector<std::string> joint_names;
};
struct SolidPrimitive {
  std::uint8_t type = 0;
  std::vector<double> dimensions;
};
struct MeshTriangle {
  std::array<std::uint32_t, 3> vertex_indices{};
};
struct Mesh {
  std::vector<MeshTriangle> triangles;
  std::vector<Vector> vertices;
};
struct Plane {
  std::array<double, 4> coef{};
};
struct CollisionObject {
  Header header;
  Pose pose;
  std::string id;
  std::vector<SolidPrimitive> primitives;
  std::vector<Pose> primitive_poses;
  std::vector<Mesh> meshes;
  std::vector<Pose> mesh_poses;
  std::vector<Plane> planes;
  std::vector<Pose> plane_poses;
  std::uint8_t operation = 0;
};
struct AttachedCollisionObject {
  std::string link_name;
  CollisionObject object;
  std::vector<std::string> touch_links;
};
struct RobotState {
  JointState joint_state;
  MultiDOFJointState multi_dof_joint_state;
  std::vector<AttachedCollisionObject> attached_collision_objects;
  bool is_diff = false;
};
struct JointConstraint {
  std::string joint_name;
  double position = 0, tolerance_above = 0, tolerance_below = 0;
};
struct Anything {};
struct Constraints {
  std::vector<JointConstraint> joint_constraints;
  std::vector<Anything> position_constraints, orientation_constraints, visibility_constraints;
};
/// A request without the members that came later, as ROS 2 Humble has it.
struct OldRequest {
  Header header;
  RobotState start_state;
  std::string group_name, link_name;
  std::vector<Pose> waypoints;
  double max_step = 0, jump_threshold = 0, prismatic_jump_threshold = 0,
         revolute_jump_threshold = 0;
  bool avoid_collisions = false;
  Constraints path_constraints;
};
/// A request of ROS 1.
struct Request : OldRequest {
  std::string cartesian_speed_limited_link;
  double max_cartesian_speed = 0;
};
/// A request of ROS 2 Iron and later.
struct NewRequest : Request {
  double max_velocity_scaling_factor = 0, max_acceleration_scaling_factor = 0;
};
struct Point {
  std::vector<double> positions, velocities, accelerations;
  Duration time_from_start;
};
struct JointTrajectory {
  Header header;
  std::vector<std::string> joint_names;
  std::vector<Point> points;
};
struct RobotTrajectory {
  JointTrajectory joint_trajectory;
};
struct ErrorCode {
  std::int32_t val = 0;
};
struct Response {
  RobotState start_state;
  RobotTrajectory solution;
  double fraction = 0;
  ErrorCode error_code;
};
struct AllowedCollisionEntry {
  std::vector<bool> enabled;
};
struct AllowedCollisionMatrix {
  std::vector<std::string> entry_names;
  std::vector<AllowedCollisionEntry> entry_values;
  std::vector<std::string> default_entry_names;
  std::vector<bool> default_entry_values;
};
struct LinkPadding {
  std::string link_name;
  double padding = 0;
};
struct LinkScale {
  std::string link_name;
  double scale = 0;
};
struct Octomap {
  std::vector<std::int8_t> data;
};
struct OctomapWithPose {
  Octomap octomap;
};
struct PlanningSceneWorld {
  std::vector<CollisionObject> collision_objects;
  OctomapWithPose octomap;
};
struct PlanningScene {
  RobotState robot_state;
  AllowedCollisionMatrix allowed_collision_matrix;
  std::vector<LinkPadding> link_padding;
  std::vector<LinkScale> link_scale;
  PlanningSceneWorld world;
  bool is_diff = false;
};

/// The messages above, for tests of any messages.
struct Messages {
  using Request = plain::Request;
  using Response = plain::Response;
  using PlanningScene = plain::PlanningScene;
};

}  // namespace swivel::test::plain
