// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <optional>

#include "robots.hpp"

namespace swivel::test {

/// Returns a closed box of triangles, so that problems have meshes too.
inline MeshPtr box_mesh(const Vector3d& size) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->source = "box mesh";
  for (int corner = 0; corner < 8; ++corner)
    mesh->vertices.push_back(Vector3d(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1)
                                 .cwiseProduct(size / 2));
  mesh->triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  mesh->closed = is_closed(*mesh);
  return mesh;
}

inline Pose random_pose(Random& random, const Vector3d& center, double spread) {
  Pose pose;
  pose.translation() = center + spread * Vector3d(random.uniform(-1, 1), random.uniform(-1, 1),
                                                  random.uniform(-1, 1));
  pose.linear() = Quaterniond(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1),
                              random.uniform(-1, 1))
                      .normalized()
                      .toRotationMatrix();
  return pose;
}

/// The steps of random_problem().
namespace problem_parts {

/// Draws waypoints near posture `q`, the first of them the pose of the tool there. Returns the
/// length of the path, m.
inline double draw_waypoints(PathProblem& problem, const Chain& chain, Config q, int waypoints,
                             Random& random) {
  problem.waypoints.push_back(waypoint_of(chain.tool(q)));
  double length = 0;
  for (int k = 1; k < waypoints; ++k) {
    for (int j = 0; j < kDof; ++j) q[j] += random.uniform(-0.2, 0.2);
    problem.waypoints.push_back(waypoint_of(chain.tool(q)));
    length += (problem.waypoints.back().position -
               problem.waypoints[static_cast<std::size_t>(k) - 1].position)
                  .norm();
  }
  return length;
}

/// Draws obstacles near the first waypoint and near the axis of joint 5 at posture `q0`.
inline void draw_obstacles(PathProblem& problem, const Chain& chain, const Config& q0,
                           int obstacles, Random& random) {
  const Vector3d near = chain.displacements(q0)[4] * chain.point[4];
  for (int k = 0; k < obstacles; ++k) {
    SceneObject object;
    object.name = "obstacle" + std::to_string(k);
    object.pose = random_pose(random, k % 2 ? near : Vector3d(problem.waypoints[0].position), 0.35);
    const double size = random.uniform(0.02, 0.15);
    switch (random.below(5)) {
      case 0:
        object.shape = Sphere{size};
        break;
      case 1:
        object.shape = Box{Vector3d(size, 2 * size, size)};
        break;
      case 2:
        object.shape = Cylinder{size / 2, 3 * size};
        break;
      case 3:
        object.shape = Capsule{size / 2, 2 * size};
        break;
      default:
        object.shape = box_mesh(Vector3d(size, size, 2 * size));
    }
    problem.scene.push_back(object);
  }
}

/// Draws limits. The slope of the arm angle is drawn relative to problem.resolution.
inline void draw_limits(PathProblem& problem, Random& random) {
  Limits& limits = problem.limits;
  limits.arm_slope = random.uniform(0.8, 3.2) * problem.resolution.dphi / problem.resolution.ds;
  limits.joint_step = random.uniform(0.4, 1.2);
  limits.clearance = random.coin() ? 0.005 : random.uniform(0, 0.03);
  limits.tool_path_error =
      random.coin() ? std::optional<double>(random.uniform(0.005, 0.05)) : std::nullopt;
  if (random.coin(0.2)) limits.tool_angle_error = random.uniform(0.02, 0.2);
  if (random.coin(0.2)) limits.step_error = random.uniform(0.05, 0.5);
  if (random.coin(0.3)) limits.manipulability = random.uniform(0, 0.03);
  if (random.coin(0.3)) limits.joint_margin = random.uniform(0, 0.1);
  limits.edges = random.coin(0.4) ? EdgeMode::kContinuous : EdgeMode::kNodes;
  limits.edge_tolerance = 0.005;  // fewer midpoints: small problems have large steps
}

/// Starts the path at posture `q0` where the joints' limits and margins allow it.
inline void start_at(PathProblem& problem, const Chain& chain, const Config& q0) {
  const Limits& limits = problem.limits;
  bool fits = true;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    fits = fits && (limit.continuous || (q0[j] >= limit.lower + limits.joint_margin &&
                                         q0[j] <= limit.upper - limits.joint_margin));
  }
  if (fits) problem.start = q0;
}

}  // namespace problem_parts

/// Draws a small problem of the robot: a path of 2 to 4 waypoints near one posture, obstacles near
/// the arm, random limits, both edge modes, with and without a start. Small enough for brute force
/// over all pairs of nodes.
inline PathProblem random_problem(const TestRobot& robot, Random& random) {
  PathProblem problem = problem_for(robot);
  const Chain chain = arm_of(robot).chain;
  const Config q0 = random_config(chain, random);
  const int waypoints = 2 + random.below(3);
  const double length = problem_parts::draw_waypoints(problem, chain, q0, waypoints, random);
  const int obstacles = random.below(5);
  problem_parts::draw_obstacles(problem, chain, q0, obstacles, random);
  problem.resolution.ds = std::max(0.01, length / (3 + random.below(5)));
  problem.resolution.dphi =
      robot.name == "windings" ? random.uniform(0.5, 0.9) : random.uniform(0.25, 0.6);
  problem.resolution.dalpha = random.uniform(0.2, 1);
  problem_parts::draw_limits(problem, random);
  if (random.coin(0.3)) problem.cost.metric = random.one_of({CostMetric::kL1, CostMetric::kMax});
  if (random.coin(0.3))
    for (double& weight : problem.cost.weights.emplace()) weight = random.uniform(0, 2);
  if (random.coin(0.4)) problem_parts::start_at(problem, chain, q0);
  problem.resolution.arcs = (waypoints + obstacles) % 2 == 1;
  return problem;
}

}  // namespace swivel::test
