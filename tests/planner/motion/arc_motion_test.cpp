// SPDX-License-Identifier: BSD-3-Clause
// Refined paths and motions in time of arms without an arm angle, and of arms of six joints whose
// tool may turn, held against the check that knows nothing of either.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "axes_robots.hpp"
#include "motion_problem.hpp"
#include "roll_windows.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

struct Arm {
  TestRobot robot;
  std::optional<Roll> roll;
};
std::vector<Arm> arms() {
  const auto of_data = [](const char* name) {
    TestRobot robot = data_robot(name);
    robot.tip_link = "flange";
    return robot;
  };
  std::vector<Arm> all{{of_data("panda_like"), {}},
                       {of_data("xarm7_like"), {}},
                       {of_data("gen3_like"), {}},
                       {of_data("fetch_like"), {}},
                       {offset_robot(), {}},
                       {of_data("kr6_like"), Roll{}},
                       {of_data("kr6_like"), Roll{-1.5, 1.5}},
                       {of_data("ur5e_like"), Roll{-0.8, 0.8}}};
  for (const TestRobot& robot : slide_robots()) all.push_back({robot, {}});
  return all;
}

double most_deviation(const Chain& chain, const ToolPath& path,
                      const std::vector<TrajectoryRow>& rows) {
  double most = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const PathLayer& layer = path.layer(static_cast<int>(i));
    const Config q = counted_from_path(chain, path, layer.travel, rows[i]).q;
    most = std::max(most, (chain.tool(q).matrix() - layer.tool.matrix()).norm());
  }
  return most;
}

std::string first_of(const CheckResult& check) {
  return check.failures.empty() ? "" : check.failures[0];
}

/// Counts the problems of one arm.
struct ArmCounts {
  int solved = 0, executable = 0, refined = 0;
  std::map<std::string, int> reasons;  ///< why motions are refused, and how often
};

/// Counts the problems of all arms.
struct MotionCounts {
  int within_windows = 0, solved = 0, executable = 0, refined = 0, cheaper = 0, starts = 0,
      samples = 0, mean_of = 0;
  double mean = 0;             ///< the sum of the costs of refined paths over those before
  std::vector<double> slower;  ///< durations over ideal ones
};

/// A random problem of an arm and how its motion is timed.
struct MotionTask {
  PathProblem problem;
  bool windows = false;  ///< whether the waypoints have windows of roll
  std::string what;
  TimingOptions timing;
};

/// Draws a problem of the arm, its cost of roll and windows of roll, and speeds of its motion.
MotionTask random_motion_task(const Arm& arm, int trial, Random& random) {
  MotionTask task;
  PathProblem& problem = task.problem;
  problem = with_motion_defaults(motion_problem(arm.robot, random, arm.roll));
  if (problem.roll) problem.limits.roll_slope = random.uniform(3, 20);
  if (problem.roll && random.coin()) problem.cost.roll = random.uniform(0.5, 20);
  task.windows = problem.roll && !problem.roll->circle() && random.coin();
  if (task.windows) draw_windows(problem, random, problem.start ? (*problem.start)[kDof - 1] : 0.0);
  task.what = problem.source + " trial " + std::to_string(trial);
  task.timing = TimingOptions{.speed = random.coin() ? 0.05 : 0.2,
                              .turn_speed = 0.5,
                              .rate = random.coin() ? 250.0 : 1000.0};
  return task;
}

/// Expects the refined path to be no dearer than the one before and to pass the check of rows.
void expect_refined_path(const MotionTask& task, const PreparedRobot& robot, const Refined& path,
                         ArmCounts& of_arm, MotionCounts& counts) {
  const PathProblem& problem = task.problem;
  const std::string& what = task.what;
  const Chain& chain = robot.arm().chain;
  EXPECT_LE(path.cost, path.cost_before) << what;
  EXPECT_NE(path.refined, !path.reason.empty()) << what;
  EXPECT_LE(most_deviation(chain, problem_path(problem, chain), path.rows), 1e-8) << what;
  const CheckResult rows = check_trajectory(robot, problem, path.rows);
  EXPECT_TRUE(rows.passed) << what << ": " << first_of(rows);
  EXPECT_NEAR(rows.cost, path.cost, 1e-6) << what;
  if (problem.start) {
    EXPECT_EQ(path.rows[0].q, *problem.start) << what;
    ++counts.starts;
  }
  of_arm.refined += path.refined;
  counts.within_windows += path.refined && task.windows;
  counts.cheaper += path.cost < path.cost_before - 1e-6;
  counts.mean += path.cost_before > 0 ? path.cost / path.cost_before : 1;
  ++counts.mean_of;
}

