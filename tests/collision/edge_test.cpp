// SPDX-License-Identifier: BSD-3-Clause
// Compares bisection with a plain test of every midpoint. docs/model.md "Motions".
#include <gtest/gtest.h>

#include <cmath>

#include "plain_edge_rule.hpp"
#include "seed.hpp"
#include "support.hpp"
#include "swivel/collision/world/world.hpp"

namespace swivel {
namespace {

using namespace swivel::testing;

constexpr double kTau = 5e-5;

std::vector<SceneObject> random_scene(Random& random) {
  std::vector<SceneObject> scene;
  for (int k = 0; k < 5; ++k) {
    Pose pose = random.pose(0.8);
    pose.translation().z() += 0.6;
    Shape shape;
    switch (random.index(5)) {
      case 0:
        shape = Sphere{random.uniform(0.02, 0.15)};
        break;
      case 1:
        shape = Capsule{random.uniform(0.02, 0.1), random.uniform(0.1, 0.4)};
        break;
      case 2:
        shape = Box{random.vector(0.05, 0.3)};
        break;
      case 3:
        shape = Cylinder{random.uniform(0.02, 0.1), random.uniform(0.1, 0.4)};
        break;
      default:
        shape = as_mesh(panel_mesh(0.5, 0.4, 0.03, 5), "panel");
    }
    scene.push_back({numbered("object", k), shape, pose, {}});
  }
  return scene;
}

TEST(EdgeRule, Midpoints) {
  EdgeRule rule;
  rule.radii.fill(1.0);
  rule.h = 0.0005;
  const Config q0 = Config::Zero();
  Config q1 = Config::Zero();
  EXPECT_EQ(rule.midpoints(q0, q1), 1);
  q1[2] = 0.001;  // B / 2 = h
  EXPECT_EQ(rule.midpoints(q0, q1), 1);
  q1[2] = 0.00101;
  EXPECT_EQ(rule.midpoints(q0, q1), 2);
  q1[5] = -0.1;
  EXPECT_DOUBLE_EQ(rule.motion(q0, q1), 0.10101);
  EXPECT_EQ(rule.midpoints(q0, q1), 128);
}

/// Returns true if the pair is too near at any midpoint; tests them one after the other.
bool blocked_by_plain(const BodyPair& pair, World::Query& query, const EdgeRule& rule,
                      const Config& q0, const Config& q1) {
  const std::int64_t n = rule.midpoints(q0, q1);
  for (std::int64_t m = 0; m < n; ++m)
    if (query.pair_violates(
            q0 + (static_cast<double>(m) + 0.5) / static_cast<double>(n) * (q1 - q0), pair,
            ClearanceRule::kMidpoint))
      return true;
  return false;
}

TEST(EdgeBlocked, AgreesWithThePlainRule) {
  Random random(41);
  RobotModel robot = capsule_arm();
  Pose tip = Pose::Identity();
  tip.translation().z() = 0.17;
  robot.links[7].collision.push_back({Box{Vector3d(0.05, 0.05, 0.06)}, tip});
  const ArmModel arm = arm_of(robot);
  PathProblem problem = problem_for(robot);
  const World base(robot, arm, problem);
  const EdgeRule rule = base.edge_rule(motion_radii(arm.chain, base.bodies()));
  int blocked = 0, free = 0, in_band = 0, blocked_by = 0, free_of = 0;
  std::int64_t leaves = 0;
  for (int w = 0; w < test::trials(100); ++w) {
    const World world(base, random_scene(random));
    World::Query query(world);
    for (int k = 0; k < 25; ++k) {
      Config q0 = random.config(1.5);
      for (int again = 0; again < 20 && query.find_violating_pair(q0, 0.001); ++again)
        q0 = random.config(1.5);  // as a planner's: mostly free
      const Config q1 = q0 + random.config(0.06);
      leaves += rule.midpoints(q0, q1);
      const bool fast = edge_blocked(query, rule, q0, q1).has_value(),
                 plain = test::edge_blocked_plain(query, rule, q0, q1).has_value();
      ++(plain ? blocked : free);
      if (const auto pair = edge_blocked(query, rule, q0, q1)) {
        EXPECT_TRUE(edge_blocked_by(*pair, query, rule, q0, q1))
            << world.names(*pair)[0] << " " << world.names(*pair)[1];
      }
      if (k < 2)
        for (const BodyPair& pair : world.pairs()) {
          const bool by = edge_blocked_by(pair, query, rule, q0, q1),
                     plain_by = blocked_by_plain(pair, query, rule, q0, q1);
          ++(plain_by ? blocked_by : free_of);
          in_band += by != plain_by;
        }
      if (fast == plain) continue;
      double least = 1;
      const std::int64_t n = rule.midpoints(q0, q1);
      for (std::int64_t m = 0; m < n; ++m)
        least = std::min(least, query
                                    .clearance(q0 + (static_cast<double>(m) + 0.5) /
                                                        static_cast<double>(n) * (q1 - q0))
                                    ->distance);
      EXPECT_NEAR(least, problem.limits.d_edge() + rule.h, kTau);
      ++in_band;
    }
  }
  EXPECT_EQ(blocked + free, 25 * test::trials(100));
  EXPECT_GE(blocked, test::at_least(101));
  EXPECT_GE(free, test::at_least(101));
  EXPECT_GE(blocked_by, test::at_least(21));
  EXPECT_GE(free_of, test::at_least(1001));
  EXPECT_LE(in_band, 5);
  RecordProperty("in_band", in_band);
  std::cout << "blocked " << blocked << ", free " << free << ", disagreements within tau "
            << in_band << ", midpoints " << leaves << std::endl;
}

TEST(EdgeBlocked, ProvesTheWholeMotion) {
  // A ball too thin to be met by a few samples: the arm sweeps over it between two free ends.
  const RobotModel robot = capsule_arm();
  const ArmModel arm = arm_of(robot);
  PathProblem problem = problem_for(robot);
  Config q0 = Config::Zero(), q1 = Config::Zero();
  q0[1] = q1[1] = 1.2;
  q0[0] = -0.25;
  q1[0] = 0.25;
  const World empty(robot, arm, problem);
  Config middle = q0 + 0.37 * (q1 - q0);
  Pose pose = Pose::Identity();
  pose.translation() = arm.chain.tool(middle).translation();
  const World world(empty, {{"speck", Sphere{0.001}, pose, {}}});
  const EdgeRule rule = world.edge_rule(motion_radii(arm.chain, world.bodies()));
  World::Query query(world);
  EXPECT_FALSE(query.find_violating_pair(q0, 0.01));
  EXPECT_FALSE(query.find_violating_pair(q1, 0.01));
  const auto pair = edge_blocked(query, rule, q0, q1);
  ASSERT_TRUE(pair);
  EXPECT_EQ(world.body_names()[pair->b], "speck");
  EXPECT_TRUE(edge_blocked(query, rule, q1, q0));
  World::Query other(empty);
  EXPECT_FALSE(edge_blocked(other, rule, q0, q1));
}

/// Pairs that are near by design have motions, and where the median is small tolerances, of their
/// own.
TEST(EdgeBlocked, NearPairsAgreeWithThePlainRuleAndAreProved) {
  Random random(42);
  int blocked = 0, free = 0, in_band = 0;
  for (const double gap : {0.0006, 0.002, 0.004}) {
    const RobotModel robot = near_wrist_arm(gap);
    const ArmModel arm = arm_of(robot);
    const World world(robot, arm, problem_for(robot));
    const EdgeRule rule = world.edge_rule(motion_radii(arm.chain, world.bodies()));
    ASSERT_EQ(rule.near.size(), 1u);
    const EdgeRule::Near wrist = rule.near[0];
    EXPECT_EQ(wrist.first_joint, 5);
    EXPECT_EQ(wrist.last, 7);
    EXPECT_EQ(wrist.h < rule.h, gap < 0.001);
    World::Query fast(world, DistanceProofs::kOn), plain(world);
    for (int k = 0; k < test::trials(60); ++k) {
      Config q0 = random.config(0.5);  // stretched, so that nothing else is near
      q0[5] = random.uniform(-2.5, 2.5);
      q0[6] = random.uniform(-2.5, 2.5);
      const Config q1 = q0 + random.config(0.04);
      const auto found = edge_blocked(fast, rule, q0, q1),
                 expected = test::edge_blocked_plain(plain, rule, q0, q1);
      ++(expected ? blocked : free);
      const auto clearance = [&](double t) { return plain.clearance(q0 + t * (q1 - q0))->least; };
      if (found.has_value() != expected.has_value()) {
        const std::int64_t n = rule.midpoints(q0, q1, wrist.h);
        double least = 1;
        for (std::int64_t m = 0; m < n; ++m)
          least =
              std::min(least, clearance((static_cast<double>(m) + 0.5) / static_cast<double>(n)));
        EXPECT_NEAR(least, wrist.d_edge + wrist.h, kTau);
        ++in_band;
        continue;
      }
      if (expected) {
        EXPECT_EQ(*found, wrist.pair);
        continue;
      }
      for (int i = 0; i <= 20; ++i) ASSERT_GE(clearance(i / 20.0), wrist.d_edge - kTau) << gap;
    }
  }
  std::printf("%d blocked, %d free, %d in the band\n", blocked, free, in_band);
  EXPECT_GE(blocked, test::at_least(21));
  EXPECT_GE(free, test::at_least(41));
  EXPECT_LE(in_band, 3);
}

TEST(EdgeRule, NoPathBendsFurther) {
  Random random(44);
  const RobotModel robot = capsule_arm();
  const ArmModel arm = arm_of(robot);
  const World world(robot, arm, problem_for(robot));
  const EdgeRule rule = world.edge_rule(motion_radii(arm.chain, world.bodies()));
  double most = 0;  // of the bound
  int tried = 0;
  for (int k = 0; k < test::trials(2000); ++k) {
    const Config q = random.config(2.5), half = random.config(random.uniform(0.01, 0.5));
    for (const RobotBody& body : world.bodies()) {
      if (body.group == 0) continue;
      const auto at = [&](double t) -> Vector3d {
        return arm.chain.displacements(q + t * half)[static_cast<std::size_t>(body.group)] *
               body.pose.translation();
      };
      constexpr double kSmall = 1e-4;
      const Vector3d velocity = (at(kSmall) - at(-kSmall)) / (2 * kSmall);
      for (const double t : {-1.0, 1.0}) {
        const double bent = (at(t) - at(0) - t * velocity).norm();
        EXPECT_LE(bent, rule.tangent_deviation(half) + 1e-7);
        most = std::max(most, bent / rule.tangent_deviation(half));
        ++tried;
      }
    }
  }
  std::printf("%d paths of points, at most %.2f of the bound\n", tried, most);
  EXPECT_GT(most, 0.3);  // the bound is of the right size
}

/// Segments that are proved by the speed of their bodies are free throughout, and many of them are
/// not by how far joints could move anything.
TEST(MotionSegment, NoPairComesNearerThanSaid) {
  Random random(43);
  const RobotModel robot = capsule_arm();
  const ArmModel arm = arm_of(robot);
  const World base(robot, arm, problem_for(robot));
  const EdgeRule rule = base.edge_rule(motion_radii(arm.chain, base.bodies()));
  constexpr double kNoBound = 100;  // m
  int proved = 0, by_speed_alone = 0, refused = 0;
  for (int w = 0; w < test::trials(60); ++w) {
    const World world(base, random_scene(random));
    for (const DistanceProofs distance_proofs : {DistanceProofs::kOn, DistanceProofs::kOff}) {
      World::Query query(world, distance_proofs), plain(world);
      for (int k = 0; k < 40; ++k) {
        Config q = random.config(1.5);
        for (int again = 0; again < 20 && plain.find_violating_pair(q, 0.01); ++again)
          q = random.config(1.5);
        MotionSegment segment;
        segment.half = random.config(random.uniform(0, 0.15));
        segment.tangent_deviation = rule.tangent_deviation(segment.half);
        const auto free = [&](double margin) {
          segment.margin = margin;
          return !query.find_violating_pair_over_motion(
              segment, q, Threshold(ClearanceRule::kMidpoint, kNoBound));
        };
        ++(free(0) ? proved : refused);
        if (!free(0)) continue;
        by_speed_alone += plain
                              .find_violating_pair(q, Threshold(ClearanceRule::kMidpoint,
                                                                rule.motion(q, q + segment.half)))
                              .has_value();
        double least = 0, most = 1;  // m: as much as can be asked for besides
        while (most - least > kTau / 4)
          (free((least + most) / 2) ? least : most) = (least + most) / 2;
        for (int i = -10; i <= 10; ++i)
          ASSERT_FALSE(plain.find_violating_pair(q + i / 10.0 * segment.half,
                                                 Threshold(ClearanceRule::kMidpoint, least - kTau)))
              << w << " " << k << " " << i;
      }
    }
  }
  std::printf("%d stretches proved, %d of them by speed alone, %d refused\n", proved,
              by_speed_alone, refused);
  EXPECT_GE(proved, test::at_least(1001));
  EXPECT_GE(by_speed_alone, test::at_least(301));
  EXPECT_GE(refused, test::at_least(301));
}

TEST(EdgeBlocked, StandingStill) {
  const RobotModel robot = capsule_arm();
  const World world(robot, arm_of(robot), problem_for(robot));
  World::Query query(world);
  EdgeRule rule;
  rule.radii.fill(1.0);
  EXPECT_FALSE(edge_blocked(query, rule, Config::Zero(), Config::Zero()));
}

}  // namespace
}  // namespace swivel
