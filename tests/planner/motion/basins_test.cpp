// SPDX-License-Identifier: BSD-3-Clause
// Refined paths of S-R-S arms end in the cheapest basin that is known: they are held against
// refinement without other basins, and against refined paths of lattices with finer arm angles.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "inexact_robots.hpp"
#include "random_problem.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

PlanResult solve_lazily(const PreparedRobot& robot, const PathProblem& problem) {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  return plan(robot, problem, options);
}

Vector3d random_direction(Random& random) {
  return Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
}

/// Returns a waypoint some way from a pose, turned by up to `turn`, rad, about any axis.
Waypoint moved_away(Pose pose, double way, double turn, Random& random) {
  pose.translation() += way * random_direction(random);
  pose.linear() =
      Eigen::AngleAxisd(random.uniform(0, turn), random_direction(random)) * pose.linear();
  return waypoint_of(pose);
}

/// Draws a line of 0.4 m, a ring or a corner, with turns, from a random posture.
PathProblem basin_problem(const TestRobot& robot, int shape, Random& random) {
  PathProblem problem = problem_for(robot);
  const Chain chain = arm_of(robot).chain;
  Config q = random_config(chain, random);
  for (int j = 0; j < kDof; ++j)
    q[j] = j % 2 == 0 ? std::remainder(0.8 * q[j], kTwoPi) : 0.6 * q[j];
  const Pose tool = chain.tool(q);
  problem.waypoints = {waypoint_of(tool)};
  if (shape == 0) {
    problem.waypoints.push_back(moved_away(tool, 0.4, random.coin() ? 1 : kPi, random));
  } else if (shape == 1) {
    const double radius = random.uniform(0.05, 0.12);
    const Vector3d axis = random_direction(random), arm = axis.unitOrthogonal();
    constexpr int kParts = 24;
    for (int k = 1; k <= kParts; ++k) {
      Pose pose = tool;
      pose.translation() += radius * (Eigen::AngleAxisd(kTwoPi * k / kParts, axis) * arm - arm);
      problem.waypoints.push_back(waypoint_of(pose));
    }
  } else {
    for (int k = 0; k < 2; ++k) {
      Pose from = Pose::Identity();
      from.translation() = problem.waypoints.back().position;
      from.linear() = problem.waypoints.back().orientation.toRotationMatrix();
      problem.waypoints.push_back(moved_away(from, 0.2, 1, random));
    }
  }
  if (random.coin(0.2)) problem_parts::draw_obstacles(problem, chain, q, 2, random);
  if (random.coin(0.25)) problem.cost.metric = random.coin() ? CostMetric::kMax : CostMetric::kTime;
  if (random.coin(0.2))
    for (double& weight : problem.cost.weights.emplace()) weight = random.uniform(0, 2);
  if (random.coin(0.2)) problem.limits.joint_margin = 0.05;
  return problem;
}

/// What the trials met.
struct BasinCounts {
  int solved = 0, cheaper = 0, starts = 0, ends = 0, inexact = 0, other_branch = 0;
  std::map<std::string, int> cheaper_by_robot;
  std::array<int, 3> shapes{};
};

/// Refines a path with other basins and without; compares and checks the results.
void compare_basins(const PreparedRobot& robot, const PathProblem& problem, const PlanResult& found,
                    BasinCounts& counts) {
  const Refined one = refine(robot, problem, found.trajectory, {.other_basins = false});
  const Refined best = refine(robot, problem, found.trajectory);
  ASSERT_LE(best.cost, one.cost);
  ASSERT_EQ(best.rows.size(), found.trajectory.size());
  const CheckResult check = check_trajectory(robot, problem, best.rows);
  ASSERT_TRUE(check.passed) << (check.failures.empty() ? "" : check.failures[0]);
  ASSERT_NEAR(check.cost, best.cost, 1e-6 * (1 + best.cost));
  if (problem.start) {
    ASSERT_EQ(best.rows.front().q, *problem.start);
  }
  if (problem.end) {
    ASSERT_EQ(best.rows.back().q, *problem.end);
  }
  const Refined again = refine(robot, problem, found.trajectory);
  for (std::size_t k = 0; k < best.rows.size(); ++k) {
    ASSERT_EQ(best.rows[k].s, found.trajectory[k].s);
    ASSERT_EQ(best.rows[k].branch, robot.srs().branch(best.rows[k].q)) << k;
    ASSERT_EQ(again.rows[k].q, best.rows[k].q) << k;  // bit for bit
  }
  ++counts.solved;
  counts.starts += problem.start.has_value();
  counts.ends += problem.end.has_value();
  counts.inexact += !robot.srs().exact;
  if (!(best.cost < (1 - 1e-4) * one.cost)) return;
  ++counts.cheaper;
  ++counts.cheaper_by_robot[problem.source];
  counts.other_branch += best.rows[0].branch != found.trajectory[0].branch;
}

