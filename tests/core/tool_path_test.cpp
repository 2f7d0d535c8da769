// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/tool_path.hpp"

#include <gtest/gtest.h>

#include "seed.hpp"
#include "swivel/core/input_error.hpp"

namespace swivel {
namespace {

Waypoint at(double x, double y, double z, double yaw = 0) {
  return {{x, y, z}, Quaterniond(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()))};
}

TEST(ToolPath, EveryWaypointIsALayerAndStepsAreEqual) {
  const ToolPath path({at(0, 0, 0), at(0.1, 0, 0), at(0.1, 0.033, 0)}, {.ds = 0.01, .dphi = 0.1, .dalpha = 0.1}, "test");
  ASSERT_EQ(path.size(), 1 + 10 + 4);
  EXPECT_EQ(path.layer(0).waypoint, 0);
  EXPECT_EQ(path.layer(10).waypoint, 1);
  EXPECT_EQ(path.layer(14).waypoint, 2);
  EXPECT_EQ(path.layer(5).waypoint, -1);
  EXPECT_NEAR(path.layer(14).s, 0.133, 1e-15);
  EXPECT_NEAR(path.layer(11).step_length, 0.00825, 1e-15);
  EXPECT_LT((path.layer(10).tool.translation() - Vector3d(0.1, 0, 0)).norm(), 1e-15);
}

TEST(ToolPath, ASegmentThatOnlyTurnsHasLayersAtOneS) {
  const ToolPath path({at(0, 0, 0), at(0, 0, 0, 1.0), at(0.1, 0, 0, 1.0)}, {.ds = 0.05, .dphi = 0.1, .dalpha = 0.1}, "test");
  ASSERT_EQ(path.size(), 1 + 10 + 2);
  EXPECT_EQ(path.layer(10).s, 0);
  EXPECT_NEAR(path.layer(3).step_angle, 0.1, 1e-12);
  EXPECT_NEAR(Eigen::AngleAxisd(path.layer(5).tool.linear()).angle(), 0.5, 1e-12);
}

TEST(ToolPath, TurnsTheShortWayAndKeepsTurningBeyondTheStep) {
  const ToolPath path({at(0, 0, 0, 3.0), at(1, 0, 0, -3.0)}, {.ds = 0.5, .dphi = 0.1, .dalpha = 10}, "test");
  ASSERT_EQ(path.size(), 3);
  const Pose middle = path.layer(1).tool;
  EXPECT_NEAR(middle.linear()(0, 0), -1, 1e-12);  // yaw pi
  EXPECT_LT((path.at(0, 2.0).matrix() - path.layer(2).tool.matrix()).norm(), 1e-12);
}

TEST(ToolPath, MergesRepeatedWaypointsAndKeepsTheirRows) {
  const ToolPath path({at(0, 0, 0), at(0, 0, 0), at(0, 0, 5e-10), at(1, 0, 0)}, {.ds = 1, .dphi = 0.1, .dalpha = 0.1}, "test");
  EXPECT_EQ(path.merged_waypoints(), 2);
  ASSERT_EQ(path.size(), 2);
  EXPECT_EQ(path.layer(1).waypoint, 3);
}

TEST(ToolPath, RefusesWhatHasNoMeaning) {
  const Resolution resolution{.ds = 0.01, .dphi = 0.1, .dalpha = 0.1};
  EXPECT_THROW(ToolPath({at(0, 0, 0)}, resolution, "test"), InputError);
  EXPECT_THROW(ToolPath({at(0, 0, 0), at(0, 0, 0)}, resolution, "test"), InputError);
  EXPECT_THROW(ToolPath({at(0, 0, 0), at(0, 0, 0, kPi)}, resolution, "test"), InputError);
  EXPECT_THROW(ToolPath({at(0, 0, 0), at(1, 0, 0)}, {.ds = 1e-9, .dphi = 0.1, .dalpha = 0.1}, "test"), InputError);
}

}  // namespace
}  // namespace swivel
