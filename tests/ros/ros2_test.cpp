// SPDX-License-Identifier: BSD-3-Clause
// The mapping of compute_cartesian_path with the structs that Debian's rosidl makes for ROS 2.
// There is no graph of ROS 2 here.
#include <moveit_msgs/msg/planning_scene.hpp>
#include <moveit_msgs/srv/get_cartesian_path.hpp>

#include "rows.hpp"

namespace swivel {

namespace {

struct Messages {
  using Request = moveit_msgs::srv::GetCartesianPath::Request;
  using Response = moveit_msgs::srv::GetCartesianPath::Response;
};

TEST(SWIVEL_ROS2, Rows) {
  test::expect_rows<Messages>();
}

TEST(SWIVEL_ROS2, LaterMembers) {
  Messages::Request request;
#if SWIVEL_LATER
  request.max_velocity_scaling_factor = 0.25;
  request.max_cartesian_speed = 0.1;
#endif
  const ros::Query query = ros::to_query(request);
  EXPECT_EQ(query.speed_scale, SWIVEL_LATER ? 0.25 : 0);
  EXPECT_EQ(query.tool_speed, SWIVEL_LATER ? 0.1 : 0);
}

TEST(SWIVEL_ROS2, Scene) {
  moveit_msgs::msg::PlanningScene scene;
  scene.is_diff = true;
  scene.allowed_collision_matrix.default_entry_names = {"a"};
  scene.allowed_collision_matrix.default_entry_values = {true};
  const ros::SceneChange change = ros::to_scene(scene);
  EXPECT_TRUE(change.diff);
  EXPECT_FALSE(change.says_unchecked);
  ASSERT_EQ(change.allowed.with_all.size(), 1u);
}

}  // namespace

}  // namespace swivel
