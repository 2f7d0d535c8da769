// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "brute_force.hpp"
#include "inexact_robots.hpp"
#include "random_problem.hpp"
#include "robots.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "window.hpp"

namespace swivel::test {

/// What a layer's nodes are: arm angles, points on arcs of self-motion of seven joints or of six
/// and the roll.
enum class RingNodes { kArmAngles, kArcs, kSixJoints };

struct RingArm {
  TestRobot robot;
  RingNodes nodes;
};

inline TestRobot ring_at_flange(const char* name) {
  TestRobot robot = data_robot(name);
  robot.tip_link = "flange";
  return robot;
}

/// Arms with limits, without, of several turns, exactly S-R-S, nearly and not at all.
inline std::vector<RingArm> ring_arms(Random& random) {
  std::vector<RingArm> arms;
  for (const TestRobot& robot : all_robots()) arms.push_back({robot, RingNodes::kArmAngles});
  arms.push_back({windings_robot(), RingNodes::kArmAngles});
  arms.push_back({perturbed(data_robot("iiwa14"), 1, random), RingNodes::kArmAngles});
  const TestRobot turns = with_limits(ring_at_flange("xarm7_like"), [](int number, Joint& joint) {
    if (number % 2 == 0) joint.upper = number < 4 ? 3.1 : kTwoPi, joint.lower = -joint.upper;
  });
  for (const TestRobot& robot : {ring_at_flange("panda_like"), ring_at_flange("gen3_like"), turns})
    arms.push_back({robot, RingNodes::kArcs});
  arms.push_back({ring_at_flange("kr6_like"), RingNodes::kSixJoints});
  return arms;
}

inline void keep_ring_inside(const Chain& chain, Config& q) {
  constexpr double kInside = 0.12;  // rad, more than any joint margin
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    if (!limit.continuous) q[j] = std::clamp(q[j], limit.lower + kInside, limit.upper - kInside);
  }
}

/// Sets how fine the lattice is, and limits that suit it; `coarse`: never fine.
inline void draw_ring_lattice(PathProblem& problem, RingNodes nodes, double length, bool coarse,
                              Random& random) {
  Resolution& resolution = problem.resolution;
  resolution.ds = std::max(0.01, length / (4 + random.below(4)));
  resolution.dalpha = random.uniform(0.3, 0.8);
  resolution.dphi = problem.source == "windings" ? 0.9 : random.uniform(0.3, 0.6);
  resolution.arc = random.uniform(0.3, 0.6);
  problem_parts::draw_limits(problem, random);
  Limits& limits = problem.limits;
  // Where nodes lie close together and joints weigh unlike, the cheapest open path drifts.
  const bool unlike = random.coin(), fine = unlike && !coarse;
  if (unlike)
    for (double& weight : problem.cost.weights.emplace()) weight = random.uniform(0.05, 2);
  if (nodes == RingNodes::kArmAngles) {
    resolution.arcs = random.coin();
    if (fine && problem.source != "windings") {
      resolution.dphi = random.uniform(0.06, 0.12);
      limits.arm_slope = Limits().arm_slope;
    }
    return;
  }
  if (fine) resolution.arc = random.uniform(0.1, 0.2);
  if (coarse) *resolution.arc *= 1.5, resolution.dalpha = random.uniform(0.7, 1);
  limits.step_error.reset();
  if (limits.tool_path_error) limits.tool_path_error = random.uniform(0.02, 0.1);
  if (limits.tool_angle_error) limits.tool_angle_error = random.uniform(0.1, 0.4);
  limits.joint_step = 1;
  limits.arm_slope = Limits().arm_slope;
  limits.roll_slope = random.uniform(5, 15);
}

