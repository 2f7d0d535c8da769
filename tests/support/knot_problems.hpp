// SPDX-License-Identifier: BSD-3-Clause
// Random problems whose lattices have knots.
#pragma once
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "random_problem.hpp"
#include "robots.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel::test {

inline constexpr double kNone = std::numeric_limits<double>::infinity();

/// Arms whose joints turn less than once, or for ever, so that no lattice tells turns apart.
inline std::vector<TestRobot> arms_of_one_turn() {
  std::vector<TestRobot> robots;
  for (const char* const name : {"panda_like", "gen3_like", "fetch_like", "iiwa14"}) {
    robots.push_back(data_robot(name));
    if (robots.back().name != "iiwa14") robots.back().tip_link = "flange";
  }
  return robots;
}

/// A problem with a few knots, and layers between them. Bodies stand in the way of two thirds.
inline PathProblem random_task(const TestRobot& robot, Random& random) {
  PathProblem problem = random_problem(robot, random);
  problem.limits.step_error.reset();
  problem.resolution.arcs = false;
  problem.limits.arm_slope = Limits().arm_slope;
  if (has_arm_angle(robot))
    problem.resolution.dphi = random.uniform(0.7, 1.2);
  else
    problem.resolution.arc = random.uniform(0.3, 0.6);
  problem.limits.joint_step = random.uniform(0.08, 0.4);
  problem.limits.tool_path_error = std::exp(random.uniform(std::log(2e-4), std::log(2e-2)));
  problem.waypoints.resize(2);
  const double length = (problem.waypoints[1].position - problem.waypoints[0].position).norm();
  problem.resolution.ds = length / (4 + random.below(7));
  problem.resolution.dalpha = 0.5;
  problem.resolution.knot = problem.resolution.ds * (2 + random.below(4));
  return problem;
}

/// Adds small bodies that stand beside or in the arm where the best path without them is between
/// two knots.
inline void put_in_the_way(PathProblem& problem, Random& random) {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  const PlanResult free = plan(problem, options);
  if (free.status != PlanStatus::kSolved || free.trajectory.size() < 4) return;
  const Chain chain = PreparedRobot(problem).arm().chain;
  for (int body = 0; body < 1 + random.below(3); ++body) {
    const Config& q =
        free.trajectory[static_cast<std::size_t>(
                            1 + random.below(static_cast<int>(free.trajectory.size()) - 2))]
            .q;
    const auto k = static_cast<std::size_t>(2 + random.below(4));
    SceneObject object;
    object.name = "in_the_way_" + std::to_string(body);
    object.shape = Sphere{random.uniform(0.005, 0.02)};
    object.pose = random_pose(random, chain.displacements(q)[k] * chain.point[k], 0.1);
    problem.scene.push_back(object);
  }
}

}  // namespace swivel::test
