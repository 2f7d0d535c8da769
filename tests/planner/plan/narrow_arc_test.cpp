// SPDX-License-Identifier: BSD-3-Clause
// Paths that lead through an arc of arm angles narrower than the grid, and how far "no path" goes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "random_problem.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/study/advise.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

struct Narrowest {
  double width = kTwoPi;  // rad, of the widest arc there
  int layer = 0;
};

/// Where along the path the widest arc of arm angles is narrowest.
Narrowest narrowest(const ArmModel& arm, const SrsArm& srs, const PathProblem& problem) {
  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
  const SrsLattice lattice(arm.chain, srs, path, problem);
  Narrowest least;
  std::vector<AngleArc> arcs;
  for (int layer = 0; layer < lattice.layers(); ++layer) {
    double widest = 0;
    for (int solution = 0; solution < lattice.solutions(); ++solution) {
      lattice.arcs(layer, solution, arcs);
      for (const AngleArc& arc : arcs) widest = std::max(widest, arc.end - arc.begin);
    }
    if (widest < least.width) least = {widest, layer};
  }
  return least;
}

/// A path of two moves from a random posture, each of up to so many metres along every axis.
PathProblem drawn(const TestRobot& robot, const ArmModel& arm, double most, Random& random) {
  PathProblem problem = problem_for(robot);
  const Config q = random_config(arm.chain, random);
  Pose tool = arm.chain.tool(q);
  problem.waypoints.push_back(waypoint_of(tool));
  for (int k = 0; k < 2; ++k) {
    tool.translation() +=
        most * Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    problem.waypoints.push_back(waypoint_of(tool));
  }
  problem.resolution = {.ds = 0.01, .dphi = 0.2, .knot = 0};
  return problem;
}

/// The joint margin that leaves an arc of this width where the path is narrowest; none where there
/// is none.
std::optional<double> margin_that_leaves(double width, const ArmModel& arm, const SrsArm& srs,
                                         PathProblem problem) {
  double low = 0, high = 1.2;
  for (const JointLimit& limit : arm.chain.limit)
    if (!limit.continuous) high = std::min(high, 0.49 * (limit.upper - limit.lower));
  const auto leaves = [&](double margin) {
    problem.limits.joint_margin = margin;
    return narrowest(arm, srs, problem).width;
  };
  if (leaves(low) < width || leaves(high) > width) return std::nullopt;
  for (int step = 0; step < 45; ++step)
    (leaves((low + high) / 2) < width ? high : low) = (low + high) / 2;
  return std::abs(leaves(low) - width) < 0.01 * width ? std::optional(low) : std::nullopt;
}

PlanResult planned(PathProblem problem, bool arcs, PlannerKind kind = PlannerKind::kLazy) {
  problem.resolution.arcs = arcs;
  PlanOptions options;
  options.planner = kind;
  return plan(problem, options);
}

TEST(NarrowArc, IsPassedWithArcsAndFinerIsAdvisedWithout) {
  const std::uint64_t base = seed("NarrowArc");
  int solved = 0, missed = 0, advised = 0;
  const TestRobot robots[] = {data_robot("iiwa14"), data_robot("sda5f")};
  const int wanted = trials(12);
  for (int trial = 0; solved < wanted && trial < 200 * wanted; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const TestRobot& robot = robots[trial % 2];
    const ArmModel arm = arm_of(robot);
    const SrsArm srs = fit_srs(arm.chain, robot.name);
    PathProblem problem = drawn(robot, arm, 0.06, random);
    const auto margin = margin_that_leaves(0.01, arm, srs, problem);
    if (!margin) continue;
    problem.limits.joint_margin = *margin;
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    const PlanResult with = planned(problem, true), without = planned(problem, false);
    if (without.status == PlanStatus::kSolved) {  // nothing is lost
      ASSERT_EQ(with.status, PlanStatus::kSolved) << what;
      ASSERT_LE(with.lattice.cost, without.lattice.cost) << what;
    }
    if (with.status != PlanStatus::kSolved) continue;
    ++solved;
    for (const PlannerKind kind :
         {PlannerKind::kEager, PlannerKind::kEagerDp, PlannerKind::kParallel}) {
      const PlanResult same = planned(problem, true, kind);
      ASSERT_EQ(same.cost, with.cost) << what;
      ASSERT_EQ(same.trajectory.size(), with.trajectory.size()) << what;
      for (std::size_t i = 0; i < same.trajectory.size(); ++i)
        ASSERT_EQ(same.trajectory[i].q, with.trajectory[i].q) << what;
    }
    const CheckResult check = check_trajectory(problem, with.trajectory);
    ASSERT_TRUE(check.passed) << what << ": " << (check.failures.empty() ? "" : check.failures[0]);
    if (without.status == PlanStatus::kSolved) continue;
    ++missed;
    EXPECT_EQ(without.diagnosis->holds(), Diagnosis::Holds::kThisResolution) << what;
    Planner planner(problem);
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    const PlanResult result = planner.plan(options);
    options.timeout_s = 20;
    for (const Advice& advice : advise(planner, result, options))
      advised +=
          advice.change == Advice::Change::kFiner && advice.outcome == Advice::Outcome::kSolved;
  }
  std::printf(
      "%d paths through an arc of 0.01 rad solved with arcs under dphi 0.2; without, %d were "
      "missed, and finer advised for %d\n",
      solved, missed, advised);
  EXPECT_GE(solved, at_least(12));
  EXPECT_GE(missed, at_least(6));
  EXPECT_EQ(advised, missed);
}

