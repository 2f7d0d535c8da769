// SPDX-License-Identifier: BSD-3-Clause
// Refined paths and motions in time on random problems, held against the check that knows nothing of either.
#include "swivel/planner/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "robots.hpp"
#include "swivel/core/angle.hpp"
#include "swivel/core/invalid_argument.hpp"
#include "swivel/planner/check.hpp"
#include "swivel/planner/refine.hpp"

namespace swivel {
namespace {

using namespace test;

/// Two to four segments from a posture well inside the limits, a ball near the arm, sometimes a start, a turn on the spot or a
/// metric other than l2.
Problem some_problem(const TestRobot& robot, Random& random) {
  Problem problem = problem_for(robot);
  const Chain chain = arm_of(robot).chain;
  Config q;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    const double middle = limit.continuous ? 0 : (limit.lower + limit.upper) / 2;
    q[j] = middle + random.uniform(-0.6, 0.6) + (j == 1 || j == 3 || j == 5 ? (random.coin() ? 0.8 : -0.8) : 0.0);
  }
  const auto vector = [&](double size) {
    return Vector3d(size * Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized());
  };
  problem.waypoints.push_back(waypoint_of(chain.tool(q)));
  const int more = 2 + random.below(3), on_the_spot = random.below(3) == 0 ? random.below(more) : -1;
  for (int k = 0; k < more; ++k) {
    Waypoint to = problem.waypoints.back();
    if (k != on_the_spot) to.position += vector(random.uniform(0.04, 0.1));
    const Vector3d turn = vector(random.uniform(0.05, 0.4));
    to.orientation = to.orientation * Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    problem.waypoints.push_back(to);
  }
  problem.resolution = {.ds = 0.01, .dphi = 0.1, .dalpha = 0.1};
  problem.limits.clearance = 0.003;
  Pose ball = Pose::Identity();
  ball.translation() = problem.waypoints[1].position + vector(0.18);
  problem.scene.push_back({"ball", Sphere{0.04}, ball, {}});
  if (random.coin(0.3)) problem.start = q;
  if (random.coin(0.3)) problem.cost.metric = random.coin() ? CostMetric::kMax : CostMetric::kTime;
  problem.smooth = PathSmoothing{};
  return problem;
}

/// Calls each(problem, robot, rows) for problems with a path; returns how many.
template <class Each>
int for_solved(const char* name, int count, const Each& each) {
  const std::uint64_t base = seed(name);
  const std::vector<TestRobot> robots = all_robots();
  int solved = 0;
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const Problem problem = some_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    const PreparedRobot robot(problem);
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    const PlanResult found = plan(robot, problem, options);
    if (found.status != PlanStatus::kSolved) continue;
    ++solved;
    SCOPED_TRACE(problem.source + " " + std::to_string(trial));
    each(problem, robot, found);
  }
  return solved;
}

TEST(Refine, IsValidNeverDearerAndKeepsLabels) {
  int refined = 0, cheaper = 0, starts = 0, turns = 0, seconds = 0;
  std::set<CostMetric> metrics;
  double sum = 0;
  const int solved =
      for_solved("Refine", trials(40), [&](const Problem& problem, const PreparedRobot& robot, const PlanResult& found) {
        const Refined result = refine(robot, problem, found.trajectory);
        EXPECT_NEAR(result.cost_before, found.cost, 1e-9 * (1 + found.cost));
        EXPECT_LE(result.cost, result.cost_before);
        ASSERT_EQ(result.rows.size(), found.trajectory.size());
        EXPECT_EQ(result.refined, result.reason.empty());
        const CheckResult check = check_trajectory(robot, problem, result.rows);
        EXPECT_TRUE(check.passed) << (check.failures.empty() ? "" : check.failures[0]);
        EXPECT_NEAR(check.cost, result.cost, 1e-6);
        if (problem.start) {
          EXPECT_EQ(result.rows[0].q, *problem.start);
          ++starts;
        }
        for (std::size_t k = 0; k < result.rows.size(); ++k) {
          EXPECT_EQ(result.rows[k].s, found.trajectory[k].s);
          EXPECT_TRUE(result.from_second_seed || result.rows[k].branch == found.trajectory[k].branch);
          EXPECT_TRUE(result.refined || result.rows[k].q == found.trajectory[k].q);
          if (k > 0) turns += result.rows[k].s == result.rows[k - 1].s;
        }
        refined += result.refined;
        cheaper += result.cost < result.cost_before - 1e-6;
        seconds += result.from_second_seed;
        metrics.insert(problem.cost.metric);
        sum += result.cost / result.cost_before;
        // Again the same.
        const Refined again = refine(robot, problem, found.trajectory);
        for (std::size_t k = 0; k < result.rows.size(); ++k) EXPECT_EQ(again.rows[k].q, result.rows[k].q);
      });
  std::printf(
      "%d solved, %d refined, %d cheaper, %d with start, %d turning steps, %d from the second seed; mean cost %.4f of before\n",
      solved, refined, cheaper, starts, turns, seconds, sum / solved);
  EXPECT_GE(solved, 12);
  EXPECT_GE(cheaper, solved / 2);
  EXPECT_GT(starts, 0);
  EXPECT_GT(turns, 0);
  EXPECT_EQ(metrics.size(), 3u);
}

