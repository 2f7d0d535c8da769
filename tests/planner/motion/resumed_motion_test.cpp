// SPDX-License-Identifier: BSD-3-Clause
// Motions that go on from where one was stopped, and motions around closed paths.
#include <gtest/gtest.h>

#include <string>

#include "random_problem.hpp"
#include "seed.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"
#include "swivel/planner/verify/complete_rows.hpp"

namespace swivel {
namespace {

PathProblem coarse(const std::string& name) {
  std::string file = SWIVEL_DATA_DIR;
  file += "/problems/" + name + ".yaml";
  PathProblem problem = io::load_path_problem(file);
  problem.resolution.ds = 0.02;
  problem.resolution.dphi = 0.2;
  problem.resolution.arc = 0.35;
  problem.limits.tool_path_error = 0.005;
  return problem;
}

const TimingOptions kTiming{.speed = 0.1, .turn_speed = {}, .rate = 50};

PlanResult solve(const PathProblem& problem) {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.threads = 1;
  return Planner(problem).plan(options);
}

MotionPlan moved(const PathProblem& problem) {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.threads = 1;
  Planner planner(with_motion_defaults(problem));
  return plan_motion(planner, options, false, kTiming);
}

/// Expects a motion that begins where the problem's start is, and that the check passes.
void expect_motion_from_start(const PathProblem& problem, double whole) {
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

constexpr const char* kKinds[] = {"experiment_a",    "panda_weld_seam",     "kr6_weld_pipe",
                                  "ur10e_rail_seam", "xarm7_polish_raster", "torch_door"};

TEST(ResumedMotion, BeginsWhereTheStartIs) {
  for (const char* name : kKinds) {
    SCOPED_TRACE(name);
    const PathProblem problem = coarse(name);
    const MotionPlan whole = moved(problem);
    ASSERT_EQ(whole.result.status, PlanStatus::kSolved);
    ASSERT_TRUE(whole.motion->motion) << whole.motion->failure->reason;
    const double duration = whole.motion->motion->duration;
    PathProblem rest = problem;
    const TrajectoryRow& layer = whole.result.trajectory[whole.result.trajectory.size() / 2];
    rest.start = layer.q;
    rest.start_at = layer.s;
    expect_motion_from_start(rest, duration);
  }
}

void expect_passes(const PreparedRobot& robot, const PathProblem& problem,
                   const std::vector<TimedRow>& rows) {
  EXPECT_LE((rows.front().row.q - *problem.start).cwiseAbs().maxCoeff(), 1e-7);
  const CheckResult check = check_motion(robot, problem, rows);
  EXPECT_TRUE(check.passed) << check.failures.front();
}

/// Expects that a path which goes on from a start does so in a motion: through planning with a
/// speed, and through timing of the rows of a plan, of a plan without a motion, and of the motion's
/// own. With `places`, rows that state their joints alone pass the check as well.
void expect_goes_on(const PathProblem& problem, bool places) {
  constexpr Stated kJointsAlone{.s = false, .phi = false, .branch = false, .roll = false};
  const PreparedRobot robot(problem);
  const MotionPlan rest = moved(problem);
  ASSERT_EQ(rest.result.status, PlanStatus::kSolved);
  ASSERT_TRUE(rest.motion->motion) << rest.motion->failure->reason;
  const std::vector<TimedRow>& rows = rest.motion->motion->rows;
  expect_passes(robot, problem, rows);
  if (places) expect_passes(robot, problem, complete_motion(robot, problem, rows, kJointsAlone));

  std::vector<TrajectoryRow> samples;
  for (const TimedRow& row : rows) samples.push_back(row.row);
  const PathProblem of_motions = with_motion_defaults(problem);
  std::vector<std::vector<TrajectoryRow>> plans{rest.result.trajectory,
                                                rows_at_layers(robot, of_motions, samples, {})};
  try {
    plans.push_back(solve(problem).trajectory);
  } catch (const InputError&) {  // a start on the rounded path that is not on the polyline
  }
  for (const std::vector<TrajectoryRow>& from : plans) {
    const MotionResult timed = time_trajectory(robot, problem, from, kTiming);
    ASSERT_TRUE(timed.motion) << timed.failure->reason;
    expect_passes(robot, problem, timed.motion->rows);
  }
}

TEST(ResumedMotion, GoesOnFromJointsBesideThePath) {
  const std::uint64_t base = test::seed("ResumedMotion.Beside");
  const int count = test::trials(8);
  int refused = 0;
  for (const char* name : kKinds) {
    const PathProblem problem = coarse(name);
    const MotionPlan whole = moved(problem);
    ASSERT_TRUE(whole.motion->motion);
    const std::vector<TimedRow>& rows = whole.motion->motion->rows;
    for (int trial = 0; trial < count; ++trial) {
      SCOPED_TRACE(std::string(name) + " SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                   std::to_string(trial));
      test::Random random(base + static_cast<std::uint64_t>(trial));
      auto row = static_cast<std::size_t>(random.below(static_cast<int>(rows.size()) - 2));
      const bool before_a_layer = trial % 4 == 3;
      if (before_a_layer) {
        const std::vector<TrajectoryRow>& layers = whole.result.trajectory;
        const double s =
            layers[static_cast<std::size_t>(1 + random.below(static_cast<int>(layers.size()) - 1))]
                .s;
        for (row = 0; rows[row + 1].row.s < s; ++row) {
        }
      }
      PathProblem rest = problem;
      rest.start_at = rows[row].row.s;
      rest.start = rows[row].row.q;
      if (trial % 4 > 0) rest.start_tolerance = 0.005;
      const double off = trial % 4 == 0 ? 1e-7 : trial % 4 == 1 ? 1e-5 : 1e-3;  // rad
      for (Eigen::Index j = 0; j < kDof; ++j) (*rest.start)[j] += off * random.uniform(-0.5, 0.5);
      try {
        // Right before a layer the tool may be further along the path than start_at says, so that
        // its joints alone do not tell its place.
        expect_goes_on(rest, !before_a_layer);
      } catch (const InputError& off_path) {
        std::printf("%s %d: %s\n", name, trial, off_path.what());
        ++refused;
      }
    }
  }
  EXPECT_LE(refused, count);
}

TEST(ResumedMotion, RefusesAStartThatIsOnlyOnTheCornerThatItRounds) {
  PathProblem problem = coarse("experiment_a");
  const Waypoint first = problem.waypoints[0];
  problem.waypoints.assign(3, first);
  problem.waypoints[1].position += Vector3d(0, 0.1, 0);
  problem.waypoints[2].position += Vector3d(0, 0.1, 0.1);
  const PlanResult whole = solve(problem);
  ASSERT_EQ(whole.status, PlanStatus::kSolved);
  problem.start = whole.trajectory[5].q;
  problem.start_at = whole.trajectory[5].s;
  const PlanResult rest = solve(problem);
  ASSERT_EQ(rest.status, PlanStatus::kSolved);
  EXPECT_THROW((void)time_trajectory(PreparedRobot(problem), problem, rest.trajectory, kTiming),
               InputError);
}

TEST(ClosedMotion, EndsAtTheArmAngleOfItsBeginning) {
  for (int k = 0; k < 8; ++k) {
    SCOPED_TRACE(k);
    PathProblem problem = coarse("experiment_a");
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