/// Draws a closed path of two to four sides through tool poses of postures near each other, some
/// with obstacles. A ring of `spins` has three sides, along which the last joint turns once, that
/// before a roll.
inline PathProblem ring_problem(const RingArm& arm, Random& random, bool spins = false) {
  PathProblem problem = problem_for(arm.robot);
  if (arm.nodes == RingNodes::kSixJoints)
    problem.roll = random.coin() ? Roll{} : Roll{random.uniform(-2, -0.5), random.uniform(0.5, 2)};
  const Chain chain =
      build_arm(*problem.model, problem.base_link, problem.tip_link, {}, problem.tool, problem.roll)
          .chain;
  Config q = random_config(chain, random);
  if (chain.roll) q[kDof - 1] = random.uniform(-0.2, 0.2);
  keep_ring_inside(chain, q);
  problem.waypoints.push_back(waypoint_of(chain.tool(q)));
  const int last = chain.roll ? kDof - 2 : kDof - 1, sides = spins ? 3 : 2 + random.below(3);
  for (int side = 1; side < sides; ++side) {
    for (int j = 0; j < kDof; ++j) q[j] += random.uniform(-0.2, 0.2);
    keep_ring_inside(chain, q);
    Config turned = q;
    if (spins) turned[last] += kTwoPi * side / sides;
    problem.waypoints.push_back(waypoint_of(chain.tool(turned)));
  }
  problem.waypoints.push_back(problem.waypoints.front());
  Quaterniond& orientation = problem.waypoints.back().orientation;
  if (random.coin()) orientation.coeffs() = -orientation.coeffs();  // the same rotation
  if (random.coin()) problem.waypoints.back().position.x() += 5e-7;
  problem.closed = true;
  double length = 0;
  for (std::size_t k = 1; k < problem.waypoints.size(); ++k)
    length += (problem.waypoints[k].position - problem.waypoints[k - 1].position).norm();
  if (random.coin(0.6))
    problem_parts::draw_obstacles(problem, chain, q, 1 + random.below(3), random);
  draw_ring_lattice(problem, arm.nodes, length, spins, random);
  if (random.coin(0.3)) problem.cost.metric = random.one_of({CostMetric::kL1, CostMetric::kMax});
  if (problem.roll && random.coin()) problem.cost.roll = random.uniform(0.2, 5);
  return problem;
}

/// Draws a ring whose lattice is coarse, so that brute force is quick. Most are asked about their
/// nodes alone.
inline PathProblem coarse_ring(const RingArm& arm, Random& random, bool spins) {
  PathProblem ring = ring_problem(arm, random, spins);
  ring.resolution.dphi = std::max(ring.resolution.dphi, 0.45);
  ring.resolution.arc = std::max(ring.resolution.arc.value_or(0), 0.4);
  if (arm.nodes == RingNodes::kArmAngles)
    ring.limits.arm_slope = std::max(ring.limits.arm_slope, 60.0);
  if (random.coin(0.7)) ring.limits.edges = EdgeMode::kNodes;
  return ring;
}

/// The lattice of a ring, no bounded joint of which is a circle, and its answer by brute force over
/// all starts.
struct RingTruth {
  std::unique_ptr<const Lattice> lattice;
  BruteForcePath open;
  int start = -1;  // the slot in which the answer begins; -1 where no path closes
  double cost = std::numeric_limits<double>::infinity();
};

inline RingTruth ring_truth(const PreparedRobot& robot, const World& world, const ToolPath& path,
                            const PathProblem& problem, RingNodes nodes) {
  const Chain& chain = robot.arm().chain;
  RingTruth truth;
  std::function<bool(int, int, int)> in_window;
  if (nodes == RingNodes::kArmAngles) {
    auto lattice = std::make_unique<SrsLattice>(chain, robot.srs(), path, problem);
    in_window = [grid = lattice.get()](int layer, int a, int b) {
      return window_allows(*grid, layer, a, b);
    };
    truth.lattice = std::move(lattice);
  } else {
    const ArcLattice circles(chain, robot.arm_class().lock, path, problem);
    truth.lattice = circles.with_windings(circles.circles());
    in_window = [&, lattice = truth.lattice.get()](int layer, int a, int b) {
      const double turn =
          (*lattice->node(layer + 1, b))[kDof - 1] - (*lattice->node(layer, a))[kDof - 1];
      return nodes == RingNodes::kArcs ||
             std::abs(std::remainder(turn, kTwoPi)) <=
                 roll_step_bound(path, layer, problem.limits, problem.resolution);
    };
  }
  const Lattice& lattice = *truth.lattice;
  truth.open = brute_force(lattice, world, world.edge_rule(robot.radii()), in_window);
  truth.start = first_of_answer(lattice, truth.open.closed_costs,
                                [&](int slot) { return *lattice.node(0, slot); });
  if (truth.start >= 0) truth.cost = truth.open.closed_costs[static_cast<std::size_t>(truth.start)];
  return truth;
}

}  // namespace swivel::test