TEST(Basins, AreValidAndNeverDearer) {
  Random making(seed("BasinRobots"));
  std::vector<TestRobot> robots = all_robots();
  for (TestRobot& robot : inexact_robots(making))
    if (robots.size() < 7) robots.push_back(robot);
  const std::uint64_t base = seed("Basins");
  BasinCounts counts;
  for (int trial = 0; trial < trials(280); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const TestRobot& test_robot = robots[static_cast<std::size_t>(trial) % robots.size()];
    const int shape = random.below(3);
    PathProblem problem = basin_problem(test_robot, shape, random);
    SCOPED_TRACE(problem.source + " " + std::to_string(trial));
    const PreparedRobot robot(problem);
    PlanResult found = solve_lazily(robot, problem);
    if (found.status != PlanStatus::kSolved) continue;
    const bool starts = random.coin(0.25), ends = random.coin(0.25);
    if (starts) problem.start = found.trajectory.front().q;
    if (ends) problem.end = found.trajectory.back().q;
    if (starts || ends) {
      found = solve_lazily(robot, problem);
      ASSERT_EQ(found.status, PlanStatus::kSolved);
    }
    ++counts.shapes[static_cast<std::size_t>(shape)];
    compare_basins(robot, problem, found, counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d solved (%d lines, %d rings, %d corners; %d starts, %d ends, %d inexact): %d cheaper, "
      "%d in another branch;",
      counts.solved, counts.shapes[0], counts.shapes[1], counts.shapes[2], counts.starts,
      counts.ends, counts.inexact, counts.cheaper, counts.other_branch);
  for (const auto& [name, count] : counts.cheaper_by_robot)
    std::printf(" %s %d", name.c_str(), count);
  std::printf("\n");
  EXPECT_GE(counts.solved, at_least(30));
  EXPECT_GE(counts.starts, at_least(2));
  EXPECT_GE(counts.ends, at_least(2));
  EXPECT_GE(counts.inexact, at_least(2));
  for (const int shape : counts.shapes) EXPECT_GE(shape, at_least(4));
}

/// Draws of basin_problem() on which the lattice's best path lies in a dearer basin.
TEST(Basins, AreFoundWhereTheLatticePassesOverThem) {
  const std::vector<TestRobot> robots = all_robots();
  for (const auto& [draw, gain] :
       {std::pair(1330u, 0.04), std::pair(1519u, 0.05), std::pair(1536u, 0.15),
        std::pair(1686u, 0.06), std::pair(2152u, 0.05)}) {
    SCOPED_TRACE(draw);
    Random random(draw);
    const PathProblem problem =
        basin_problem(robots[draw % robots.size()], static_cast<int>(draw % 3), random);
    const PreparedRobot robot(problem);
    const PlanResult found = solve_lazily(robot, problem);
    ASSERT_EQ(found.status, PlanStatus::kSolved);
    const Refined one = refine(robot, problem, found.trajectory, {.other_basins = false});
    const Refined best = refine(robot, problem, found.trajectory);
    EXPECT_LE(best.cost, (1 - gain) * one.cost);
    EXPECT_TRUE(best.from_second_seed);
    EXPECT_TRUE(check_trajectory(robot, problem, best.rows).passed);
  }
}

/// Costs at most 1.03 of what refined paths of a lattice with five times as many arm angles cost,
/// and in 95 of 100 at most 1.01, where these keep their branch: through a singularity leads no
/// motion.
TEST(Basins, AreThoseOfFineArmAngles) {
  const std::vector<TestRobot> robots = all_robots();
  const std::uint64_t base = seed("FineBasins");
  std::vector<double> ratios;
  for (int trial = 0; trial < trials(120); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem =
        basin_problem(robots[static_cast<std::size_t>(trial) % robots.size()], trial % 3, random);
    problem.scene.clear();  // past obstacles other basins are not sought
    const PreparedRobot robot(problem);
    const PlanResult found = solve_lazily(robot, problem);
    if (found.status != PlanStatus::kSolved) continue;
    const double cost = refine(robot, problem, found.trajectory).cost;
    PathProblem fine = problem;
    fine.resolution.dphi /= 5;
    const PlanResult finely = solve_lazily(robot, fine);
    ASSERT_EQ(finely.status, PlanStatus::kSolved) << trial;
    const Refined truth = refine(robot, fine, finely.trajectory);
    if (std::any_of(truth.rows.begin(), truth.rows.end(),
                    [&](const TrajectoryRow& row) { return row.branch != truth.rows[0].branch; }))
      continue;
    ratios.push_back(cost / std::min(cost, truth.cost));
    EXPECT_LE(ratios.back(), 1.03) << problem.source << ' ' << trial;
  }
  ASSERT_FALSE(ratios.empty());
  std::sort(ratios.begin(), ratios.end());
  const auto above = ratios.end() - std::upper_bound(ratios.begin(), ratios.end(), 1.01);
  std::printf("%zu paths, over those of fine arm angles: median %.4f, most %.4f, %d above 1.01\n",
              ratios.size(), ratios[ratios.size() / 2], ratios.back(), static_cast<int>(above));
  EXPECT_GE(static_cast<int>(ratios.size()), at_least(15));
  EXPECT_LE(static_cast<double>(above), std::max(1.0, 0.05 * static_cast<double>(ratios.size())));
}

}  // namespace
}  // namespace swivel
