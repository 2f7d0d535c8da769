// SPDX-License-Identifier: BSD-3-Clause
// An arm of two that waits: its joints are held, and the other one's path or job is planned as that
// of one arm.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "random_problem.hpp"
#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/problem/problem_planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/prepared/prepared_workcell.hpp"
#include "two_arms.hpp"

namespace swivel::test {

namespace {

/// Returns the problem of the right arm of a workcell, while the left one and what it carries stand
/// at `waits`, rad.
Problem beside_waiting_arm(const Problem& cell, const PreparedWorkcell& both, const Config& waits) {
  ArmTask right = cell.arms[1];
  const auto& joints = both.robot(0).arm().chain.joint_names;
  for (std::size_t j = 0; j < joints.size(); ++j)
    right.hold[joints[j]] = waits[static_cast<Eigen::Index>(j)];
  right.attached.insert(right.attached.begin(), cell.arms[0].attached.begin(),
                        cell.arms[0].attached.end());
  Problem problem;
  problem.source = cell.source;
  problem.scene = cell.scene;
  right.name.clear();
  problem.arms = {right};
  return problem;
}

/// Expects rows of the right arm, and its moves between them, to keep what the two arms must keep
/// of each other, as FCL tells.
void expect_clear(const PreparedWorkcell& both, const Config& waits,
                  const std::vector<TrajectoryRow>& rows, const std::string& what) {
  InterArmWorld::Query query(both.between(), DistanceProofs::kOff);
  const std::array<std::array<double, kDof>, 2> radii{both.robot(0).radii(), both.robot(1).radii()};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto pair = query.find_violating_pair({waits, rows[i].q}, ClearanceRule::kNode);
    ASSERT_FALSE(pair) << what << " row " << i << ": " << both.between().names(*pair)[0] << " - "
                       << both.between().names(*pair)[1];
    if (i == 0) continue;
    ASSERT_FALSE(query.find_pair_blocking_motion(radii, {waits, rows[i - 1].q}, {waits, rows[i].q}))
        << what << " to row " << i;
  }
}

TEST(WaitingArm, IsKeptClearOf) {
  const std::uint64_t base = seed("WaitingArm");
  const TestRobot robot = data_robot("sda10f");
  int solved = 0, none = 0, in_the_way = 0;
  const int count = trials(40);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const Problem cell = random_workcell(robot, random);
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    const PreparedWorkcell both(cell);
    // The left arm waits where its own path begins, or anywhere.
    Config waits = random_config(both.robot(0).arm().chain, random);
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    const PlanResult left = plan(both.problem(0), options);
    if (left.status == PlanStatus::kSolved && random.coin(0.7)) waits = left.trajectory.front().q;
    const PlanResult alone = plan(both.problem(1), options);
    Answer answer;
    try {
      answer = ProblemPlanner(beside_waiting_arm(cell, both, waits)).plan(options);
    } catch (const std::exception& error) {
      FAIL() << what << ": " << error.what();
    }
    ASSERT_TRUE(answer.status == PlanStatus::kSolved || answer.status == PlanStatus::kInfeasible);
    (answer.status == PlanStatus::kSolved ? solved : none) += 1;
    if (answer.status == PlanStatus::kSolved)
      expect_clear(both, waits, answer.arm().parts.front().rows, what);
    if (HasFatalFailure()) return;
    in_the_way += alone.status == PlanStatus::kSolved &&
                  (answer.status != PlanStatus::kSolved || answer.cost != alone.cost);
  }
  std::printf("%d problems: %d solved, %d without a path, in %d the waiting arm was in the way\n",
              count, solved, none, in_the_way);
  EXPECT_GE(solved, at_least_among(count / 4));
  EXPECT_GE(in_the_way, at_least_among(count / 20));
}

}  // namespace

}  // namespace swivel::test