/// Expects the motion in time to pass the check of motions and to begin at the start.
void expect_executable(const MotionTask& task, const PreparedRobot& robot, const TimedPath& motion,
                       MotionCounts& counts) {
  const PathProblem& problem = task.problem;
  const std::string& what = task.what;
  counts.samples += static_cast<int>(motion.rows.size());
  counts.slower.push_back(motion.duration / motion.ideal);
  const CheckResult check = check_motion(robot, problem, motion.rows);
  EXPECT_TRUE(check.passed) << what << ": " << first_of(check);
  ASSERT_TRUE(check.motion) << what;
  for (const auto& peak : check.motion->peaks) EXPECT_LE(peak.ratio, 1 + 1e-6) << what;
  if (problem.start) {
    EXPECT_LE((motion.rows[0].row.q - *problem.start).lpNorm<Eigen::Infinity>(), 1e-8) << what;
  }
  if (!robot.arm().chain.roll) return;
  for (const TimedRow& row : motion.rows) EXPECT_EQ(row.row.phi, row.row.q[kDof - 1]) << what;
}

/// Plans, refines and times one problem, and checks the path and its motion.
void check_task(const MotionTask& task, ArmCounts& of_arm, MotionCounts& counts) {
  const std::string& what = task.what;
  Planner planner(task.problem);
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  const MotionPlan plan = plan_motion(planner, options, true, task.timing);
  if (plan.result.status != PlanStatus::kSolved) return;
  ++of_arm.solved;
  ASSERT_TRUE(plan.refinement && plan.motion) << what;
  const PreparedRobot robot(task.problem);
  expect_refined_path(task, robot, *plan.refinement, of_arm, counts);
  ASSERT_NE(plan.motion->motion.has_value(), plan.motion->failure.has_value()) << what;
  if (!plan.motion->motion) {
    EXPECT_FALSE(plan.motion->failure->reason.empty()) << what;
    ++of_arm.reasons[plan.motion->failure->reason];
    return;
  }
  ++of_arm.executable;
  expect_executable(task, robot, *plan.motion->motion, counts);
}

/// Prints the counts of one arm and adds them to those of all arms.
void add_arm(const std::string& name, const ArmCounts& of_arm, int count, MotionCounts& counts) {
  std::printf("%s: %d of %d solved, %d refined, %d executable\n", name.c_str(), of_arm.solved,
              count, of_arm.refined, of_arm.executable);
  for (const auto& [reason, times] : of_arm.reasons)
    std::printf("  %d refused: %s\n", times, reason.c_str());
  EXPECT_GE(of_arm.solved, at_least(1)) << name;
  counts.solved += of_arm.solved;
  counts.executable += of_arm.executable;
  counts.refined += of_arm.refined;
}

/// What is executable is right, and what is refused has a reason: random problems of every arm,
/// planned, refined and timed.
TEST(ArcMotions, ArePassedByTheCheckOrRefused) {
  const std::uint64_t base = seed("ArcMotions");
  const std::vector<Arm> all = arms();
  const int count = trials(12);
  MotionCounts counts;
  for (std::size_t which = 0; which < all.size(); ++which) {
    ArmCounts of_arm;
    for (int trial = 0; trial < count; ++trial) {
      Random random(base + static_cast<std::uint64_t>(trial) * all.size() + which);
      check_task(random_motion_task(all[which], trial, random), of_arm, counts);
      if (HasFatalFailure()) return;
    }
    add_arm(all[which].robot.name, of_arm, count, counts);
  }
  std::vector<double>& slower = counts.slower;
  std::sort(slower.begin(), slower.end());
  ASSERT_FALSE(slower.empty());
  std::printf(
      "in all %d solved (%d with a start), %d refined, %d cheaper, mean cost %.4f of before; %d "
      "executable, %d samples, "
      "duration over ideal %.3f in the median and %.3f at the 95th percentile\n",
      counts.solved, counts.starts, counts.refined, counts.cheaper, counts.mean / counts.mean_of,
      counts.executable, counts.samples, slower[slower.size() / 2],
      slower[slower.size() * 95 / 100]);
  EXPECT_GE(counts.refined, at_least_among(counts.solved * 3 / 5));
  EXPECT_GE(counts.cheaper, at_least_among(counts.solved / 2));
  EXPECT_GE(counts.executable, at_least_among(counts.solved * 9 / 10));
  EXPECT_GE(counts.starts, at_least(3));
  std::printf("%d refined within windows of roll\n", counts.within_windows);
  EXPECT_GE(counts.within_windows, at_least(1));
}

}  // namespace
}  // namespace swivel
