// SPDX-License-Identifier: BSD-3-Clause
// Requests of compute_cartesian_path as MoveIt's clients make them, each with the error code and
// the fraction of its answer, for messages of any kind. C++17.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "convert.hpp"
#include "plain_messages.hpp"

namespace swivel::test {

/// Returns a query as a text with all that it says.
inline std::string text_of(const ros::Query& query) {
  std::ostringstream out;
  out.precision(17);
  const auto pose = [&](const ros::Pose7& p) {
    out << p.x << ' ' << p.y << ' ' << p.z << ' ' << p.qw << ' ' << p.qx << ' ' << p.qy << ' '
        << p.qz << '\n';
  };
  const auto all = [&](const auto& items) {
    for (const auto& item : items) out << item << ' ';
    out << '\n';
  };
  out << query.frame << '|' << query.group << '|' << query.link << '|' << query.start_is_diff << '|'
      << query.max_step << '|' << query.jump_factor << '|' << query.revolute_jump << '|'
      << query.tool_speed << '|' << query.speed_link << '|' << query.speed_scale << '|'
      << query.acceleration_scale << '|' << query.avoid_collisions << '\n';
  all(query.start.names), all(query.start.positions), all(query.unsupported);
  for (const auto& waypoint : query.waypoints) pose(waypoint);
  for (const auto& band : query.bands)
    out << band.joint << ' ' << band.position << ' ' << band.above << ' ' << band.below << '\n';
  for (const ros::Body& body : query.attached) {
    out << body.id << '|' << body.frame << '|' << body.link << '|' << body.operation << '|'
        << body.unsupported << '\n';
    pose(body.pose), all(body.touch_links);
    for (const ros::Solid& solid : body.solids) {
      out << solid.kind << '\n';
      pose(solid.pose), all(solid.dimensions), all(solid.vertices), all(solid.triangles);
    }
  }
  return out.str();
}

template <class Pose>
void set_pose(Pose& pose, double x, double y, double z) {
  pose.position.x = x, pose.position.y = y, pose.position.z = z;
  pose.orientation.w = 0, pose.orientation.x = 0, pose.orientation.y = 1, pose.orientation.z = 0;
}
template <class Pose>
void set_shift(Pose& pose, double x, double y, double z) {
  set_pose(pose, x, y, z);
  pose.orientation.w = 1, pose.orientation.y = 0;
}

/// Returns a request for a line of 0.2 m in front of the robot, from where it stands.
template <class Request>
Request line_request() {
  Request request;
  request.header.frame_id = "base_link";
  request.group_name = "manipulator";
  request.waypoints.resize(2);
  set_pose(request.waypoints[0], 0.6, 0, 0.4);
  set_pose(request.waypoints[1], 0.6, 0.2, 0.4);
  request.max_step = 0.01;
  request.avoid_collisions = true;
  return request;
}

template <class Request>
void attach_box(Request& request, const char* link, double size) {
  request.start_state.is_diff = true;
  request.start_state.attached_collision_objects.resize(1);
  auto& attached = request.start_state.attached_collision_objects[0];
  attached.link_name = link;
  attached.touch_links = {"link_7", "link_6"};
  attached.object.id = "held";
  attached.object.header.frame_id = link;
  set_shift(attached.object.pose, 0, 0, 0.1);
  attached.object.primitives.resize(1);
  attached.object.primitives[0].type = 1;
  auto& dimensions = attached.object.primitives[0].dimensions;
  dimensions.resize(3);
  dimensions[0] = dimensions[1] = dimensions[2] = size;
}

template <class Request>
void add_band(Request& request, const char* joint, double position, double tolerance) {
  request.path_constraints.joint_constraints.resize(1);
  auto& band = request.path_constraints.joint_constraints[0];
  band.joint_name = joint;
  band.position = position;
  band.tolerance_above = band.tolerance_below = tolerance;
}

template <class Request>
struct Row {
  const char* name;
  void (*change)(Request&);
  int code;
  double low, high;   ///< bounds of the fraction
  const char* words;  ///< part of what the answer says
};

constexpr int kSuccess = 1, kFailure = 99999;

template <class Request>
std::vector<Row<Request>> rows_of_frames() {
  return {
      {"a line", [](Request&) {}, kSuccess, 1, 1, "the whole path"},
      {"group", [](Request& r) { r.group_name = "arm"; }, -15, 0, 0, "manipulator"},
      {"link", [](Request& r) { r.link_name = "hand"; }, -18, 0, 0, "'hand' is not a link"},
      {"link in between", [](Request& r) { r.link_name = "link_4"; }, -18, 0, 0, "all joints"},
      {"link by name", [](Request& r) { r.link_name = "tool0"; }, kSuccess, 1, 1, "whole"},
      {"frame", [](Request& r) { r.header.frame_id = "nowhere"; }, -21, 0, 0, "nowhere"},
      {"no frame", [](Request& r) { r.header.frame_id = ""; }, kSuccess, 1, 1, "whole"},
      {"slash", [](Request& r) { r.header.frame_id = "/base_link"; }, kSuccess, 1, 1, "whole"},
      {"frame of TF", [](Request& r) { r.header.frame_id = "table"; }, kSuccess, 1, 1, "whole"},
      {"frame of a link",
       [](Request& r) {
         r.header.frame_id = "link_7";
         r.waypoints.resize(1);
         set_shift(r.waypoints[0], 0, 0, 0.05);
       },
       kSuccess, 0, 1, ""},
      {"in the link's own frame",
       [](Request& r) {
         r.header.frame_id = "tool0";
         set_shift(r.waypoints[0], 0, 0.1, 0);
         set_shift(r.waypoints[1], 0, -0.05, 0);
       },
       kSuccess, 1, 1, "whole"},
      {"nothing moves",
       [](Request& r) {
         r.header.frame_id = "tool0";
         r.waypoints.resize(1);
         set_shift(r.waypoints[0], 0, 0, 0);
       },
       kSuccess, 1, 1, "nothing moves"},
      {"no waypoints", [](Request& r) { r.waypoints.clear(); }, kSuccess, 0, 0, "no waypoints"},
      {"no step", [](Request& r) { r.max_step = 0; }, kFailure, 0, 0, "max_step"},
      {"no step, no frame", [](Request& r) { r.max_step = 0, r.header.frame_id = "nowhere"; }, -21,
       0, 0, "nowhere"},
      {"no turn", [](Request& r) { r.waypoints[0].orientation.y = 0.5; }, kFailure, 0, 0, "length"},
  };
}

template <class Request>
std::vector<Row<Request>> rows_of_states() {
  return {
      {"unknown joint",
       [](Request& r) {
         r.start_state.joint_state.name = {"joint_9"};
         r.start_state.joint_state.position = {0};
       },
       -17, 0, 0, "joint_9"},
      {"joint without a position",
       [](Request& r) { r.start_state.joint_state.name = {"joint_a1"}; }, -17, 0, 0, "1 names"},
      {"start as a diff",
       [](Request& r) {
         r.start_state.is_diff = true;
         r.start_state.joint_state.name = {"joint_a1"};
         r.start_state.joint_state.position = {0.2};
       },
       kSuccess, 1, 1, "whole"},
      {"start beyond a limit",
       [](Request& r) {
         r.start_state.joint_state.name = {"joint_a1"};
         r.start_state.joint_state.position = {3.5};
       },
       kSuccess, 0, 0, "joint_a1"},
      {"other joints", [](Request& r) { r.start_state.multi_dof_joint_state.joint_names = {"v"}; },
       kFailure, 0, 0, "multi_dof"},
      {"held", [](Request& r) { attach_box(r, "link_7", 0.03); }, kSuccess, 1, 1, "whole"},
      {"held too big", [](Request& r) { attach_box(r, "link_7", 0.9); }, kSuccess, 0, 0, "held"},
      {"held by nobody", [](Request& r) { attach_box(r, "hand", 0.05); }, -17, 0, 0, "hand"},
      {"held plane",
       [](Request& r) {
         attach_box(r, "link_7", 0.05);
         r.start_state.attached_collision_objects[0].object.planes.resize(1);
       },
       -17, 0, 0, "planes"},
  };
}

template <class Request>
std::vector<Row<Request>> rows_of_limits() {
  return {
      {"wall", [](Request& r) { set_pose(r.waypoints[1], 0.6, 0.45, 0.4); }, kSuccess, 0.3, 0.9,
       "wall"},
      {"wall not avoided",
       [](Request& r) {
         set_pose(r.waypoints[1], 0.6, 0.45, 0.4);
         r.avoid_collisions = false;
       },
       kSuccess, 1, 1, "not avoided"},
      {"band", [](Request& r) { add_band(r, "joint_a3", 0, 0.2); }, kSuccess, 1, 1, "whole"},
      {"narrow band", [](Request& r) { add_band(r, "joint_a1", 0, 0.001); }, kSuccess, 0.01, 0.99,
       "joint_a1"},
      {"band of no joint", [](Request& r) { add_band(r, "elbow", 0, 0.2); }, kFailure, 0, 0,
       "elbow"},
      {"band elsewhere", [](Request& r) { add_band(r, "joint_a1", 1, 0.2); }, kSuccess, 0, 0,
       "outside of its path constraint"},
      {"position", [](Request& r) { r.path_constraints.position_constraints.resize(1); }, kFailure,
       0, 0, "position_constraints"},
      {"orientation", [](Request& r) { r.path_constraints.orientation_constraints.resize(1); },
       kFailure, 0, 0, "orientation_constraints"},
      {"visibility", [](Request& r) { r.path_constraints.visibility_constraints.resize(1); },
       kFailure, 0, 0, "visibility_constraints"},
      {"jump of joints", [](Request& r) { r.revolute_jump_threshold = 1e-4; }, kSuccess, 0, 0.2,
       "joint step"},
      {"jump factor", [](Request& r) { r.jump_threshold = 5; }, kSuccess, 1, 1, "jump_threshold"},
  };
}

inline std::string data_text(const char* name) {
  std::ifstream in(std::string(SWIVEL_DATA_DIR "/robots/") + name);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Returns the service of an iiwa14 that stands with its tool down, a wall on its left.
inline std::unique_ptr<ros::PathService> iiwa_service() {
  auto service = std::make_unique<ros::PathService>(data_text("iiwa14.urdf"),
                                                    data_text("iiwa14.srdf"), ros::Settings());
  service->state(
      {{"joint_a1", "joint_a2", "joint_a3", "joint_a4", "joint_a5", "joint_a6", "joint_a7"},
       {0, 0.6, 0, -1.5, 0, 1.0, 0}});
  ros::Body wall;
  wall.id = "wall";
  wall.pose = {0.6, 0.4, 0.3, 1, 0, 0, 0};
  wall.solids = {{ros::Solid::kBox, {0.3, 0.05, 0.6}, {}, {}, {}}};
  EXPECT_TRUE(service->world({wall}, true, {}, {}).empty());
  return service;
}

/// Knows the frame "table", which is the model's.
inline bool table_only(const std::string& frame, ros::Pose7&) {
  return frame == "table";
}

/// Sends all rows and compares the answers with what is expected, and the queries with those of
/// plain structs.
template <class Messages>
void expect_rows() {
  using Request = typename Messages::Request;
  const auto service = iiwa_service();
  auto rows = rows_of_frames<Request>();
  for (const auto& row : rows_of_states<Request>()) rows.push_back(row);
  for (const auto& row : rows_of_limits<Request>()) rows.push_back(row);
  auto plain = rows_of_frames<plain::Request>();
  for (const auto& row : rows_of_states<plain::Request>()) plain.push_back(row);
  for (const auto& row : rows_of_limits<plain::Request>()) plain.push_back(row);
  ASSERT_GE(rows.size(), 25u);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto& row = rows[k];
    SCOPED_TRACE(row.name);
    auto request = line_request<Request>();
    row.change(request);
    auto same = line_request<plain::Request>();
    plain[k].change(same);
    const ros::Query query = ros::to_query(request);
    EXPECT_EQ(text_of(query), text_of(ros::to_query(same)));
    const ros::Answer answer = service->answer(query, table_only);
    typename Messages::Response response;
    ros::fill(answer, response);
    EXPECT_EQ(response.error_code.val, row.code) << answer.words;
    EXPECT_GE(response.fraction, row.low) << answer.words;
    EXPECT_LE(response.fraction, row.high) << answer.words;
    EXPECT_NE(answer.words.find(row.words), std::string::npos) << answer.words;
    const auto& trajectory = response.solution.joint_trajectory;
    EXPECT_EQ(trajectory.points.size(), answer.points.size());
    if (response.fraction == 0) continue;
    ASSERT_FALSE(trajectory.points.empty());
    EXPECT_EQ(trajectory.joint_names.size(), 7u);
    EXPECT_EQ(trajectory.header.frame_id, "base_link");
    EXPECT_EQ(response.start_state.joint_state.name.size(), 7u);
    for (std::size_t i = 0; i < trajectory.points.size(); ++i) {
      const auto& point = trajectory.points[i];
      ASSERT_EQ(point.positions.size(), 7u);
      for (std::size_t j = 0; j < 7; ++j)
        EXPECT_EQ(point.positions[j], answer.points[i].positions[j]);
    }
  }
}

}  // namespace swivel::test
