// SPDX-License-Identifier: BSD-3-Clause
// Closed paths and jobs of arms along arcs whose lattices have knots: against plain programs over
// the lattices on which they are answered, and a job of one stroke against its path alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "brute_force.hpp"
#include "diagnosis_of.hpp"
#include "job/transitions/job_transitions.hpp"
#include "knot_problems.hpp"
#include "planners.hpp"
#include "seed.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/problem_view.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

/// Returns a path that ends where it begins, with bodies in the way of most.
PathProblem random_closed_task(const TestRobot& robot, Random& random) {
  PathProblem problem = random_task(robot, random);
  problem.start.reset();
  problem.end.reset();
  Waypoint side = problem.waypoints.back();
  for (int k = 0; k < 3; ++k) side.position[k] += random.uniform(-0.05, 0.05);
  problem.waypoints.push_back(side);
  problem.waypoints.push_back(problem.waypoints.front());
  problem.closed = true;
  problem.limits.joint_step = std::max(problem.limits.joint_step, 0.25);
  problem.limits.tool_path_error = 0.02;
  if (random.coin(0.7)) put_in_the_way(problem, random);
  return problem;
}

/// Returns the least cost of a closed path of a lattice by a plain program over all starts.
double least_closed(const PreparedRobot& robot, const PlanView& view) {
  const BruteForcePath all =
      brute_force(view.lattice, view.world, view.world.edge_rule(robot.radii()),
                  [](int, int, int) { return true; });
  double least = kNone;
  for (const double cost : all.closed_costs) least = std::min(least, cost);
  return least;
}

struct Counts {
  int solved = 0, infeasible = 0, halved = 0;
  void print(const char* what, int count) const {
    std::printf("%d %s: %d solved, %d infeasible, %d with steps halved\n", count, what, solved,
                infeasible, halved);
  }
};

std::string name_of(std::uint64_t base, int trial, const PathProblem& problem) {
  return "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
         " robot " + problem.source + ' ';
}

/// A closed path costs least on the lattice on which it is answered, whatever the planner.
TEST(ClosedKnots, FourPlannersAndBruteForceOnRandomProblems) {
  const std::uint64_t base = seed("ClosedKnots");
  const auto robots = arms_of_one_turn();
  Counts counts;
  const int count = trials(90);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathProblem problem =
        random_closed_task(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    const std::string what = name_of(base, trial, problem);
    const PreparedRobot robot(problem);
    Planner lazy(problem);
    const PlanResult first = lazy.plan({.planner = PlannerKind::kLazy});
    const PlanView view = lazy.view();
    counts.halved += !view.lattice.halvings().empty();
    for (const PlannerKind planner : kPlanners) {
      const PlanResult other = plan(robot, problem, {.planner = planner, .threads = 2});
      ASSERT_EQ(other.status, first.status) << what << other.planner;
      ASSERT_EQ(other.cost, first.cost) << what << other.planner;
      ASSERT_EQ(diagnosis_of(other).cause, diagnosis_of(first).cause) << what << other.planner;
      ASSERT_EQ(other.trajectory.size(), first.trajectory.size()) << what << other.planner;
      for (std::size_t i = 0; i < first.trajectory.size(); ++i)
        ASSERT_EQ(other.trajectory[i].q, first.trajectory[i].q) << what << other.planner;
    }
    const double least = least_closed(robot, view);
    (first.status == PlanStatus::kSolved ? counts.solved : counts.infeasible)++;
    if (first.status != PlanStatus::kSolved) {
      ASSERT_EQ(least, kNone) << what;
      continue;
    }
    ASSERT_NEAR(first.lattice.cost, least, 1e-9) << what;
    ASSERT_EQ(first.trajectory.front().q, first.trajectory.back().q) << what;
    const CheckResult check = check_trajectory(robot, problem, first.trajectory);
    ASSERT_TRUE(check.passed) << what << (check.failures.empty() ? "" : check.failures[0]);
    if (first.lattice.knots && first.lattice.knots->bound) {
      ASSERT_LE(*first.lattice.knots->bound, first.cost + 1e-9) << what;
    }
  }
  counts.print("closed paths", count);
  EXPECT_GE(counts.solved, at_least_among(count / 8));
  EXPECT_GE(counts.infeasible, at_least_among(count / 20));
  EXPECT_GE(counts.halved, at_least_among(count / 20));
}

