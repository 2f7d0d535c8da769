// SPDX-License-Identifier: BSD-3-Clause
// The mapping of compute_cartesian_path with the structs that Debian's gencpp makes.
#include <moveit_msgs/GetCartesianPath.h>
#include <moveit_msgs/PlanningScene.h>

#include "rows.hpp"

namespace swivel {

namespace {

struct Messages {
  using Request = moveit_msgs::GetCartesianPath::Request;
  using Response = moveit_msgs::GetCartesianPath::Response;
};

TEST(Ros1, Rows) {
  test::expect_rows<Messages>();
}

TEST(Ros1, TheServiceHasMoveItsSum) {
  EXPECT_STREQ(::ros::service_traits::MD5Sum<moveit_msgs::GetCartesianPath>::value(),
               "c54b9430d97ea6816e0f7c7ffd3779b8");
}

TEST(Ros1, Scene) {
  moveit_msgs::PlanningScene scene;
  scene.allowed_collision_matrix.entry_names = {"a", "b"};
  scene.allowed_collision_matrix.entry_values.resize(2);
  for (auto& entry : scene.allowed_collision_matrix.entry_values) entry.enabled = {0, 1};
  scene.world.octomap.octomap.data = {1};
  const ros::SceneChange change = ros::to_scene(scene);
  EXPECT_FALSE(change.diff);
  EXPECT_EQ(change.unchecked, "an octomap");
  ASSERT_EQ(change.allowed.pairs.size(), 1u);
  EXPECT_EQ(change.allowed.pairs[0].second, "b");
}

}  // namespace

}  // namespace swivel
