// SPDX-License-Identifier: BSD-3-Clause
// Paths that end in the joints in which they begin: every planner against brute force over all
// starts on every kind of lattice that closes, laps, the check, refining and timing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "brute_force.hpp"
#include "inexact_robots.hpp"
#include "motion_problem.hpp"
#include "planners.hpp"
#include "random_problem.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
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
#include "window.hpp"

namespace swivel {
namespace {

using namespace test;

/// What a layer's nodes are: arm angles, points on arcs of self-motion of seven joints or of six
/// and the roll.
enum class RingNodes { kArmAngles, kArcs, kSixJoints };

struct RingArm {
  TestRobot robot;
  RingNodes nodes;
};

TestRobot ring_at_flange(const char* name) {
  TestRobot robot = data_robot(name);
  robot.tip_link = "flange";
  return robot;
}

/// Arms with limits, without, of several turns, exactly S-R-S, nearly and not at all.
std::vector<RingArm> ring_arms(Random& random) {
  std::vector<RingArm> arms;
  for (const TestRobot& robot : all_robots()) arms.push_back({robot, RingNodes::kArmAngles});
  arms.push_back({windings_robot(), RingNodes::kArmAngles});
  arms.push_back({perturbed(data_robot("iiwa14"), 1, random), RingNodes::kArmAngles});
  const TestRobot turns = with_limits(ring_at_flange("xarm7_like"), [](int number, Joint& joint) {
    if (number % 2 == 0) joint.upper = number < 4 ? 3.1 : kTwoPi, joint.lower = -joint.upper;
  });
  for (const TestRobot& robot : {ring_at_flange("panda_like"), ring_at_flange("gen3_like"), turns})
    arms.push_back({robot, RingNodes::kArcs});
  arms.push_back({ring_at_flange("kr6_like"), RingNodes::kSixJoints});
  return arms;
}

void keep_ring_inside(const Chain& chain, Config& q) {
  constexpr double kInside = 0.12;  // rad, more than any joint margin
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    if (!limit.continuous) q[j] = std::clamp(q[j], limit.lower + kInside, limit.upper - kInside);
  }
}

/// Sets how fine the lattice is, and limits that suit it; `coarse`: never fine.
void draw_ring_lattice(Problem& problem, RingNodes nodes, double length, bool coarse,
                       Random& random) {
  Resolution& resolution = problem.resolution;
  resolution.ds = std::max(0.01, length / (4 + random.below(4)));
  resolution.dalpha = random.uniform(0.3, 0.8);
  resolution.dphi = problem.source == "windings" ? 0.9 : random.uniform(0.3, 0.6);
  resolution.arc = random.uniform(0.3, 0.6);
  problem_parts::draw_limits(problem, random);
  Limits& limits = problem.limits;
  // Where nodes lie close together and joints weigh unlike, the cheapest open path drifts.
  const bool unlike = random.coin(), fine = unlike && !coarse;
  if (unlike)
    for (double& weight : problem.cost.weights) weight = random.uniform(0.05, 2);
  if (nodes == RingNodes::kArmAngles) {
    resolution.arcs = random.coin();
    if (fine && problem.source != "windings") {
      resolution.dphi = random.uniform(0.06, 0.12);
      limits.arm_slope = Limits().arm_slope;
    }
    return;
  }
  if (fine) resolution.arc = random.uniform(0.1, 0.2);
  if (coarse) resolution.arc *= 1.5, resolution.dalpha = random.uniform(0.7, 1);
  limits.step_error.reset();
  if (limits.tool_path_error) limits.tool_path_error = random.uniform(0.02, 0.1);
  if (limits.tool_angle_error) limits.tool_angle_error = random.uniform(0.1, 0.4);
  limits.joint_step = 1;
  limits.arm_slope = Limits().arm_slope;
  limits.roll_slope = random.uniform(5, 15);
}

/// Draws a closed path of two to four sides through tool poses of postures near each other, some
/// with obstacles. A ring of `spins` has three sides, along which the last joint turns once, that
/// before a roll.
Problem ring_problem(const RingArm& arm, Random& random, bool spins = false) {
  Problem problem = problem_for(arm.robot);
  if (arm.nodes == RingNodes::kSixJoints)
    problem.roll = random.coin() ? Roll{} : Roll{random.uniform(-2, -0.5), random.uniform(0.5, 2)};
  const Chain chain =
      build_arm(*problem.model, problem.base_link, problem.tip_link, {}, problem.tool, problem.roll)
          .chain;
  Config q = random_config(chain, random);
  if (chain.roll) q[kDof - 1] = random.uniform(-0.2, 0.2);
  keep_ring_inside(chain, q);
  problem.waypoints.push_back(waypoint_of(chain.tool(q)));
  const int last = chain.roll ? kDof - 2 : kDof - 1, sides = spins ? 3 : 2 + random.below(3);
  for (int side = 1; side < sides; ++side) {
    for (int j = 0; j < kDof; ++j) q[j] += random.uniform(-0.2, 0.2);
    keep_ring_inside(chain, q);
    Config turned = q;
    if (spins) turned[last] += kTwoPi * side / sides;
    problem.waypoints.push_back(waypoint_of(chain.tool(turned)));
  }
  problem.waypoints.push_back(problem.waypoints.front());
  Quaterniond& orientation = problem.waypoints.back().orientation;
  if (random.coin()) orientation.coeffs() = -orientation.coeffs();  // the same rotation
  if (random.coin()) problem.waypoints.back().position.x() += 5e-7;
  problem.closed = true;
  double length = 0;
  for (std::size_t k = 1; k < problem.waypoints.size(); ++k)
    length += (problem.waypoints[k].position - problem.waypoints[k - 1].position).norm();
  if (random.coin(0.6))
    problem_parts::draw_obstacles(problem, chain, q, 1 + random.below(3), random);
  draw_ring_lattice(problem, arm.nodes, length, spins, random);
  if (random.coin(0.2)) problem.cost.metric = CostMetric::kMax;
  return problem;
}

/// The lattice of a ring and its answer by brute force over all starts.
struct RingTruth {
  std::unique_ptr<const Lattice> lattice;
  Answer open;
  int start = -1;  // the slot in which the answer begins; -1 where no path closes
  double cost = std::numeric_limits<double>::infinity();
};

RingTruth ring_truth(const PreparedRobot& robot, const ToolPath& path, const Problem& problem,
                     RingNodes nodes) {
  const Chain& chain = robot.arm().chain;
  RingTruth truth;
  std::function<bool(int, int, int)> in_window;
  if (nodes == RingNodes::kArmAngles) {
    auto lattice = std::make_unique<SrsLattice>(chain, robot.srs(), path, problem);
    in_window = [grid = lattice.get()](int layer, int a, int b) {
      return window_allows(*grid, layer, a, b);
    };
    truth.lattice = std::move(lattice);
  } else {
    const ArcLattice circles(chain, robot.arm_class().lock, path, problem);
    truth.lattice = circles.with_windings(circles.circles());
    in_window = [&, lattice = truth.lattice.get()](int layer, int a, int b) {
      const double turn =
          (*lattice->node(layer + 1, b))[kDof - 1] - (*lattice->node(layer, a))[kDof - 1];
      return nodes == RingNodes::kArcs ||
             std::abs(std::remainder(turn, kTwoPi)) <=
                 roll_step_bound(path, layer, problem.limits, problem.resolution);
    };
  }
  const Lattice& lattice = *truth.lattice;
  truth.open =
      brute_force(lattice, robot.world(), robot.world().edge_rule(robot.radii()), in_window);
  truth.start = first_of_answer(lattice, truth.open.closed_costs,
                                [&](int slot) { return *lattice.node(0, slot); });
  if (truth.start >= 0) truth.cost = truth.open.closed_costs[static_cast<std::size_t>(truth.start)];
  return truth;
}

struct RingCounts {
  int closed = 0, open_only = 0, none = 0, dearer = 0, obstacles = 0, turned = 0;
  int other_branch = 0, told_apart = 0;
  std::array<int, 3> closed_by_nodes{};
};

/// Expects that ten laps, each begun in the joints in which the one before ended, are the same lap
/// but for whole turns of joints without limits, and that the check proves the first and refuses it
/// where it does not close.
void expect_laps(const PreparedRobot& robot, const Problem& problem, const PlanResult& result,
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

void check_ring(const RingArm& arm, const Problem& problem, const std::string& what,
                RingCounts& counts) {
  const PreparedRobot robot(problem);
  const ToolPath path = problem_path(problem, robot.arm().chain);
  const RingTruth truth = ring_truth(robot, path, problem, arm.nodes);
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
    ASSERT_EQ(result.diagnosis.reached_layer, first.diagnosis.reached_layer) << who;
    ASSERT_EQ(result.diagnosis.cause, first.diagnosis.cause) << who;
  }
  counts.obstacles += !problem.scene.empty();
  if (truth.start < 0) {
    ASSERT_EQ(results[0].diagnosis.cause.kind == Cause::Kind::kNotClosed, truth.open.solved)
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
    const Problem problem = ring_problem(arm, random);
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
