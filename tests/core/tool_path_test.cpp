// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/problem/tool_path.hpp"

#include <gtest/gtest.h>

#include <array>

#include "seed.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {
namespace {

Waypoint at(double x, double y, double z, double yaw = 0) {
  return {{x, y, z}, Quaterniond(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()))};
}

TEST(ToolPath, EveryWaypointIsALayerAndStepsAreEqual) {
  const ToolPath path({at(0, 0, 0), at(0.1, 0, 0), at(0.1, 0.033, 0)},
                      {.ds = 0.01, .dphi = 0.1, .dalpha = 0.1}, "test");
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
  const ToolPath path({at(0, 0, 0), at(0, 0, 0, 1.0), at(0.1, 0, 0, 1.0)},
                      {.ds = 0.05, .dphi = 0.1, .dalpha = 0.1}, "test");
  ASSERT_EQ(path.size(), 1 + 10 + 2);
  EXPECT_EQ(path.layer(10).s, 0);
  EXPECT_NEAR(path.layer(3).step_angle, 0.1, 1e-12);
  EXPECT_NEAR(Eigen::AngleAxisd(path.layer(5).tool.linear()).angle(), 0.5, 1e-12);
}

TEST(ToolPath, TurnsTheShortWayAndKeepsTurningBeyondTheStep) {
  const ToolPath path({at(0, 0, 0, 3.0), at(1, 0, 0, -3.0)}, {.ds = 0.5, .dphi = 0.1, .dalpha = 10},
                      "test");
  ASSERT_EQ(path.size(), 3);
  const Pose middle = path.layer(1).tool;
  EXPECT_NEAR(middle.linear()(0, 0), -1, 1e-12);  // yaw pi
  EXPECT_LT((path.at(0, 2.0).matrix() - path.layer(2).tool.matrix()).norm(), 1e-12);
}

TEST(ToolPath, MergesRepeatedWaypointsAndKeepsTheirRows) {
  const ToolPath path({at(0, 0, 0), at(0, 0, 0), at(0, 0, 5e-10), at(1, 0, 0)},
                      {.ds = 1, .dphi = 0.1, .dalpha = 0.1}, "test");
  EXPECT_EQ(path.merged_waypoints(), 2);
  ASSERT_EQ(path.size(), 2);
  EXPECT_EQ(path.layer(1).waypoint, 3);
}

/// Whether the windows of the roll are linear along the path, and both hold where two waypoints are
/// one.
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

/// Each segment of a polyline cut into so many parts of unequal length.
std::vector<Waypoint> in_parts(const std::vector<Waypoint>& corners, int parts,
                               test::Random& random) {
  std::vector<Waypoint> waypoints{corners[0]};
  for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
    double t = 0;
    for (int part = 1; part < parts; ++part) {
      t += random.uniform(0.2, 0.99) * (1 - t) / (parts - part);
      waypoints.push_back(
          {corners[k].position + t * (corners[k + 1].position - corners[k].position),
           corners[k].orientation.slerp(t, corners[k + 1].orientation)});
    }
    waypoints.push_back(corners[k + 1]);
  }
  return waypoints;
}

/// The same line has the same layers, whatever number of waypoints it is written with.
TEST(ToolPath, WaypointsOnALineAreNoLayers) {
  const std::uint64_t base = test::seed("Collinear");
  int turning = 0, on_the_spot = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    test::Random random(base + static_cast<std::uint64_t>(trial));
    std::vector<Waypoint> corners{at(0, 0, 0)};
    for (int k = 0; k < 3; ++k) {
      Waypoint next = corners.back();
      const bool turns = random.coin(), moves = !turns || random.coin(0.7);
      if (moves)
        next.position += Vector3d(random.uniform(0.02, 0.1), random.uniform(-0.1, 0.1),
                                  random.uniform(-0.1, 0.1));
      const Vector3d axis(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1));
      if (turns)
        next.orientation = next.orientation * Quaterniond(Eigen::AngleAxisd(
                                                  random.uniform(0.1, 2.5), axis.normalized()));
      turning += turns;
      on_the_spot += !moves;
      corners.push_back(next);
    }
    const Resolution resolution{
        .ds = random.uniform(0.004, 0.02), .dphi = 0.1, .dalpha = random.uniform(0.05, 0.2)};
    const ToolPath path(corners, resolution, "test");
    for (const int parts : {2, 10, 100}) {
      const ToolPath same(in_parts(corners, parts, random), resolution, "test");
      ASSERT_EQ(same.size(), path.size()) << what << " parts " << parts;
      for (int i = 0; i < path.size(); ++i) {
        ASSERT_EQ(same.layer(i).tool.matrix(), path.layer(i).tool.matrix())
            << what << " layer " << i;
        ASSERT_EQ(same.layer(i).travel, path.layer(i).travel) << what << " layer " << i;
        ASSERT_EQ(same.layer(i).waypoint,
                  path.layer(i).waypoint < 0 ? -1 : path.layer(i).waypoint * parts)
            << what;
      }
      // All waypoints are known all the same.
      EXPECT_EQ(same.waypoints_along(0, path.layer(path.size() - 1).travel),
                (std::array{0, 3 * parts}))
          << what;
      const double middle = path.layer(1).travel / 2;
      EXPECT_LE(same.waypoints_along(0, middle)[1], same.waypoints_along(middle, 1e3)[0]) << what;
    }
  }
  EXPECT_GE(turning, 40);
  EXPECT_GE(on_the_spot, 10);
}