/// Makes a path between random postures far apart: what is hard to reach is between waypoints.
PathProblem drawn_far(const TestRobot& robot, const ArmModel& arm, double most, Random& random) {
  PathProblem problem = drawn(robot, arm, most, random);
  problem.waypoints = {problem.waypoints[0],
                       waypoint_of(arm.chain.tool(random_config(arm.chain, random)))};
  problem.resolution = {.ds = 0.05, .dphi = 0.2, .dalpha = 0.2, .knot = 0};
  return problem;
}

/// Returns whether any IK solution at one of 4000 arm angles keeps all joints `margin` rad within
/// their limits.
bool sampled_within_limits(const Chain& chain, const SrsArm& srs,
                           const std::array<ElbowCircle, 2>& circles, double margin) {
  for (int k = 0; k < 4000; ++k)
    for (int branch = 0; branch < kBranches; ++branch) {
      const Config q = srs_ik(srs, circles, -kPi + kTwoPi * k / 4000, branch);
      bool within = true;
      for (int j = 0; j < kDof; ++j) {
        const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
        within = within && (limit.continuous ||
                            (q[j] >= limit.lower + margin && q[j] <= limit.upper - margin));
      }
      if (within) return true;
    }
  return false;
}

/// Checks layers proved unreachable by sampling, and how far "no path" says that it holds.
void expect_holds_as_proved(const PathProblem& problem, const ToolPath& path, const ArmModel& arm,
                            const SrsArm& srs, const Diagnosis& diagnosis,
                            const std::string& what) {
  const SrsLattice lattice(arm.chain, srs, path, problem);
  bool waypoint_empty = false, empty = false;
  for (int layer = 0; layer < lattice.layers();
       ++layer) {  // by sampling, each IK solution's joints within the limits
    if (reach_status(srs, lattice.plane(layer).reach) != ReachStatus::kReachable) continue;
    const auto circles = elbow_circles(srs, lattice.plane(layer), path.layer(layer).tool);
    const bool any = sampled_within_limits(arm.chain, srs, circles, problem.limits.joint_margin);
    const bool proved = lattice.proved_unreachable(layer);
    ASSERT_FALSE(any && proved) << what;
    if (proved) {
      empty = true;
      waypoint_empty = waypoint_empty || path.layer(layer).waypoint >= 0;
    }
  }
  ASSERT_EQ(diagnosis.holds(), waypoint_empty ? Diagnosis::Holds::kEveryResolution
                               : empty        ? Diagnosis::Holds::kExactTool
                                              : Diagnosis::Holds::kThisResolution)
      << what;
}

/// Counts the answers "no path" by how far they hold, and those that were tried finer.
struct HoldsCounts {
  std::array<int, 3> seen{};
  int finer = 0;
};

/// Plans with the problem's joint margin and checks how far "no path" holds, if that is the answer.
void check_no_path(const PathProblem& problem, const ArmModel& arm, const SrsArm& srs,
                   const std::string& what, HoldsCounts& counts) {
  const PlanResult result = planned(problem, false);
  if (result.status == PlanStatus::kSolved) return;
  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
  const Diagnosis& diagnosis = *result.diagnosis;
  ++counts.seen[static_cast<std::size_t>(diagnosis.holds())];
  expect_holds_as_proved(problem, path, arm, srs, diagnosis, what);
  if (::testing::Test::HasFatalFailure()) return;
  if (diagnosis.holds() != Diagnosis::Holds::kEveryResolution) return;
  ASSERT_EQ(path.layer(diagnosis.unreachable->layer).waypoint, diagnosis.unreachable->waypoint)
      << what;
  PathProblem finer = problem;
  finer.resolution.ds /= 3;
  finer.resolution.dphi /= 7;
  ASSERT_EQ(planned(finer, true).status, PlanStatus::kInfeasible) << what;
  ++counts.finer;
}

/// With a margin that just leaves no arc, "no path" holds at every resolution where that is at a
/// waypoint, else for a tool that follows exactly; with one that just leaves an arc it holds for
/// this resolution.
TEST(NarrowArc, NoPathHoldsAsFarAsItSays) {
  const std::uint64_t base = seed("NarrowArc.Holds");
  HoldsCounts counts;
  const TestRobot robots[] = {data_robot("iiwa14"), continuous_robot()};
  for (int trial = 0; trial < trials(60); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const TestRobot& robot = robots[trial % 2];
    const ArmModel arm = arm_of(robot);
    const SrsArm srs = fit_srs(arm.chain, robot.name);
    const bool far = trial % 4 > 1;
    PathProblem problem = (far ? drawn_far : drawn)(robot, arm, 0.1, random);
    const auto margin = far ? std::optional(0.0) : margin_that_leaves(1e-3, arm, srs, problem);
    if (!margin) continue;
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    for (const double more : {0.0, 0.02}) {
      problem.limits.joint_margin = *margin + more;
      check_no_path(problem, arm, srs, what, counts);
      if (HasFatalFailure()) return;
    }
  }
  std::printf(
      "%d for this resolution, %d for an exact tool, %d for every resolution, of which %d were "
      "tried finer\n",
      counts.seen[0], counts.seen[1], counts.seen[2], counts.finer);
  for (const int count : counts.seen) EXPECT_GE(count, at_least(3));
}

}  // namespace
}  // namespace swivel
