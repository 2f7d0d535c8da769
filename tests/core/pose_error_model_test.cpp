// SPDX-License-Identifier: BSD-3-Clause
// Bounds on how far rows of arms that are not exactly S-R-S place links from where their nodes
// place them, against the rows.
#include "swivel/core/kinematics/srs/pose_error_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "inexact_robots.hpp"
#include "seed.hpp"

namespace swivel {
namespace {

using namespace test;

Vector3d direction(Random& random) {
  return Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
}

/// Rows: linear, then angular velocity; that of the point `about` (base frame, m) of the tool.
Eigen::Matrix<double, 6, kDof> jacobian_about(const Chain& chain, const Config& q,
                                              const Vector3d& about) {
  auto J = chain.jacobian(q);
  const Vector3d from_tool = about - chain.tool(q).translation();
  for (int k = 0; k < kDof; ++k)
    J.block<3, 1>(0, k) += Vector3d(J.block<3, 1>(3, k)).cross(from_tool);
  return J;
}

/// A node of a branch, and the row of the exact chain that continues it, both rad.
struct Known {
  int branch;
  Config node, row;
};

/// Solves for the nodes and rows at a pose that share arm angle (rad) and elbow.
std::vector<Known> known_rows(const Chain& chain, const SrsArm& arm, const ArmPlane& plane,
                              const Pose& tool, double phi, int elbow) {
  const auto circles = elbow_circles(arm, plane, tool);
  std::vector<Known> all;
  for (const int branch :
       {elbow, elbow | kShoulderBit, elbow | kWristBit, elbow | kShoulderBit | kWristBit}) {
    const Config node = srs_ik(arm, circles, phi, branch);
    if (const auto row = solve_exact_chain(chain, arm, plane, tool, phi, node))
      all.push_back({branch, node, *row});
  }
  return all;
}

/// Counts rows and bounds, and keeps the largest share of a bound that was reached.
struct BoundCounts {
  int rows = 0, known = 0, unknown = 0;
  std::array<double, kDof + 1>
      closest{};  // [group] share of a bound that was reached; [0] of that on the Jacobian
};

/// Checks the bound on how the Jacobian differs between a node and every row that shares its elbow.
void check_jacobians(const Chain& chain, const PoseErrorModel& bounds, double reach,
                     const std::vector<Known>& all, const std::string& what, BoundCounts& counts) {
  for (const Known& here : all) {
    const double bound = bounds.jacobian_change(reach, here.node);
    const Vector3d about = chain.tool(here.node).translation();
    for (const Known& there : all) {
      Eigen::Matrix<double, 6, kDof> change = jacobian_about(chain, here.node, about);
      auto other = jacobian_about(chain, there.row, about);
      if ((here.branch ^ there.branch) & kShoulderBit) other.col(1) *= -1;
      if ((here.branch ^ there.branch) & kWristBit) other.col(5) *= -1;
      change -= other;
      ASSERT_LE(change.norm(), bound + 1e-9) << what;
      counts.closest[0] = std::max(counts.closest[0], change.norm() / bound);
    }
  }
}

/// Checks the bounds on how far rows place points of a group from where a node and its row place
/// them.
void check_group(const Chain& chain, const PoseErrorModel& bounds, double reach, int group,
                 const std::vector<Known>& all, const std::string& what, Random& random,
                 BoundCounts& counts) {
  const auto at = static_cast<std::size_t>(group);
  const int signs = group < 3 ? kShoulderBit : group == 5 || group == 6 ? kWristBit : 0;
  const double radius = random.uniform(0, 1);
  for (const Known& here : all) {
    const PoseErrorBound bound = bounds.from_node(group, reach, here.node);
    const PoseErrorBound apart = bounds.between_exact_configs(group, reach, here.node);
    ++(std::isfinite(bound.shift) ? counts.known : counts.unknown);
    if (!std::isfinite(bound.shift)) continue;
    for (const double r : {0.0, radius}) {
      const Vector3d x = bound.about + r * direction(random);
      const auto place = [&](const Config& q) { return Vector3d(chain.displacements(q)[at] * x); };
      for (const Known& there : all) {
        if ((here.branch ^ there.branch) & signs) continue;
        const double moved = (place(there.row) - place(here.node)).norm();
        ASSERT_LE(moved, bound.of(r) + 1e-9) << what << " group " << group;
        counts.closest[at] = std::max(counts.closest[at], moved / bound.of(r));
        ASSERT_LE((place(there.row) - place(here.row)).norm(), apart.of(r) + 1e-9)
            << what << " group " << group;
      }
    }
  }
}

/// Prints what was compared for a robot, with the bound of the forearm at 0.8 of the reach.
void print_counts(const std::string& robot, const SrsArm& arm, const PoseErrorModel& bounds,
                  const BoundCounts& counts) {
  Config middle;
  middle.setOnes();
  const PoseErrorBound forearm = bounds.from_node(4, 0.8 * (arm.upper + arm.fore), middle);
  std::printf(
      "%s: %d rows, %d bounds known, %d not; forearm at 0.8 of the reach %.2g mm + %.2g mrad; "
      "reached, of J and by links:",
      robot.c_str(), counts.rows, counts.known, counts.unknown, 1e3 * forearm.shift,
      1e3 * forearm.turn);
  for (const double share : counts.closest) std::printf(" %.2f", share);
  std::printf("\n");
}

/// Rows of all branches that share an elbow stand within the bound of every node at which the link
/// has the same pose.
TEST(PoseErrorModel, NoRowIsFurtherFromItsNodeOrFromOneThatStandsAlike) {
  const std::uint64_t base = seed("RowShift");
  Random random(base);
  for (const TestRobot& robot : inexact_robots(random)) {
    const Chain chain = arm_of(robot).chain;
    const SrsArm arm = fit_srs(chain, robot.name);
    const PoseErrorModel bounds(chain, arm);
    BoundCounts counts;
    const int count = trials(4000);
    for (int trial = 0; trial < count; ++trial) {
      const std::string what = robot.name + ", SWIVEL_TEST_SEED " + std::to_string(base) +
                               " trial " + std::to_string(trial);
      const Pose tool = chain.tool(random_config(chain, random));
      const ArmPlane plane = first_plane(arm, tool);
      if (reach_status(arm, plane.reach) != ReachStatus::kReachable) continue;
      const double phi = random.uniform(-kPi, kPi);
      const int elbow = random.coin() ? kElbowBit : 0;
      const std::vector<Known> all = known_rows(chain, arm, plane, tool, phi, elbow);
      counts.rows += static_cast<int>(all.size());
      check_jacobians(chain, bounds, plane.reach, all, what, counts);
      for (int group = 1; group <= kDof && !HasFatalFailure(); ++group)
        check_group(chain, bounds, plane.reach, group, all, what, random, counts);
      if (HasFatalFailure()) return;
    }
    print_counts(robot.name, arm, bounds, counts);
    EXPECT_GT(counts.rows, at_least(8000)) << robot.name;
    EXPECT_GT(counts.known, at_least(20000)) << robot.name;
    for (std::size_t group = 0; group <= kDof && count >= 4000;
         ++group)  // not so wide that they say nothing
      EXPECT_GT(counts.closest[group], 0.02) << robot.name << " group " << group;
  }
}

}  // namespace
}  // namespace swivel
