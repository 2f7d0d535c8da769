// SPDX-License-Identifier: BSD-3-Clause
// Paths that end in the joints in which they begin: every planner against brute force over all
// starts on every kind of lattice that closes, laps, the check, refining and timing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "diagnosis_of.hpp"
#include "motion_problem.hpp"
#include "planners.hpp"
#include "rings.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

struct RingCounts {
  int closed = 0, open_only = 0, none = 0, dearer = 0, obstacles = 0, turned = 0;
  int other_branch = 0, told_apart = 0;
  std::array<int, 3> closed_by_nodes{};
};

/// Expects that ten laps, each begun in the joints in which the one before ended, are the same lap
/// but for whole turns of joints without limits, and that the check proves the first and refuses it
/// where it does not close.
void expect_laps(const PreparedRobot& robot, const PathProblem& problem, const PlanResult& result,
                 const std::string& what, RingCounts& counts) {
  const std::vector<TrajectoryRow>& rows = result.trajectory;
  const Chain& chain = robot.arm().chain;
  Config at = rows.front().q;
  for (int lap = 0; lap < 10; ++lap)
    for (std::size_t i = 1; i < rows.size(); ++i) at += rows[i].q - rows[i - 1].q;
  bool turns = false;
  for (int j = 0; j < kDof; ++j) {
    const bool free = chain.limit[static_cast<std::size_t>(j)].continuous;
    const double off = at[j] - rows.front().q[j];
    ASSERT_LE(std::abs(free ? std::remainder(off, kTwoPi) : off), 1e-9) << what << " joint " << j;
    ASSERT_EQ(free ? 0 : rows.back().q[j] - rows.front().q[j], 0) << what << " joint " << j;
    turns = turns || std::abs(off) > 1;
  }
  counts.turned += turns;
  const CheckResult check = check_trajectory(robot, problem, rows);
  ASSERT_TRUE(check.passed) << what << ": " << (check.failures.empty() ? "" : check.failures[0]);
  ASSERT_NEAR(check.cost, result.cost, 1e-9) << what;
  std::vector<TrajectoryRow> off = rows;
  off.back().q[3] += 2e-9;
  const CheckResult refused = check_trajectory(robot, problem, off);
  ASSERT_FALSE(refused.passed) << what;
  ASSERT_NE(refused.failures[0].find("the path is closed"), std::string::npos) << what;
}

void check_ring(const RingArm& arm, const PathProblem& problem, const std::string& what,
                RingCounts& counts) {
  const PreparedRobot robot(problem);
  const ToolPath path = problem_path(problem, robot.arm().chain);
  const RingTruth truth = ring_truth(robot, robot.world(), path, problem, arm.nodes);
  const Lattice& lattice = *truth.lattice;
  ASSERT_TRUE(lattice.is_closed()) << what;
  const int last = lattice.layers() - 1;
  ASSERT_EQ(lattice.slots(0), lattice.slots(last)) << what;
  for (int slot = 0; slot < lattice.slots(0); ++slot)
    ASSERT_EQ(lattice.exact_config(0, slot), lattice.exact_config(last, slot)) << what;
  std::vector<PlanResult> results;
  for (const PlannerKind planner : kPlanners) {
    results.push_back(plan(robot, problem, with_all_evidence(planner)));
    const PlanResult &result = results.back(), &first = results.front();
    const std::string who = what + ' ' + result.planner;
    ASSERT_EQ(result.status == PlanStatus::kSolved, truth.start >= 0) << who;
    ASSERT_EQ(result.cost, first.cost) << who;
    ASSERT_EQ(result.trajectory.size(), first.trajectory.size()) << who;
    for (std::size_t i = 0; i < result.trajectory.size(); ++i)
      ASSERT_EQ(result.trajectory[i].q, first.trajectory[i].q) << who << " row " << i;
    ASSERT_EQ(diagnosis_of(result).reached_layer, diagnosis_of(first).reached_layer) << who;
    ASSERT_EQ(diagnosis_of(result).cause, diagnosis_of(first).cause) << who;
  }
  counts.obstacles += !problem.scene.empty();
  if (truth.start < 0) {
    ASSERT_EQ(diagnosis_of(results[0]).cause.kind == Cause::Kind::kNotClosed, truth.open.solved)
        << what;
    ++(truth.open.solved ? counts.open_only : counts.none);
    return;
  }
  ++counts.closed, ++counts.closed_by_nodes[static_cast<std::size_t>(arm.nodes)];
  ASSERT_EQ(results[0].lattice.cost, truth.cost) << what;
  counts.dearer += truth.cost > truth.open.cost * (1 + 1e-9);
  // Where the answer of a lattice whose wide joints are circles comes back in another turn, these
  // joints become nodes of their own.
  const std::unique_ptr<Lattice> circles =
      make_lattice(robot.arm().chain, robot.arm_class(), path, problem);
  counts.told_apart += results[0].lattice.nodes != circles->nodes();
  counts.other_branch +=
      lattice.path_rows(truth.open.slots).front().branch != results[0].trajectory.front().branch;
  expect_laps(robot, problem, results[0], what, counts);
}