TEST(Refine, RefusesRowsOfAnotherResolution) {
  const int solved = for_solved("Refine", 12, [&](const Problem& problem, const PreparedRobot& robot, const PlanResult& found) {
    Problem other = problem;
    other.resolution.ds /= 2;
    EXPECT_THROW(static_cast<void>(refine(robot, other, found.trajectory)), InvalidArgument);
    EXPECT_THROW(static_cast<void>(refine(robot, problem, found.trajectory, {}, Budget(1e-9))), Stopped);
  });
  EXPECT_GE(solved, 2);
}

TEST(Motion, PassesTheCheckOfMotions) {
  int timed = 0, not_executable = 0;
  std::size_t samples = 0;
  const int solved =
      for_solved("Motion", trials(40), [&](const Problem& problem, const PreparedRobot& robot, const PlanResult& found) {
        const Refined refined = refine(robot, problem, found.trajectory, {.second_seed = false});
        const TimingOptions options{.speed = 0.1, .turn_speed = 0.5, .rate = 250};
        const MotionResult result = time_trajectory(robot, problem, refined.rows, options);
        ASSERT_NE(result.motion.has_value(), result.failure.has_value());
        if (!result.motion) {
          ++not_executable;
          std::printf("%s at s = %.4f\n", result.failure->reason.c_str(), result.failure->s);
          return;
        }
        ++timed;
        samples += result.motion->rows.size();
        const CheckResult check = check_motion(robot, problem, result.motion->rows);
        EXPECT_TRUE(check.passed) << (check.failures.empty() ? "" : check.failures[0]);
        ASSERT_TRUE(check.motion);
        EXPECT_LE(check.motion->tool_speed, options.speed * 1.001);
        for (const auto& peak : check.motion->peaks) EXPECT_LE(peak.ratio, 1 + 1e-6);
        // What the motion says of itself is what the check finds.
        for (std::size_t order = 0; order < 3; ++order) {
          double most = 0;
          for (const auto& peak : result.motion->peaks[order]) most = std::max(most, peak.ratio);
          EXPECT_NEAR(most, check.motion->peaks[order].ratio, 1e-6);
        }
        // A tenth faster is too fast.
        auto fast = result.motion->rows;
        for (TimedRow& row : fast) row.t /= 1.1;
        const bool near_limit = check.motion->peaks[2].ratio > 0.8;
        EXPECT_TRUE(!near_limit || !check_motion(robot, problem, fast).passed);
      });
  std::printf("%d solved, %d timed, %d not executable, %zu samples\n", solved, timed, not_executable, samples);
  EXPECT_GE(timed, 10);
  EXPECT_LE(not_executable, solved / 3);
}

TEST(Motion, RefusesSpeedsThatMakeNoSense) {
  Random random(1);
  const Problem some = some_problem(data_robot("iiwa14"), random);
  const PreparedRobot robot(some);
  for (const TimingOptions& options :
       {TimingOptions{.speed = 0, .turn_speed = {}, .rate = 250},
        TimingOptions{.speed = std::nan(""), .turn_speed = {}, .rate = 250},
        TimingOptions{.speed = 0.1, .turn_speed = -1, .rate = 250}, TimingOptions{.speed = 0.1, .turn_speed = {}, .rate = 0}})
    EXPECT_THROW(static_cast<void>(time_trajectory(robot, some, {}, options)), InvalidArgument);
}

}  // namespace
}  // namespace swivel
