// SPDX-License-Identifier: BSD-3-Clause
// Arms whose files are rounded, or that are built a little off: nodes of the ideal arm, rows on the
// exact chain.
#include <gtest/gtest.h>

#include <cmath>

#include "brute_force.hpp"
#include "diagnosis_of.hpp"
#include "inexact_robots.hpp"
#include "planners.hpp"
#include "random_problem.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"
#include "window.hpp"

namespace swivel {
namespace {

using namespace test;

struct Laid {
  explicit Laid(const PathProblem& problem)
      : robot(problem),
        path(waypoints_in_base(problem), problem.resolution, problem.source),
        lattice(robot.arm().chain, robot.srs(), path, problem) {}
  PreparedRobot robot;
  ToolPath path;
  SrsLattice lattice;
};

BruteForcePath truth_of(const Laid& laid) {
  return brute_force(
      laid.lattice, laid.robot.world(), laid.robot.world().edge_rule(laid.robot.radii()),
      [&](int layer, int a, int b) { return window_allows(laid.lattice, layer, a, b); });
}

/// Counts the problems by what they have and by how they end.
struct Counts {
  int solved = 0, infeasible = 0, started = 0, detours = 0, continuous = 0, dearer = 0,
      without_row = 0, rows = 0;
  double farthest = 0;  // of a row's tool from the path, m or rad
};

/// Checks a planner's answer, with its rows and reasons, against the first planner's.
void expect_same_answer(const PlanResult& other, const PlanResult& first,
                        const BruteForcePath& truth, const std::string& what) {
  ASSERT_EQ(other.status, truth.solved ? PlanStatus::kSolved : PlanStatus::kInfeasible)
      << what << " " << other.planner;
  ASSERT_EQ(other.cost, first.cost) << what << " " << other.planner;
  ASSERT_EQ(other.lattice.cost, first.lattice.cost) << what << " " << other.planner;
  ASSERT_EQ(other.trajectory.size(), first.trajectory.size()) << what;
  for (std::size_t i = 0; i < first.trajectory.size(); ++i) {
    ASSERT_EQ(other.trajectory[i].q, first.trajectory[i].q)
        << what << " " << other.planner << " row " << i;
    ASSERT_EQ(other.trajectory[i].phi, first.trajectory[i].phi) << what;
  }
  ASSERT_EQ(words(diagnosis_of(other).cause), words(diagnosis_of(first).cause))
      << what << " " << other.planner;
  ASSERT_EQ(diagnosis_of(other).removed, diagnosis_of(first).removed)
      << what << " " << other.planner;
}

/// Checks how far a problem without a path is said to reach, and its layers without nodes.
void expect_reaches_as_far(const Diagnosis& diagnosis, const BruteForcePath& truth,
                           const std::string& what) {
  ASSERT_EQ(diagnosis.reached_layer.value_or(-1), truth.deepest) << what;
  std::vector<int> empty;
  for (const EmptyLayers& run : diagnosis.empty_layers)
    for (int layer = run.first; layer <= run.last; ++layer) empty.push_back(layer);
  ASSERT_EQ(empty, truth.empty) << what;
}

/// Checks a trajectory's arm angles, start and cost, and notes how far its tool is from the path.
void expect_rows_of_path(const Laid& laid, const PathProblem& problem, const PlanResult& result,
                         const BruteForcePath& truth, const std::string& what, Counts& counts) {
  const SrsLattice& lattice = laid.lattice;
  ASSERT_EQ(result.lattice.cost, truth.cost) << what;
  counts.dearer += result.cost != result.lattice.cost;
  for (int i = 0; i < lattice.layers(); ++i) {
    const TrajectoryRow& row = result.trajectory[static_cast<std::size_t>(i)];
    ASSERT_EQ(row.phi, lattice.phi(i, truth.slots[static_cast<std::size_t>(i)])) << what;
    const Pose reached = lattice.chain().tool(row.q), &asked = laid.path.layer(i).tool;
    counts.farthest =
        std::max({counts.farthest, (reached.translation() - asked.translation()).norm(),
                  Eigen::AngleAxisd(reached.linear().transpose() * asked.linear()).angle()});
    ++counts.rows;
  }
  if (problem.start) {
    ASSERT_EQ(result.trajectory[0].q, *problem.start) << what;
  }
  const CheckResult check = check_trajectory(laid.robot, problem, result.trajectory);
  ASSERT_TRUE(check.passed) << what << ": " << (check.failures.empty() ? "" : check.failures[0]);
  ASSERT_NEAR(check.cost, result.cost, 1e-9) << what;
}

/// Checks all planners on one problem of an arm that is approximately S-R-S.
void check_problem(const PathProblem& problem, const std::string& what, Counts& counts) {
  const Laid laid(problem);
  const SrsLattice& lattice = laid.lattice;
  ASSERT_TRUE(lattice.is_approximate()) << what;
  for (int layer = 0; layer < lattice.layers(); ++layer)
    for (int slot = 0; slot < lattice.width(); ++slot)
      counts.without_row += lattice.node(layer, slot) && !lattice.exact_config(layer, slot);
  const BruteForcePath truth = truth_of(laid);
  std::vector<PlanResult> results;
  for (const PlannerKind planner : kPlanners) {
    results.push_back(plan(laid.robot, problem, with_all_evidence(planner)));
    expect_same_answer(results.back(), results[0], truth, what);
    if (::testing::Test::HasFatalFailure()) return;
  }
  counts.started += problem.start.has_value();
  counts.continuous += problem.limits.edges == EdgeMode::kContinuous;
  counts.detours += results[2].counters.iterations > 1;
  if (truth.solved) {
    ++counts.solved;
    expect_rows_of_path(laid, problem, results[0], truth, what, counts);
  } else {
    ++counts.infeasible;
    expect_reaches_as_far(diagnosis_of(results[0]), truth, what);
  }
}

TEST(Inexact, FourPlannersAndBruteForceAgreeAndRowsAreOnTheExactChain) {
  const std::uint64_t base = seed("Inexact.Agreement");
  Random making(base);
  const std::vector<TestRobot> robots = inexact_robots(making);
  Counts counts;
  const int count = trials(200);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem =
        random_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    if (random.coin(0.3))
      problem.limits.joint_step = random.uniform(0.1, 0.4);  // where steps decide
    check_problem(problem,
                  "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                      " robot " + problem.source,
                  counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d problems: %d solved (%d of another cost than their nodes), %d infeasible, %d continuous, "
      "%d with a start, %d after "
      "failures; %d nodes without a row; %d rows within %.1e m and rad\n",
      count, counts.solved, counts.dearer, counts.infeasible, counts.continuous, counts.started,
      counts.detours, counts.without_row, counts.rows, counts.farthest);
  EXPECT_LE(counts.farthest, 1e-9);
  EXPECT_GE(counts.solved, at_least_among(count / 4));
  EXPECT_EQ(counts.dearer, counts.solved);
  EXPECT_GE(counts.infeasible, at_least_among(count / 20));
  EXPECT_GE(counts.continuous, at_least_among(count / 5));
  EXPECT_GE(counts.started, at_least_among(count / 10));
  EXPECT_GE(counts.detours, at_least_among(count / 20));
  EXPECT_GE(counts.without_row, at_least(101));
}

/// A row that keeps to the limits is not missed because the fitted arm's joints lie beyond them:
/// away from singular poses every posture within the limits has a node, whose row it is.
TEST(Inexact, PosturesAtTheLimitsAreRows) {
  const std::uint64_t base = seed("Inexact.Limits");
  Random random(base);
  int tried = 0, beyond = 0;
  for (const TestRobot& robot : inexact_robots(random)) {
    const Chain chain = arm_of(robot).chain;
    const SrsArm arm = fit_srs(chain, robot.name);
    EXPECT_FALSE(arm.exact);
    std::printf("%s: off by %.2g mm and %.2g mrad, misfit up to %.2g rad\n", robot.name.c_str(),
                1e3 * arm.deviation.offset, 1e3 * arm.deviation.angle, arm.fit_error.maxCoeff());
    EXPECT_GT(arm.fit_error.coordinates().minCoeff(), 0);
    for (int trial = 0; trial < trials(40); ++trial) {
      Config q = random_config(chain, random);
      const int joint = random.below(kDof);
      const JointLimit& limit = chain.limit[static_cast<std::size_t>(joint)];
      if (!limit.continuous) q[joint] = random.coin() ? limit.lower : limit.upper;
      const double sine = std::min({std::abs(std::sin(arm.shoulder_angle(q))),
                                    std::abs(std::sin(arm.elbow_angle(q))),
                                    std::abs(std::sin(arm.wrist_angle(q)))});
      if (sine < 0.15) continue;
      PathProblem problem = problem_for(robot);
      const Pose tool = chain.tool(q);
      Pose next = tool;
      next.translation().z() += 0.01;
      problem.waypoints = {waypoint_of(tool), waypoint_of(next)};
      problem.resolution = {.ds = 0.02, .dphi = kTwoPi / 3, .dalpha = 0.1};
      // With the posture as the start its arm angle is on the lattice; without, the closest node
      // shows that the labels are right.
      problem.start = q;
      const Laid laid(problem);
      const int slot = laid.lattice.start_slot();
      const auto node = laid.lattice.node(0, slot);
      ASSERT_TRUE(node) << robot.name;
      ASSERT_EQ(laid.lattice.exact_config(0, slot), q);
      ASSERT_LE((*node - q).cwiseAbs().maxCoeff(), kMostCorrection);
      const ArmPlane& plane = laid.lattice.plane(0);
      const double phi = plane.angle_of(arm.elbow_axis(q));
      const auto exact = solve_exact_chain(chain, arm, plane, tool, phi, *node);
      ASSERT_TRUE(exact) << robot.name;
      ASSERT_LE((*exact - q).cwiseAbs().maxCoeff(), 1e-7) << robot.name;
      for (int j = 0; j < kDof; ++j) {
        EXPECT_LE(std::abs((*node)[j] - q[j]), 1.5 * laid.lattice.fit_error()[j] + 1e-9)
            << robot.name << " joint " << j;
        const JointLimit& bound = chain.limit[static_cast<std::size_t>(j)];
        beyond += !bound.continuous && ((*node)[j] < bound.lower || (*node)[j] > bound.upper);
      }
      ++tried;
    }
  }
  std::printf("%d postures, %d joints of nodes beyond a limit\n", tried, beyond);
  EXPECT_GE(tried, at_least(101));
  EXPECT_GE(beyond, at_least(21));
}

/// Rows lie on the exact chain at the arm angle, whether Newton looked at its last step or took it
/// as short enough. Of postures anywhere, also near singular ones, where it has to look.
TEST(Inexact, EveryRowIsOnTheExactChain) {
  const std::uint64_t base = seed("Inexact.Residual");
  Random random(base);
  int rows = 0, none = 0, near_singular = 0;
  double farthest = 0, most_turned = 0;
  for (int set = 0; set < 4; ++set)
    for (const TestRobot& robot : inexact_robots(random)) {
      const Chain chain = arm_of(robot).chain;
      const SrsArm arm = fit_srs(chain, robot.name);
      for (int trial = 0; trial < trials(2000) / 4; ++trial) {
        Config q = random_config(chain, random);
        if (trial % 4 == 0)
          q[1] = std::copysign(std::pow(10, random.uniform(-4, -1)),
                               q[1]);  // near a stretched shoulder
        const Pose tool = chain.tool(q);
        const ArmPlane plane = first_plane(arm, tool);
        if (reach_status(arm, plane.reach) != ReachStatus::kReachable) continue;
        const double phi = plane.angle_of(arm.elbow_axis(q));
        const auto circles = elbow_circles(arm, plane, tool);
        for (int branch = 0; branch < kBranches; ++branch) {
          const auto row =
              solve_exact_chain(chain, arm, plane, tool, phi, srs_ik(arm, circles, phi, branch));
          none += !row;
          if (!row) continue;
          ++rows;
          near_singular += std::abs(std::sin(arm.shoulder_angle(*row))) < 0.01;
          farthest = std::max(farthest, (chain.tool(*row).matrix() - tool.matrix()).norm());
          most_turned =
              std::max(most_turned, std::abs(wrap_angle(arm_angle(arm, plane, *row) - phi)));
        }
      }
    }
  std::printf(
      "SWIVEL_TEST_SEED %llu: %d rows, %d poses without, %d near a stretched shoulder, residual "
      "%.2g, arm angle %.2g rad\n",
      static_cast<unsigned long long>(base), rows, none, near_singular, farthest, most_turned);
  EXPECT_GE(rows, at_least(1001));
  EXPECT_GE(near_singular, at_least(101));
  EXPECT_LE(farthest, 3.2e-10);  // each of nine numbers to 1e-10
  EXPECT_LE(most_turned, 1.01e-10);
}

/// A start keeps its joints wherever the fitted arm has none: stretched further than that can
/// reach, or singular for it.
TEST(Inexact, AStartBeyondTheFittedArmsReachIsANode) {
  const std::uint64_t base = seed("Inexact.Start");
  Random random(base);
  int own = 0, fitted = 0, solved = 0;
  for (int trial = 0; trial < trials(30); ++trial) {
    const TestRobot robot =
        perturbed(trial % 2 ? continuous_robot() : data_robot("iiwa14"), 1, random);
    const Chain chain = arm_of(robot).chain;
    const SrsArm arm = fit_srs(chain, robot.name);
    Config q = 0.3 * random_config(chain, random);
    q[1] = random.uniform(0.4, 0.8), q[5] = random.uniform(0.4, 0.8);
    q[3] = -arm.elbow_shift + (trial % 3 == 0 ? random.uniform(-0.002, 0.002) : 0.3);
    PathProblem problem = problem_for(robot);
    Pose tool = chain.tool(q), next = tool;
    next.translation() -= 0.03 * (tool.translation() - arm.S).normalized();
    problem.waypoints = {waypoint_of(tool), waypoint_of(next)};
    problem.resolution = {.ds = 0.02, .dphi = 0.6, .dalpha = 0.2, .knot = 0};
    problem.limits.joint_step = 1.0;
    problem.limits.tool_path_error = std::nullopt;
    problem.start = q;
    const Laid laid(problem);  // no bad input
    const auto node = laid.lattice.node(0, laid.lattice.start_slot());
    ASSERT_TRUE(node);
    ASSERT_EQ(laid.lattice.exact_config(0, laid.lattice.start_slot()), q);
    (*node == q ? own : fitted) += 1;
    const BruteForcePath truth = truth_of(laid);
    for (const PlannerKind planner : kPlanners) {
      PlanOptions options;
      options.planner = planner;
      const PlanResult result = plan(laid.robot, problem, options);
      ASSERT_EQ(result.status == PlanStatus::kSolved, truth.solved) << trial;
      if (!truth.solved) continue;
      ASSERT_EQ(result.lattice.cost, truth.cost) << trial;
      ASSERT_EQ(result.trajectory[0].q, q);
    }
    solved += truth.solved;
  }
  std::printf("%d starts with their own joints, %d with the fitted arm's, %d solved\n", own, fitted,
              solved);
  EXPECT_GE(own, at_least(3));
  EXPECT_GE(fitted, at_least(15));
  EXPECT_GE(solved, at_least(15));
}

}  // namespace
}  // namespace swivel