TEST(ClosedPath, FourPlannersAndBruteForceOverAllStarts) {
  const std::uint64_t base = seed("ClosedPath");
  Random any(base);
  const std::vector<RingArm> arms = ring_arms(any);
  RingCounts counts;
  const int count = trials(220);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const RingArm& arm = arms[static_cast<std::size_t>(trial) % arms.size()];
    const PathProblem problem = ring_problem(arm, random);
    check_ring(arm, problem,
               "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                   " robot " + problem.source,
               counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "seed %llu: %d rings: %d closed (arm angles %d, arcs %d, six joints %d), %d of them dearer "
      "than the open path, %d turn a joint on; %d have open paths alone, %d none; %d with "
      "obstacles\n",
      static_cast<unsigned long long>(base), count, counts.closed, counts.closed_by_nodes[0],
      counts.closed_by_nodes[1], counts.closed_by_nodes[2], counts.dearer, counts.turned,
      counts.open_only, counts.none, counts.obstacles);
  EXPECT_GE(counts.closed, at_least(100));
  EXPECT_GE(counts.dearer, at_least(8));
  for (const int closed : counts.closed_by_nodes) EXPECT_GE(closed, at_least(6));
}

/// Arms of joints with a turn and more, and without limits, which may come back in another turn.
std::vector<RingArm> spinning_arms() {
  const TestRobot gen3 = ring_at_flange("gen3_like");
  TestRobot wide = with_limits(gen3, [](int number, Joint& joint) {
    if (number + 1 == kDof)
      joint.type = Joint::Type::kRevolute, joint.lower = -5, joint.upper = 5.5;
  });
  wide.name += ", joint 7 with limits";
  return {{windings_robot(), RingNodes::kArmAngles},
          {gen3, RingNodes::kArcs},
          {wide, RingNodes::kArcs},
          {ring_at_flange("kr6_like"), RingNodes::kSixJoints}};
}

/// Rings along which the last joint turns once. Where it has limits, and no other joint takes its
/// turn, paths lead to the end, and none closes. Where paths close, their postures are others than
/// those of the cheapest path that need not.
TEST(ClosedPath, RingsThatTurnAJoint) {
  const std::uint64_t base = seed("SpinningRings");
  const std::vector<RingArm> arms = spinning_arms();
  RingCounts counts;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const RingArm& arm = arms[static_cast<std::size_t>(trial) % arms.size()];
    check_ring(arm, ring_problem(arm, random, true),
               "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                   " robot " + arm.robot.name,
               counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "seed %llu: %d rings: %d have open paths alone, %d none; %d closed, %d of them dearer than "
      "the open path, %d in another branch, %d once a joint's turns were told apart, %d turn a "
      "joint on\n",
      static_cast<unsigned long long>(base), count, counts.open_only, counts.none, counts.closed,
      counts.dearer, counts.other_branch, counts.told_apart, counts.turned);
  EXPECT_GE(counts.open_only, at_least(12));
  EXPECT_GE(counts.closed, at_least(6));
  EXPECT_GE(counts.other_branch + counts.told_apart, at_least(2));
}

}  // namespace
}  // namespace swivel
