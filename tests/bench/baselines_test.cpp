// SPDX-License-Identifier: BSD-3-Clause
// Experiments A and B of the paper: where the local methods stop, and that the planner does not.
#include "baselines.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <string>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"

namespace swivel::baselines {
namespace {

constexpr double kLength = 0.5;  // m, the line of A and B

PathProblem experiment(const std::string& name) {
  return io::load_path_problem(std::string(SWIVEL_DATA_DIR) + "/problems/" + name + ".yaml");
}

PlanOptions lazy() {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.evidence = Evidence::all();
  return options;
}

/// Every row is what a tracker promises: on the path, in the limits, clear, and near the row
/// before.
void expect_valid(const TrackResult& result, const PreparedRobot& robot,
                  const PathProblem& problem) {
  const Chain& chain = robot.arm().chain;
  const std::vector<Waypoint> line = waypoints_in_base(problem);
  const Vector3d along = (line[1].position - line[0].position).normalized();
  const World world(robot.world(), problem.scene);
  World::Query query(world);
  ASSERT_FALSE(result.rows.empty());
  double s = 0;
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    const Config& q = result.rows[i];
    const Pose tool = chain.tool(q);
    const Vector3d from_start = tool.translation() - line[0].position;
    s = from_start.dot(along);
    EXPECT_LT((from_start - s * along).norm(), 1e-6);
    EXPECT_LT((tool.linear() - line[0].orientation.toRotationMatrix()).norm(), 1e-6);
    EXPECT_FALSE(query.find_violating_pair(q, problem.limits.clearance)) << "row " << i;
    for (int j = 0; j < kDof; ++j) {
      EXPECT_GE(q[j], chain.limit[static_cast<std::size_t>(j)].lower - 1e-9);
      EXPECT_LE(q[j], chain.limit[static_cast<std::size_t>(j)].upper + 1e-9);
    }
  }
  EXPECT_NEAR(s, result.s, 1e-6);
}

TEST(Baselines, JacobianMeetsTheLimitOfJoint5InExperimentA) {
  const PathProblem problem = experiment("experiment_a_start");
  const PreparedRobot robot(problem);
  const TrackResult result = track_jacobian(robot, problem);
  EXPECT_EQ(result.reason, StopReason::kJointLimit);
  EXPECT_EQ(result.blocking, "arm_left_joint_5_r");
  EXPECT_FALSE(result.finished);
  EXPECT_GT(result.s, 0.45 * kLength);
  EXPECT_LT(result.s, 0.60 * kLength);
  expect_valid(result, robot, problem);
}

TEST(Baselines, JacobianHitsTheFirstBallInExperimentB) {
  const PathProblem problem = experiment("experiment_b");
  const PreparedRobot robot(problem);
  const TrackResult result = track_jacobian(robot, problem);
  EXPECT_EQ(result.reason, StopReason::kCollision);
  EXPECT_NE(result.blocking.find("ball_low"), std::string::npos) << result.blocking;
  EXPECT_GT(result.s, 0.25 * kLength);
  EXPECT_LT(result.s, 0.40 * kLength);
  expect_valid(result, robot, problem);
}

TEST(Baselines, NullSpaceEscapesTheFirstBallAndSticksBetweenBothInExperimentB) {
  PathProblem problem = experiment("experiment_b");
  const PreparedRobot robot(problem);
  const TrackResult jacobian = track_jacobian(robot, problem);
  const TrackResult result = track_null_space(robot, problem);
  EXPECT_EQ(result.reason, StopReason::kLocalMinimum);
  EXPECT_GT(result.s, jacobian.s + 0.05 * kLength);
  EXPECT_GT(result.s, 0.35 * kLength);
  EXPECT_LT(result.s, 0.60 * kLength);
  ASSERT_TRUE(result.projected_gradient && result.clearance);
  EXPECT_LE(*result.projected_gradient, TrackOptions{}.vanishing);
  EXPECT_LT(*result.clearance, problem.limits.clearance);
  EXPECT_LT(std::max(result.slopes[0], result.slopes[1]), 0) << "the clearance must fall both ways";
  expect_valid(result, robot, problem);

  // Clearances that are computed apart from the tracker: along the self-motion the clearance has a
  // peak where the tracker stopped.
  const Config self_motion =
      robot.arm().chain.jacobian(result.end).fullPivLu().kernel().col(0).normalized();
  const World world(robot.world(), problem.scene);
  World::Query query(world);
  const double peak = query.clearance(result.end)->distance;
  EXPECT_EQ(peak, *result.clearance);
  for (const double turn : {0.002, 0.005, 0.01, 0.02})
    for (const double sign : {1, -1})
      EXPECT_LT(query.clearance(result.end + sign * turn * self_motion)->distance, peak)
          << sign * turn;

  // The trap is made of both balls: each stands close to the arm there, and neither alone holds it.
  for (const SceneObject& object : experiment("experiment_b").scene) {
    problem.scene = {object};
    const World alone(robot.world(), problem.scene);
    EXPECT_LT(World::Query(alone).clearance(result.end)->distance,
              problem.limits.clearance + 0.0005)
        << object.name;
    EXPECT_TRUE(track_null_space(robot, problem).finished) << object.name;
  }
}

TEST(Baselines, TheTrapOfExperimentBDoesNotHangOnTheOptions) {
  const PathProblem problem = experiment("experiment_b");
  const PreparedRobot robot(problem);
  const double s = track_null_space(robot, problem).s;
  TrackOptions fine, weak, strong, wide, single;
  fine.step = 0.0005;
  weak.gain = 0.2;
  strong.gain = 2;
  single.pushes = 1;  // one per row, the formula as it stands
  wide.influence = 0.05;
  for (const TrackOptions& options : {fine, weak, strong, wide, single}) {
    const TrackResult result = track_null_space(robot, problem, options);
    EXPECT_EQ(result.reason, StopReason::kLocalMinimum);
    EXPECT_NEAR(result.s, s, 0.02 * kLength);
  }
}

TEST(Baselines, PlannerSolvesExperimentBFromTheSameStart) {
  const PathProblem problem = experiment("experiment_b");
  const PreparedRobot robot(problem);
  ASSERT_TRUE(problem.start);
  const PlanResult result = plan(robot, problem, lazy());
  ASSERT_EQ(result.status, PlanStatus::kSolved) << words(result.diagnosis->cause);
  EXPECT_EQ(result.trajectory.front().q, *problem.start);
  EXPECT_GE(result.min_clearance.value(), problem.limits.clearance);
  EXPECT_LE(result.tool_path_error_mm.max, 1.0);
}

TEST(Baselines, FinishWhereNothingIsInTheWay) {
  PathProblem problem = experiment("experiment_b");
  problem.scene.clear();
  const PreparedRobot robot(problem);
  for (const TrackResult& result :
       {track_jacobian(robot, problem), track_null_space(robot, problem)}) {
    EXPECT_TRUE(result.finished);
    EXPECT_EQ(result.reason, StopReason::kFinished);
    EXPECT_NEAR(result.s, kLength, 1e-9);
    expect_valid(result, robot, problem);
  }
}

TEST(Baselines, RefuseAMissingOrMisplacedStart) {
  PathProblem problem = experiment("experiment_b");
  const PreparedRobot robot(problem);
  (*problem.start)[0] += 1e-3;
  EXPECT_THROW((void)track_jacobian(robot, problem), InputError);
  problem.start.reset();
  EXPECT_THROW((void)track_null_space(robot, problem), InputError);
}

}  // namespace
}  // namespace swivel::baselines