/// A job of one stroke without a home has the plan of its path alone: its cost bit for bit, its
/// rows up to the last bits, since those of a job are shifted by whole turns.
TEST(JobKnots, OfOneStrokeIsThePlanOfItsPath) {
  const std::uint64_t base = seed("JobKnots.One");
  const auto robots = arms_of_one_turn();
  Counts counts;
  const int count = trials(120);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const TestRobot& arm = robots[static_cast<std::size_t>(trial) % robots.size()];
    PathProblem problem =
        trial % 3 == 0 ? random_closed_task(arm, random) : random_task(arm, random);
    if (trial % 3 != 0) put_in_the_way(problem, random);
    const std::string what = name_of(base, trial, problem);
    const PreparedRobot robot(problem);
    const PlanResult alone = plan(robot, problem, {.planner = PlannerKind::kLazy});
    for (const PlannerKind planner : kPlanners) {
      const Answer job = plan_job(robot, one_path(problem), {.planner = planner, .threads = 2});
      ASSERT_EQ(job.status, alone.status) << what << job.planner;
      ASSERT_EQ(job.cost, alone.cost) << what << job.planner;
      const RunAnswer& run = job.arm().runs.at(0);
      if (alone.status != PlanStatus::kSolved) {
        ASSERT_TRUE(run.diagnosis) << what;
        ASSERT_EQ(run.diagnosis->cause, diagnosis_of(alone).cause) << what << job.planner;
        continue;
      }
      ASSERT_EQ(run.lattice.knots.has_value(), alone.lattice.knots.has_value()) << what;
      if (alone.lattice.knots) {
        ASSERT_EQ(run.lattice.knots->bound, alone.lattice.knots->bound) << what;
        ASSERT_EQ(run.lattice.knots->gap, alone.lattice.knots->gap) << what;
        ASSERT_EQ(run.lattice.knots->halved, alone.lattice.knots->halved) << what;
      }
      ASSERT_EQ(run.lattice.layers, alone.lattice.layers) << what;
      const std::vector<TrajectoryRow>& rows = job.arm().parts.at(0).rows;
      ASSERT_EQ(rows.size(), alone.trajectory.size()) << what;
      for (std::size_t i = 0; i < rows.size(); ++i)
        ASSERT_LT((rows[i].q - alone.trajectory[i].q).cwiseAbs().maxCoeff(), 1e-14)
            << what << job.planner;
    }
    (alone.status == PlanStatus::kSolved ? counts.solved : counts.infeasible)++;
    counts.halved +=
        alone.lattice.knots && alone.lattice.layers > 0 &&
        alone.lattice.layers != ArcLattice(robot.arm().chain, robot.arm_class().lock,
                                           problem_path(problem, robot.arm().chain), problem)
                                    .layers();
  }
  counts.print("jobs of one stroke", count);
  EXPECT_GE(counts.solved, at_least_among(count / 8));
  EXPECT_GE(counts.infeasible, at_least_among(count / 20));
  EXPECT_GE(counts.halved, at_least_among(count / 20));
}

/// Returns the least cost from each node of the first layer to each of the last.
std::vector<std::vector<double>> costs_through(const PlanView& view, const EdgeRule& rule) {
  PlainLattice plain(view.lattice, view.world, rule, [](int, int, int) { return true; }, {});
  const auto& nodes = plain.nodes();
  std::vector<std::vector<double>> costs(nodes.front().size(),
                                         std::vector<double>(nodes.front().size(), kNone));
  for (std::size_t a = 0; a < nodes.front().size(); ++a)
    if (nodes.front()[a]) costs[a][a] = 0;
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    std::vector<std::vector<double>> next(costs.size(),
                                          std::vector<double>(nodes[i + 1].size(), kNone));
    for (std::size_t a = 0; a < nodes[i].size(); ++a)
      for (std::size_t b = 0; nodes[i][a] && b < nodes[i + 1].size(); ++b) {
        const auto cost = nodes[i + 1][b] ? plain.edge(i, a, b) : std::nullopt;
        for (std::size_t first = 0; cost && first < costs.size(); ++first)
          next[first][b] = std::min(next[first][b], costs[first][a] + *cost);
      }
    costs = std::move(next);
  }
  return costs;
}

/// Bounds of what a job of two strokes without a home costs on two lattices.
struct TwoStrokes {
  double least = kNone;       ///< where all straight moves between the strokes are free
  double least_free = kNone;  ///< where only those are taken that are
};

