// SPDX-License-Identifier: BSD-3-Clause
// What pairs of the robot's own bodies keep, as plans show it.
#include <gtest/gtest.h>

#include <cmath>

#include "random_problem.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

PlanResult plan_with_evidence(const PathProblem& problem) {
  PlanOptions options;
  options.evidence = Evidence::all();
  return plan(problem, options);
}

/// 2 cm along y from the given start.
PathProblem short_path(const TestRobot& robot, const Config& start) {
  PathProblem problem = problem_for(robot);
  const Pose tool = arm_of(robot).chain.tool(start);
  Pose end = tool;
  end.translation().y() += 0.02;
  problem.waypoints = {waypoint_of(tool), waypoint_of(end)};
  problem.start = start;
  problem.resolution.dphi = 0.1;
  return problem;
}

Config posture(double q6) {
  Config q{0, 0.5, 0, 1.2, 0, q6, 0};
  return q;
}

TEST(SelfClearance, LinksThatAreNearByDesignMayNotMeet) {
  const TestRobot robot = near_wrist_robot();
  for (const double clearance : {0.001, 0.005, 0.05}) {
    PathProblem problem = short_path(robot, posture(kPi / 2));
    problem.limits.clearance = clearance;
    const PlanResult touching = plan_with_evidence(problem);
    EXPECT_EQ(touching.status, PlanStatus::kInfeasible) << clearance;
    EXPECT_EQ(words(touching.diagnosis->cause), "l5 - l7") << clearance;
    problem = short_path(robot, posture(-1.0));
    problem.limits.clearance = clearance;
    const PlanResult apart = plan_with_evidence(problem);
    EXPECT_EQ(apart.status, PlanStatus::kSolved) << clearance;
    ASSERT_TRUE(apart.min_margin && apart.min_clearance);
    EXPECT_GT(apart.min_margin->margin, 0);
    EXPECT_DOUBLE_EQ(apart.min_margin->margin,
                     apart.min_margin->clearance - apart.min_margin->required);
    EXPECT_LE(*apart.min_clearance, apart.min_margin->clearance);
    EXPECT_TRUE(check_trajectory(problem, apart.trajectory).passed);
    ASSERT_EQ(apart.reduced_pairs.size(), clearance > 0.002 ? 1u : apart.reduced_pairs.size());
    if (clearance > 0.002) {
      EXPECT_EQ(apart.reduced_pairs[0].bodies, (std::array<std::string, 2>{"l5", "l7"}));
      EXPECT_DOUBLE_EQ(apart.reduced_pairs[0].clearance, apart.reduced_pairs[0].median / 2);
      EXPECT_DOUBLE_EQ(apart.reduced_pairs[0].edge_clearance, apart.reduced_pairs[0].median / 4);
    }
  }
}

/// A trajectory that touches fails, whatever is asked.
TEST(SelfClearance, CheckForgivesNoContact) {
  const TestRobot robot = near_wrist_robot();
  PathProblem problem = short_path(robot, posture(-1.0));
  problem.limits.clearance = 0;
  PlanResult result = plan_with_evidence(problem);
  ASSERT_EQ(result.status, PlanStatus::kSolved);
  ASSERT_TRUE(check_trajectory(problem, result.trajectory).passed);
  SceneObject post{"post", Sphere{0.02}, Pose::Identity(), {}};
  post.pose.translation() = arm_of(robot).chain.displacements(result.trajectory[1].q)[7] *
                            (arm_of(robot).links.back().pose.translation() - Vector3d(0, 0, 0.15));
  problem.scene.push_back(post);
  EXPECT_FALSE(check_trajectory(problem, result.trajectory).passed);
}

TEST(SelfClearance, ALargerClearanceNeverMakesAPath) {
  const std::uint64_t base = seed("LargerClearance");
  std::vector<TestRobot> robots{near_wrist_robot()};
  for (const char* name : {"sda5f", "sda10f", "iiwa14"}) {
    robots.push_back(data_robot(name));
    robots.push_back(without_srdf(data_robot(name)));
  }
  constexpr int kSteps = 20;
  int plans = 0, lost = 0, kept = 0, reduced = 0;
  for (std::size_t r = 0; r < robots.size(); ++r) {
    std::optional<PreparedRobot> prepared;
    for (int trial = 0; trial < trials(8); ++trial) {
      Random random(base + 1000 * r + static_cast<std::uint64_t>(trial));
      PathProblem problem = random_problem(robots[r], random);
      problem.limits.joint_step = 0.8;
      if (trial % 3 == 0) problem.limits.self_clearance = random.uniform(0, 0.02);
      if (trial % 4 == 0) problem.limits.edge_clearance = random.uniform(0, 0.01);
      if (!prepared) prepared.emplace(problem);  // serves every clearance
      bool was_solved = true, solved_once = false;
      for (int step = 0; step < kSteps; ++step) {
        problem.limits.clearance = 0.001 + 0.049 * step / (kSteps - 1);
        PlanOptions options;
        options.planner = PlannerKind::kLazy;
        const PlanResult result = plan(*prepared, problem, options);
        const bool solved = result.status == PlanStatus::kSolved;
        ASSERT_TRUE(was_solved || !solved)
            << "SWIVEL_TEST_SEED " << base << " " << robots[r].name << " trial " << trial
            << " clearance " << problem.limits.clearance;
        was_solved = solved;
        solved_once |= solved;
        reduced += !result.reduced_pairs.empty();
        ++plans;
      }
      lost += solved_once && !was_solved;
      kept += was_solved;
      if (trial == 0) {  // and what was prepared for other limits is the same
        PlanOptions options;
        options.planner = PlannerKind::kLazy;
        const PlanResult shared = plan(*prepared, problem, options), fresh = plan(problem, options);
        EXPECT_EQ(shared.status, fresh.status);
        EXPECT_EQ(shared.cost, fresh.cost);
        EXPECT_EQ(shared.reduced_pairs.size(), fresh.reduced_pairs.size());
        EXPECT_EQ(shared.counters.fcl_calls, fresh.counters.fcl_calls);
      }
    }
  }
  std::printf(
      "%d plans of %zu robots, %d with reduced pairs; %d problems lose their path on the way, %d "
      "keep it\n",
      plans, robots.size(), reduced, lost, kept);
  EXPECT_EQ(plans, static_cast<int>(robots.size()) * trials(8) * kSteps);
  EXPECT_GE(reduced, at_least_among(plans / 10 + 1));
  EXPECT_GE(lost, at_least(4));
  EXPECT_GE(kept, at_least(4));
}

}  // namespace
}  // namespace swivel
