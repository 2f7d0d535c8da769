// SPDX-License-Identifier: BSD-3-Clause
// A joint that runs out of its range on the path is what ends it, and is named with how far it
// would go, before any limit on steps: such a limit only bars the jump to another turn or another
// solution.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "robots.hpp"
#include "seed.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel {
namespace {

using namespace test;

PlanResult planned(const PathProblem& problem) {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  return plan(problem, options);
}

/// Returns a tool that points down and turns with the way around the base: `turns` of a circle of a
/// radius (m) at a height (m), begun at an angle (rad).
std::vector<Waypoint> ring(double radius, double height, double begin, double turns) {
  std::vector<Waypoint> waypoints;
  const int count = static_cast<int>(std::ceil(36 * std::abs(turns)));
  for (int k = 0; k <= count; ++k) {
    const double angle = begin + k * turns * kTwoPi / count;
    waypoints.push_back({radius * Vector3d(std::cos(angle), std::sin(angle), height / radius),
                         Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitZ()) *
                                     Eigen::AngleAxisd(kPi, Vector3d::UnitY()))});
  }
  return waypoints;
}

/// Around its base an arm turns with joint 1, which would have to unwind at the end of its range.
TEST(OutOfRange, ARingThatNeedsMoreThanTheTurnsOfJoint1NamesIt) {
  const std::uint64_t base = seed("OutOfRange.Ring");
  const int count = trials(6);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    // Joints 3, 5 and 7 may not help.
    const int turns = 1 + random.below(2);
    TestRobot robot = data_robot("iiwa14");
    robot = with_limits(robot, [&](int, Joint& joint) {
      if (joint.upper > 2.5) joint.upper = turns * kPi, joint.lower = -joint.upper;
    });
    PathProblem problem = problem_for(robot);
    problem.waypoints =
        ring(random.uniform(0.42, 0.5), random.uniform(0.28, 0.4), random.uniform(-kPi, kPi),
             (random.coin() ? 1 : -1) * (turns + random.uniform(0.4, 0.8)));
    problem.resolution = {.ds = 0.005, .dphi = random.coin() ? 0.05 : 0.2};
    problem.limits.clearance = 0.002;
    const PlanResult result = planned(problem);
    ASSERT_EQ(result.status, PlanStatus::kInfeasible) << what;
    const Cause& cause = result.diagnosis->cause;
    EXPECT_EQ(cause.kind, Cause::Kind::kLimit) << what << ": " << words(cause);
    EXPECT_EQ(cause.joint, "joint_a1") << what;
    EXPECT_TRUE(cause.unwinds) << what;
    ASSERT_TRUE(cause.value && cause.limit) << what;
    EXPECT_NEAR(std::abs(*cause.limit), turns * kPi, 1e-9) << what;
  }
}

/// A torch of six joints around an ellipse on a plate, with next to no roll: where a joint leaves
/// its range, it is named with how far it goes, and with that much more there is a path.
TEST(OutOfRange, AJointOfSixThatLeavesItsRangeIsNamedWithHowFar) {
  const std::uint64_t base = seed("OutOfRange.Six");
  TestRobot robot = data_robot("kr6_like");
  robot.tip_link = "flange";
  int infeasible = 0, joints = 0;
  const int count = trials(15);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem = problem_for(robot);
    problem.tool.translation() = Vector3d(0.03, 0, 0.15);
    problem.tool.linear() = Eigen::AngleAxisd(0.5, Vector3d::UnitY()).toRotationMatrix();
    problem.roll = Roll{-0.001, 0.001};
    // The tool points down, its x axis along the ellipse.
    const Vector3d middle(random.uniform(0.46, 0.54), random.uniform(-0.04, 0.04),
                          random.uniform(0.16, 0.2));
    const double width = random.uniform(0.1, 0.12), depth = random.uniform(0.07, 0.09);
    for (int k = 0; k <= 72; ++k) {
      const double c = std::cos(k * kTwoPi / 72), sine = std::sin(k * kTwoPi / 72);
      problem.waypoints.push_back(
          {middle + Vector3d(width * c, depth * sine, 0),
           Quaterniond(Eigen::AngleAxisd(std::atan2(depth * c, -width * sine), Vector3d::UnitZ()) *
                       Eigen::AngleAxisd(kPi, Vector3d::UnitX()))});
    }
    problem.limits.clearance = 0;
    const PlanResult result = planned(problem);
    if (result.status != PlanStatus::kInfeasible) continue;
    ++infeasible;
    const Cause& cause = result.diagnosis->cause;
    EXPECT_NE(cause.joint, "roll") << what << ": " << words(cause) << ' ' << figures(cause);
    if (cause.kind != Cause::Kind::kLimit || !result.diagnosis->reached_layer) continue;
    ++joints;
    ASSERT_TRUE(cause.value && cause.limit) << what;
    EXPECT_TRUE(result.diagnosis->together.empty()) << what;
    PathProblem wider = problem;
    auto model = std::make_shared<RobotModel>(*robot.model);
    for (Joint& joint : model->joints) {
      if (joint.name != cause.joint) continue;
      const bool upper = cause.side == Cause::Side::kUpper;
      (upper ? joint.upper : joint.lower) = *cause.value + (upper ? 0.01 : -0.01);
    }
    wider.model = model;
    EXPECT_EQ(planned(wider).status, PlanStatus::kSolved)
        << what << ": " << words(cause) << ' ' << figures(cause);
  }
  std::printf("%d ellipses, %d without a path, %d by a joint's range\n", count, infeasible, joints);
  EXPECT_GE(joints, at_least(8));
}

}  // namespace
}  // namespace swivel