TwoStrokes two_strokes_plainly(const PreparedRobot& robot, const Problem& job,
                               const ProblemView& view) {
  const EdgeRule rule = view.runs[0].world.edge_rule(robot.radii());
  const auto there = costs_through(view.runs[0], rule), back = costs_through(view.runs[1], rule);
  const Lattice &one = view.runs[0].lattice, &two = view.runs[1].lattice;
  PathProblem between = problem_of_run(job, {0, false});
  between.limits = limits_of_transitions(job);
  const World world(robot.world(), between);
  const EdgeRule rule_between = world.edge_rule(robot.radii());
  World::Query query(world);
  TwoStrokes plain;
  for (std::size_t end = 0; end < there.front().size(); ++end) {
    double before = kNone;
    for (const auto& from : there) before = std::min(before, from[end]);
    for (std::size_t begin = 0; before < kNone && begin < back.size(); ++begin) {
      const double after = *std::min_element(back[begin].begin(), back[begin].end());
      if (after == kNone) continue;
      const Config from = *one.node(one.layers() - 1, static_cast<int>(end)),
                   to = *two.node(0, static_cast<int>(begin));
      const double cost = before + transition_distance(one, from, to) + after;
      plain.least = std::min(plain.least, cost);
      if (cost < plain.least_free &&
          !edge_blocked(query, rule_between, from, from + one.delta(from, to), {}))
        plain.least_free = cost;
    }
  }
  return plain;
}

/// Returns a job that goes along a random path and back, with bodies in the way.
Problem there_and_back(const TestRobot& arm, Random& random) {
  PathProblem problem = random_task(arm, random);
  problem.start.reset();
  problem.end.reset();
  put_in_the_way(problem, random);
  Problem job = one_path(problem);
  Stroke back = job.arm().strokes[0];
  std::reverse(back.waypoints.begin(), back.waypoints.end());
  job.arm().strokes[0].name = "there";
  back.name = "back";
  job.arm().strokes.push_back(back);
  return job;
}

/// A job of two strokes costs least on the lattices on which it is answered: between what it costs
/// where all straight moves from stroke to stroke are free, and where only those are taken that
/// are.
TEST(JobKnots, OfTwoStrokesIsTheCheapestOnItsLattices) {
  const std::uint64_t base = seed("JobKnots.Two");
  const auto robots = arms_of_one_turn();
  Counts counts;
  int exact = 0;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const Problem job =
        there_and_back(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    const std::string what = name_of(base, trial, problem_of_run(job, {0, false}));
    const PreparedRobot robot(problem_of_run(job, {0, false}));
    ProblemView view;
    const Answer found = plan_job(robot, job, {.planner = PlannerKind::kLazy}, &view);
    for (const PlannerKind planner : kPlanners) {
      const Answer other = plan_job(robot, job, {.planner = planner, .threads = 2});
      ASSERT_EQ(other.status, found.status) << what << other.planner;
      ASSERT_EQ(other.cost, found.cost) << what << other.planner;
    }
    (found.status == PlanStatus::kSolved ? counts.solved : counts.infeasible)++;
    if (found.status != PlanStatus::kSolved) continue;
    ASSERT_EQ(view.runs.size(), 2u) << what;
    for (const PlanView& run : view.runs) counts.halved += !run.lattice.halvings().empty();
    const TwoStrokes plain = two_strokes_plainly(robot, job, view);
    ASSERT_GE(found.lattice_cost, plain.least - 1e-9) << what;
    ASSERT_LE(found.lattice_cost, plain.least_free + 1e-9) << what;
    exact += plain.least == plain.least_free;
  }
  counts.print("jobs of two strokes", count);
  std::printf("%d whose cheapest straight move is free\n", exact);
  EXPECT_GE(exact, at_least_among(count / 4));
  EXPECT_GE(counts.halved, at_least_among(count / 20));
}

/// Corners of ways around obstacles lie less than half a turn apart in joints that may turn for
/// longer: rows between them go the short way round.
TEST(JobKnots, WaysAroundObstaclesDoNotTurnByMoreThanHalfATurn) {
  Problem job =
      io::load_problem(std::string(SWIVEL_DATA_DIR) + "/problems/ur5e_deburr_plate_job.yaml");
  for (Stroke& stroke : job.arm().strokes)
    stroke.resolution.arc = stroke.resolution.knot.emplace(0.06);
  const Answer found = plan_job(job);
  EXPECT_EQ(found.status, PlanStatus::kSolved);
  EXPECT_LT(found.cost, 13.1);  // 13.34 with nodes at every layer
}

}  // namespace
}  // namespace swivel
