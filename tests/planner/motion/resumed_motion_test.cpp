// SPDX-License-Identifier: BSD-3-Clause
// Motions that go on from where one was stopped, and motions around closed paths.
#include <gtest/gtest.h>

#include <string>

#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

Problem coarse(const std::string& name) {
  std::string file = SWIVEL_DATA_DIR;
  file += "/problems/" + name + ".yaml";
  Problem problem = io::load_problem(file);
  problem.resolution.ds = 0.02;
  problem.resolution.dphi = 0.2;
  problem.resolution.arc = 0.35;
  problem.limits.tool_path_error = 0.005;
  return problem;
}

MotionPlan moved(const Problem& problem) {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.threads = 1;
  Planner planner(with_motion_defaults(problem));
  return plan_motion(planner, options, false,
                     TimingOptions{.speed = 0.1, .turn_speed = {}, .rate = 50});
}

/// Expects a motion that begins where the problem's start is, and that the check passes.
void expect_motion_from_start(const Problem& problem, double whole) {
  const MotionPlan rest = moved(problem);
  ASSERT_EQ(rest.result.status, PlanStatus::kSolved);
  ASSERT_TRUE(rest.motion->motion) << rest.motion->failure->reason;
  const TimedPath& motion = *rest.motion->motion;
  EXPECT_NEAR(motion.rows.front().row.s, *problem.start_at, 1e-9);
  EXPECT_LE((motion.rows.front().row.q - *problem.start).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT(motion.duration, whole);
  EXPECT_LT(motion.ideal, whole);
  const PreparedRobot robot(problem);
  const CheckResult check = check_motion(robot, with_motion_defaults(problem), motion.rows);
  EXPECT_TRUE(check.passed) << check.failures.front();
}

TEST(ResumedMotion, BeginsWhereTheStartIs) {
  for (const char* name : {"experiment_a", "panda_weld_seam", "kr6_weld_pipe", "ur10e_rail_seam",
                           "xarm7_polish_raster", "torch_door"}) {
    SCOPED_TRACE(name);
    const Problem problem = coarse(name);
    const MotionPlan whole = moved(problem);
    ASSERT_EQ(whole.result.status, PlanStatus::kSolved);
    ASSERT_TRUE(whole.motion->motion) << whole.motion->failure->reason;
    const double duration = whole.motion->motion->duration;
    Problem rest = problem;
    const TrajectoryRow& layer = whole.result.trajectory[whole.result.trajectory.size() / 2];
    rest.start = layer.q;
    rest.start_at = layer.s;
    expect_motion_from_start(rest, duration);
  }
}

TEST(ClosedMotion, EndsAtTheArmAngleOfItsBeginning) {
  for (int k = 0; k < 8; ++k) {
    SCOPED_TRACE(k);
    Problem problem = coarse("experiment_a");
    const Waypoint first = problem.waypoints[0];
    const Vector3d along(0.01 + 0.002 * k, 0.05, 0.03), across(0.01, 0.01, 0.04 + 0.003 * k);
    problem.waypoints.assign(5, first);
    for (std::size_t w = 1; w < 4; ++w)
      problem.waypoints[w].position += (w < 3) * along + (w > 1) * across;
    problem.closed = true;
    const MotionPlan plan = moved(problem);
    ASSERT_EQ(plan.result.status, PlanStatus::kSolved);
    ASSERT_TRUE(plan.motion->motion) << plan.motion->failure->reason;
    const std::vector<TimedRow>& rows = plan.motion->motion->rows;
    EXPECT_NEAR(rows.back().row.phi, rows.front().row.phi, 1e-6);
    const PreparedRobot robot(problem);
    const CheckResult check = check_motion(robot, with_motion_defaults(problem), rows);
    EXPECT_TRUE(check.passed) << check.failures.front();
  }
}

}  // namespace
}  // namespace swivel
