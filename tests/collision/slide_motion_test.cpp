// SPDX-License-Identifier: BSD-3-Clause
// Motions in which one joint slides and six turn: the bounds on how far bodies move, and motions
// that are proved free, sampled at 999 times.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "axes_robots.hpp"
#include "plain_edge_rule.hpp"
#include "random_problem.hpp"
#include "swivel/collision/world/world.hpp"

namespace swivel {
namespace {

using namespace test;

constexpr double kTau = 5e-5;  // m
constexpr int kTimes = 999;

/// Counts motions, and how near the worst came to its bound.
struct MotionCounts {
  int motions = 0, free = 0, blocked = 0, in_band = 0;
  double most_move = 0, most_bend = 0;
};

/// Expects every body's frame to stay within rule.motion() of where it began, and within
/// rule.tangent_deviation() of the tangent in the middle.
void expect_bounds(const Chain& chain, const World& world, const EdgeRule& rule, const Config& q0,
                   const Config& q1, MotionCounts& counts) {
  const Config middle = (q0 + q1) / 2, half = (q1 - q0) / 2;
  const double move = rule.motion(q0, q1), bend = rule.tangent_deviation(half);
  constexpr double kSmall = 1e-4;
  const auto before = chain.displacements(middle - kSmall * half), at = chain.displacements(middle),
             after = chain.displacements(middle + kSmall * half), start = chain.displacements(q0);
  for (int k = 0; k < kTimes; ++k) {
    const double t = -1 + 2.0 * k / (kTimes - 1);
    const auto G = chain.displacements(middle + t * half);
    for (const RobotBody& body : world.bodies()) {
      const auto g = static_cast<std::size_t>(body.group);
      if (body.group == 0) continue;
      const Vector3d p = body.pose.translation();
      const Vector3d velocity = (after[g] * p - before[g] * p) / (2 * kSmall);
      const double moved = (G[g] * p - start[g] * p).norm(),
                   bent = (G[g] * p - at[g] * p - t * velocity).norm();
      ASSERT_LE(moved, move * (t + 1) / 2 + 1e-12);
      ASSERT_LE(bent, bend + 1e-7);
      if (move > 1e-6) counts.most_move = std::max(counts.most_move, moved / move);
      if (bend > 1e-4) counts.most_bend = std::max(counts.most_bend, bent / bend);
    }
  }
}

/// Asks whether the motion is free, by the program's rule and by a plain test of every midpoint,
/// and samples it where it is.
void expect_verdict(World::Query& query, World::Query& plain, const EdgeRule& rule, double d_edge,
                    const Config& q0, const Config& q1, MotionCounts& counts) {
  const bool blocked = edge_blocked(query, rule, q0, q1).has_value(),
             plainly = edge_blocked_plain(plain, rule, q0, q1).has_value();
  ++(plainly ? counts.blocked : counts.free);
  counts.in_band += blocked != plainly;
  if (blocked) return;
  for (int k = 0; k < kTimes; ++k)
    ASSERT_FALSE(plain.find_violating_pair(q0 + k / (kTimes - 1.0) * (q1 - q0), d_edge - kTau))
        << k;
}

/// Motions of slides and turns mixed, among obstacles.
TEST(SlideMotion, BoundsHoldAtEveryTime) {
  const std::uint64_t base = seed("SlideMotion");
  const auto robots = slide_robots();
  MotionCounts counts;
  const int count = trials(2000);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const TestRobot& robot = robots[static_cast<std::size_t>(trial) % robots.size()];
    PathProblem problem = random_problem(robot, random);
    problem.limits.clearance = 0.01;
    problem.limits.edges = EdgeMode::kContinuous;
    const ArmModel arm = arm_of(robot);
    const World world(*robot.model, arm, problem);
    const EdgeRule rule = world.edge_rule(motion_radii(arm.chain, world.bodies()));
    World::Query query(world), plain(world, DistanceProofs::kOff);
    Config q0 = random_config(arm.chain, random), q1 = q0;
    const double d_edge = problem.limits.d_edge();
    for (int again = 0; again < 20 && plain.find_violating_pair(q0, d_edge); ++again)
      q0 = random_config(arm.chain, random);
    const double most = random.coin() ? 0.02 : 0.15;
    for (int j = 0; j < kDof; ++j) {
      const JointLimit& limit = arm.chain.limit[static_cast<std::size_t>(j)];
      q1[j] = q0[j] + random.uniform(-most, most);
      if (!limit.continuous) q1[j] = std::clamp(q1[j], limit.lower, limit.upper);
    }
    SCOPED_TRACE("SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                 " " + robot.name);
    expect_bounds(arm.chain, world, rule, q0, q1, counts);
    expect_verdict(query, plain, rule, d_edge, q0, q1, counts);
    if (HasFatalFailure()) return;
    ++counts.motions;
  }
  std::printf(
      "%d motions: %d free, %d blocked, %d within the band; moves at most %.3f and bends at "
      "most %.3f of their bounds\n",
      counts.motions, counts.free, counts.blocked, counts.in_band, counts.most_move,
      counts.most_bend);
  EXPECT_GE(counts.free, at_least_among(count / 4));
  EXPECT_GE(counts.blocked, at_least_among(count / 50));
  EXPECT_LE(counts.in_band, count / 200);
  EXPECT_GT(counts.most_move, 0.5);
}

}  // namespace
}  // namespace swivel
