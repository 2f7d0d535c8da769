// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/tool_path.hpp"

#include <gtest/gtest.h>

#include <array>

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

/// Whether the windows of the roll are linear along the path, and both hold where two waypoints are one.
TEST(ToolPath, WindowsOfTheRollAreLinearBetweenWaypoints) {
  std::vector<Waypoint> waypoints{at(0, 0, 0), at(0.1, 0, 0), at(0.1, 0, 0), at(0.1, 0, 0, 0.4)};
  const std::array<Roll, 4> rolls{Roll{-0.1, 0.1}, Roll{-0.5, 0.3}, Roll{-0.4, 0.9}, Roll{0, 0}};
  for (std::size_t k = 0; k < rolls.size(); ++k) waypoints[k].roll = rolls[k];
  const Resolution resolution{.ds = 0.01, .dphi = 0.1, .dalpha = 0.1};
  const ToolPath path(waypoints, resolution, "test");
  ASSERT_EQ(path.size(), 1 + 10 + 4);
  EXPECT_NEAR(path.layer(5).window.lower, -0.25, 1e-12);  // of -0.1 to -0.4
  EXPECT_NEAR(path.layer(5).window.upper, 0.2, 1e-12);
  EXPECT_EQ(path.layer(10).window, Roll(-0.4, 0.3));
  EXPECT_NEAR(path.layer(12).window.lower, -0.2, 1e-12);
  EXPECT_NEAR(path.layer(12).window.upper, 0.15, 1e-12);
  EXPECT_EQ(path.layer(14).window, Roll(0, 0));
  const double travel = (path.layer(3).travel + path.layer(4).travel) / 2;
  EXPECT_NEAR(path.window_at(travel).lower, -0.1 - 0.3 * 0.35, 1e-12);
  EXPECT_TRUE(path.layer(5).in_window(0.2) && !path.layer(5).in_window(0.21));

  ToolPath begun = path;
  begun.begin_at(0.025, path.at(2, 0.5), 1e-6, "test");
  EXPECT_NEAR(begun.layer(0).window.lower, -0.1 - 0.3 * 0.25, 1e-9);
  const ToolPath few = path.with_layers({0, 5, 14});
  EXPECT_EQ(few.layer(1).window, path.layer(5).window);

  waypoints[2].roll = Roll{0.31, 0.9};
  EXPECT_THROW(ToolPath(waypoints, resolution, "test"), InputError);
  // Without any the roll is as the robot has it.
  const ToolPath free({at(0, 0, 0), at(0.1, 0, 0)}, resolution, "test");
  EXPECT_TRUE(free.layer(3).in_window(100) && free.layer(3).in_window(-100));
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
