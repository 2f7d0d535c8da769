// SPDX-License-Identifier: BSD-3-Clause
// Refined paths and motions in time of arms without an arm angle, and of arms of six joints whose
// tool may turn, held against the check that knows nothing of either.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

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
  return {{of_data("panda_like"), {}},
          {of_data("xarm7_like"), {}},
          {of_data("gen3_like"), {}},
          {of_data("fetch_like"), {}},
          {offset_robot(), {}},
          {of_data("kr6_like"), Roll{}},
          {of_data("kr6_like"), Roll{-1.5, 1.5}},
          {of_data("ur5e_like"), Roll{-0.8, 0.8}}};
}

double most_deviation(const Chain& chain, const ToolPath& path,
                      const std::vector<TrajectoryRow>& rows) {
  double most = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    most = std::max(
        most,
        (chain.tool(rows[i].q).matrix() - path.layer(static_cast<int>(i)).tool.matrix()).norm());
  return most;
}

std::string first_of(const CheckResult& check) {
  return check.failures.empty() ? "" : check.failures[0];
}

/// What is executable is right, and what is refused has a reason: random problems of every arm,
/// planned, refined and timed.
TEST(ArcMotions, ArePassedByTheCheckOrRefused) {
  const std::uint64_t base = seed("ArcMotions");
  const std::vector<Arm> all = arms();
  const int count = trials(12);
  int within_windows = 0, solved_in_all = 0, executable_in_all = 0, refined_in_all = 0, cheaper = 0,
      starts = 0, samples = 0, mean_of = 0;
  double mean = 0;
  std::vector<double> slower;
  for (std::size_t which = 0; which < all.size(); ++which) {
    int solved = 0, executable = 0, refined = 0;
    std::map<std::string, int> reasons;
    for (int trial = 0; trial < count; ++trial) {
      Random random(base + static_cast<std::uint64_t>(trial) * all.size() + which);
      Problem problem =
          with_motion_defaults(motion_problem(all[which].robot, random, all[which].roll));
      if (problem.roll) problem.limits.roll_slope = random.uniform(3, 20);
      if (problem.roll && random.coin()) problem.cost.roll = random.uniform(0.5, 20);
      const bool windows = problem.roll && !problem.roll->circle() && random.coin();
      if (windows) draw_windows(problem, random, problem.start ? (*problem.start)[kDof - 1] : 0.0);
      const std::string what = problem.source + " trial " + std::to_string(trial);
      Planner planner(problem);
      PlanOptions options;
      options.planner = PlannerKind::kLazy;
      const TimingOptions timing{.speed = random.coin() ? 0.05 : 0.2,
                                 .turn_speed = 0.5,
                                 .rate = random.coin() ? 250.0 : 1000.0};
      const MotionPlan plan = plan_motion(planner, options, true, timing);
      if (plan.result.status != PlanStatus::kSolved) continue;
      ++solved;
      ASSERT_TRUE(plan.refinement && plan.motion) << what;
      const Refined& path = *plan.refinement;
      const PreparedRobot robot(problem);
      const Chain& chain = robot.arm().chain;
      EXPECT_LE(path.cost, path.cost_before) << what;
      EXPECT_NE(path.refined, !path.reason.empty()) << what;
      EXPECT_LE(most_deviation(chain, problem_path(problem, chain), path.rows), 1e-8) << what;
      const CheckResult rows = check_trajectory(robot, problem, path.rows);
      EXPECT_TRUE(rows.passed) << what << ": " << first_of(rows);
      EXPECT_NEAR(rows.cost, path.cost, 1e-6) << what;
      if (problem.start) {
        EXPECT_EQ(path.rows[0].q, *problem.start) << what;
        ++starts;
      }
      refined += path.refined;
      within_windows += path.refined && windows;
      cheaper += path.cost < path.cost_before - 1e-6;
      mean += path.cost_before > 0 ? path.cost / path.cost_before : 1;
      ++mean_of;
      ASSERT_NE(plan.motion->motion.has_value(), plan.motion->failure.has_value()) << what;
      if (!plan.motion->motion) {
        EXPECT_FALSE(plan.motion->failure->reason.empty()) << what;
        ++reasons[plan.motion->failure->reason];
        continue;
      }
      ++executable;
      const TimedPath& motion = *plan.motion->motion;
      samples += static_cast<int>(motion.rows.size());
      slower.push_back(motion.duration / motion.ideal);
      const CheckResult check = check_motion(robot, problem, motion.rows);
      EXPECT_TRUE(check.passed) << what << ": " << first_of(check);
      ASSERT_TRUE(check.motion) << what;
      for (const auto& peak : check.motion->peaks) EXPECT_LE(peak.ratio, 1 + 1e-6) << what;
      if (problem.start) {
        EXPECT_LE((motion.rows[0].row.q - *problem.start).lpNorm<Eigen::Infinity>(), 1e-8) << what;
      }
      if (!chain.roll) continue;
      for (const TimedRow& row : motion.rows) EXPECT_EQ(row.row.phi, row.row.q[kDof - 1]) << what;
    }
    std::printf("%s: %d of %d solved, %d refined, %d executable\n", all[which].robot.name.c_str(),
                solved, count, refined, executable);
    for (const auto& [reason, times] : reasons)
      std::printf("  %d refused: %s\n", times, reason.c_str());
    EXPECT_GE(solved, at_least(1)) << all[which].robot.name;
    solved_in_all += solved;
    executable_in_all += executable;
    refined_in_all += refined;
  }
  std::sort(slower.begin(), slower.end());
  ASSERT_FALSE(slower.empty());
  std::printf(
      "in all %d solved (%d with a start), %d refined, %d cheaper, mean cost %.4f of before; %d "
      "executable, %d samples, "
      "duration over ideal %.3f in the median and %.3f at the 95th percentile\n",
      solved_in_all, starts, refined_in_all, cheaper, mean / mean_of, executable_in_all, samples,
      slower[slower.size() / 2], slower[slower.size() * 95 / 100]);
  EXPECT_GE(refined_in_all, at_least(solved_in_all * 3 / 5));
  EXPECT_GE(cheaper, at_least(solved_in_all / 2));
  EXPECT_GE(executable_in_all, at_least(solved_in_all * 9 / 10));
  EXPECT_GE(starts, at_least(3));
  std::printf("%d refined within windows of roll\n", within_windows);
  EXPECT_GE(within_windows, at_least(1));
}

}  // namespace
}  // namespace swivel
