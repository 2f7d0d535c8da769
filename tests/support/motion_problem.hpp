// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "inner_posture.hpp"

namespace swivel::test {

/// Draws a problem of two to four segments from a posture well inside the limits, with a ball near
/// the arm, and sometimes with a start, a turn on the spot or a metric other than l2. `roll`: of
/// the tool, for an arm of six joints.
inline PathProblem motion_problem(const TestRobot& robot, Random& random,
                                  const std::optional<Roll>& roll = {}) {
  PathProblem problem = problem_for(robot);
  problem.roll = roll;
  const Chain chain =
      build_arm(*robot.model, robot.base_link, robot.tip_link, {}, Pose::Identity(), roll).chain;
  const Config q = inner_posture(chain, random);
  problem.waypoints.push_back(waypoint_of(chain.tool(q)));
  const int more = 2 + random.below(3),
            on_the_spot = random.below(3) == 0 ? random.below(more) : -1;
  for (int k = 0; k < more; ++k) {
    Waypoint to = problem.waypoints.back();
    if (k != on_the_spot) to.position += random_vector(random, random.uniform(0.04, 0.1));
    const Vector3d turn = random_vector(random, random.uniform(0.05, 0.4));
    to.orientation =
        to.orientation * Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    problem.waypoints.push_back(to);
  }
  problem.resolution = {.ds = 0.01, .dphi = 0.1, .dalpha = 0.1};
  problem.limits.clearance = 0.003;
  Pose ball = Pose::Identity();
  ball.translation() = problem.waypoints[1].position + random_vector(random, 0.18);
  problem.scene.push_back({"ball", Sphere{0.04}, ball, {}});
  if (random.coin(0.3)) problem.start = q;
  if (random.coin(0.3))
    problem.cost.metric = random.one_of({CostMetric::kL1, CostMetric::kMax, CostMetric::kTime});
  problem.smooth = PathSmoothing{};
  return problem;
}

}  // namespace swivel::test