/// What bends the path stays a layer: a corner of a micrometre, a turn back, a turn in one half of
/// a line, a window.
TEST(ToolPath, CornersAreLayers) {
  const Resolution resolution{.ds = 0.04, .dphi = 0.1, .dalpha = 0.2};
  EXPECT_EQ(ToolPath({at(0, 0, 0), at(0.02, 0, 0), at(0.04, 0, 0)}, resolution, "test").size(), 2);
  EXPECT_EQ(ToolPath({at(0, 0, 0), at(0.02, 1e-6, 0), at(0.04, 0, 0)}, resolution, "test").size(),
            3);
  EXPECT_EQ(ToolPath({at(0, 0, 0), at(0.04, 0, 0), at(0.02, 0, 0)}, resolution, "test").size(), 3);
  EXPECT_EQ(ToolPath({at(0, 0, 0), at(0.02, 0, 0), at(0.04, 0, 0, 0.1)}, resolution, "test").size(),
            3);
  // A whole turn is not the short way round.
  std::vector<Waypoint> turns;
  for (int k = 0; k <= 8; ++k) turns.push_back(at(0, 0, 0, kPi / 4 * k));
  const ToolPath turn(turns, resolution, "test");
  double angle = 0;
  for (int i = 0; i < turn.size(); ++i) angle += turn.layer(i).step_angle;
  EXPECT_NEAR(angle, kTwoPi, 1e-9);
  std::vector<Waypoint> windows{at(0, 0, 0), at(0.02, 0, 0), at(0.04, 0, 0)};
  for (Waypoint& waypoint : windows) waypoint.roll = Roll{-0.1, 0.1};
  EXPECT_EQ(ToolPath(windows, resolution, "test").size(), 3);
}

/// A tool that may turn about its z axis as it likes may turn half round it: the z axis stands
/// still.
TEST(ToolPath, AHalfTurnAboutAFreeAxisIsRightHanded) {
  const Resolution resolution{.ds = 0.005, .dphi = 0.1, .dalpha = 0.1};
  const auto path = [&](double yaw, bool turns_freely) {
    const Waypoint there{{0.02, 0, 0},
                         Quaterniond(Eigen::AngleAxisd(kPi, Vector3d::UnitX())) *
                             Quaterniond(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()))};
    const Waypoint here{{0, 0, 0}, Quaterniond(Eigen::AngleAxisd(kPi, Vector3d::UnitX()))};
    return ToolPath({here, there}, resolution, "test", {}, {}, turns_freely);
  };
  EXPECT_THROW(path(kPi, false), InputError);
  for (const double yaw : {kPi, -kPi}) {
    const ToolPath half = path(yaw, true), nearly = path(kPi - 1e-6, true);
    ASSERT_EQ(half.size(), nearly.size());
    for (int i = 0; i < half.size(); ++i) {
      EXPECT_LT((half.layer(i).tool.matrix() - nearly.layer(i).tool.matrix()).norm(), 2e-6) << i;
      EXPECT_LT((half.layer(i).tool.linear().col(2) - half.layer(0).tool.linear().col(2)).norm(),
                1e-9)
          << i;
    }
  }
  // About another axis it is undefined for that tool, too.
  const Waypoint here = at(0, 0, 0),
                 over{{0.02, 0, 0},
                      Quaterniond(Eigen::AngleAxisd(kPi, Vector3d(1, 0, 1).normalized()))};
  EXPECT_THROW(ToolPath({here, over}, resolution, "test", {}, {}, true), InputError);
}

TEST(ToolPath, RefusesWhatHasNoMeaning) {
  const Resolution resolution{.ds = 0.01, .dphi = 0.1, .dalpha = 0.1};
  EXPECT_THROW(ToolPath({at(0, 0, 0)}, resolution, "test"), InputError);
  EXPECT_THROW(ToolPath({at(0, 0, 0), at(0, 0, 0)}, resolution, "test"), InputError);
  EXPECT_THROW(ToolPath({at(0, 0, 0), at(0, 0, 0, kPi)}, resolution, "test"), InputError);
  EXPECT_THROW(
      ToolPath({at(0, 0, 0), at(1, 0, 0)}, {.ds = 1e-9, .dphi = 0.1, .dalpha = 0.1}, "test"),
      InputError);
}

}  // namespace
}  // namespace swivel
