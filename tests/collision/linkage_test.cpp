// SPDX-License-Identifier: BSD-3-Clause
// Bodies on linkages, whose joints mimic the arm's: where the world has them, and that motions are
// proved with theirs.
#include "linkages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "plain_edge_rule.hpp"
#include "support.hpp"
#include "swivel/collision/world/world.hpp"

namespace swivel {
namespace {

using testing::capsule_arm;
using testing::problem_for;

struct Linked {
  RobotModel robot;
  ArmModel arm;
};
/// The capsule arm with some linkages on links and joints of its own, without an SRDF.
Linked linked_arm(test::Random& random) {
  Linked linked;
  linked.robot = capsule_arm();
  add_linkages(linked.robot, {"j1", "j2", "j3", "j4", "j5", "j6", "j7"}, 1 + random.below(4),
               random);
  linked.arm = testing::arm_of(linked.robot);
  return linked;
}

Config random_config(double range, test::Random& random) {
  Config q;
  for (double& x : q.coordinates()) x = random.uniform(-range, range);
  return q;
}

TEST(LinkageWorld, BodiesStandWherePlainKinematicsHasThem) {
  const std::uint64_t base = test::seed("LinkageWorld.Places");
  int asked = 0;
  for (int trial = 0; trial < test::trials(100); ++trial) {
    test::Random random(base + static_cast<std::uint64_t>(trial));
    const Linked linked = linked_arm(random);
    const RobotModel& robot = linked.robot;
    const World bare(robot, linked.arm, problem_for(robot));
    for (int k = 0; k < 5; ++k) {
      const Config q = random_config(2.5, random);
      const std::vector<double> positions = [&] {
        std::vector<double> all(robot.joints.size(), 0.0);
        std::copy_n(q.data(), kDof, all.begin());
        return all;
      }();
      // A ball beside the ball at the end of a capsule of each linkage, along the capsule's axis:
      // the gap is the clearance.
      for (std::size_t link = 8; link < robot.links.size(); ++link) {
        const auto& capsule = std::get<Capsule>(robot.links[link].collision[0].shape);
        const double gap = random.uniform(0.005, 0.02), radius = 0.01;
        Pose beside = Pose::Identity();
        beside.translation() = test::plain_pose(robot, static_cast<int>(link), positions) *
                               robot.links[link].collision[0].pose *
                               Vector3d(0, 0, capsule.length / 2 + capsule.radius + gap + radius);
        const World world(bare, {{"ball", Sphere{radius}, beside, {}}});
        World::Query query(world, random.coin() ? DistanceProofs::kOn : DistanceProofs::kOff);
        int body = -1;
        for (std::size_t i = 0; i < world.bodies().size() && body < 0; ++i)
          if (world.bodies()[i].link == static_cast<int>(link)) body = static_cast<int>(i);
        const BodyPair pair{body, static_cast<int>(world.bodies().size())};
        EXPECT_FALSE(query.pair_violates(q, pair, gap - 1e-4))
            << trial << " " << robot.links[link].name;
        EXPECT_TRUE(query.pair_violates(q, pair, gap + 1e-4))
            << trial << " " << robot.links[link].name;
        ++asked;
      }
    }
  }
  std::printf("%d bodies on linkages\n", asked);
  EXPECT_GE(asked, test::at_least(1000));
}

/// A motion that is not blocked is free throughout, by FCL at many postures of it; and the rule by
/// bisection, with distance proofs, is the plain one.
TEST(LinkageWorld, MotionsAreProved) {
  const std::uint64_t base = test::seed("LinkageWorld.Motions");
  int free = 0, blocked = 0, by_linkages = 0, in_band = 0;
  for (int trial = 0; trial < test::trials(150); ++trial) {
    test::Random random(base + static_cast<std::uint64_t>(trial));
    const Linked linked = linked_arm(random);
    PathProblem problem = problem_for(linked.robot);
    problem.limits.edge_tolerance = 0.002;
    std::vector<SceneObject> scene;
    for (int k = 0; k < 3; ++k) {
      Pose pose = test::random_pose(0.7, random);
      pose.translation().z() += 0.5;
      scene.push_back({testing::numbered("ball", k), Sphere{random.uniform(0.01, 0.06)}, pose, {}});
    }
    const World bare(linked.robot, linked.arm, problem), world(bare, scene);
    const EdgeRule rule = world.edge_rule(motion_radii(linked.arm.chain, world.bodies()));
    World::Query fast(world, DistanceProofs::kOn), plain(world);
    for (int k = 0; k < 12; ++k) {
      Config q0 = random_config(1.5, random);
      for (int again = 0; again < 20 && plain.find_violating_pair(q0, ClearanceRule::kNode);
           ++again)
        q0 = random_config(1.5, random);
      const Config q1 = q0 + random_config(random.coin() ? 0.15 : 0.03, random);
      const auto found = edge_blocked(fast, rule, q0, q1),
                 expected = test::edge_blocked_plain(plain, rule, q0, q1);
      if (found.has_value() != expected.has_value()) {
        ++in_band;
        continue;
      }
      if (found) {
        ++blocked;
        by_linkages += found->b < static_cast<int>(world.bodies().size())
                           ? world.bodies()[found->b].group > kDof
                           : world.bodies()[found->a].group > kDof;
        continue;
      }
      ++free;
      for (int i = 0; i <= 24; ++i) {
        const auto pair = plain.find_violating_pair(
            q0 + i / 24.0 * (q1 - q0), Threshold(ClearanceRule::kMotion, -kVerdictBand));
        ASSERT_FALSE(pair) << "trial " << trial << ": " << world.names(*pair)[0] << " - "
                           << world.names(*pair)[1];
        for (const EdgeRule::Near& near : rule.near)
          ASSERT_FALSE(
              plain.pair_violates(q0 + i / 24.0 * (q1 - q0), near.pair, near.d_edge - kVerdictBand))
              << "trial " << trial;
      }
    }
  }
  std::printf("%d free, %d blocked, %d of them by a linkage, %d in the band\n", free, blocked,
              by_linkages, in_band);
  EXPECT_GE(free, test::at_least(300));
  EXPECT_GE(blocked, test::at_least(100));
  EXPECT_GE(by_linkages, test::at_least(30));
  EXPECT_LE(in_band, 10);
}

/// Paths of points bend no further than said, and no pair of them comes nearer than the speeds on a
/// segment say.
TEST(LinkageWorld, StretchesAreProvedBySpeed) {
  const std::uint64_t base = test::seed("LinkageWorld.Stretches");
  int proved = 0, bends = 0;
  double most = 0;
  for (int trial = 0; trial < test::trials(100); ++trial) {
    test::Random random(base + static_cast<std::uint64_t>(trial));
    const Linked linked = linked_arm(random);
    const Chain& chain = linked.arm.chain;
    const World world(linked.robot, linked.arm, problem_for(linked.robot));
    const EdgeRule rule = world.edge_rule(motion_radii(chain, world.bodies()));
    World::Query query(world, DistanceProofs::kOn), plain(world);
    for (int k = 0; k < 10; ++k) {
      Config q = random_config(1.5, random);
      for (int again = 0; again < 20 && plain.find_violating_pair(q, 0.01); ++again)
        q = random_config(1.5, random);
      MotionSegment segment;
      segment.half = random_config(random.uniform(0, 0.15), random);
      segment.tangent_deviation = rule.tangent_deviation(segment.half);
      for (const RobotBody& body : world.bodies()) {
        const auto at = [&](double t) -> Vector3d {
          return chain.all_displacements(q +
                                         t * segment.half)[static_cast<std::size_t>(body.group)] *
                 body.pose.translation();
        };
        constexpr double kSmall = 1e-4;
        const Vector3d velocity = (at(kSmall) - at(-kSmall)) / (2 * kSmall);
        for (const double t : {-1.0, 1.0}) {
          const double bent = (at(t) - at(0) - t * velocity).norm();
          ASSERT_LE(bent, segment.tangent_deviation + 1e-7)
              << "trial " << trial << " " << body.name;
          if (segment.tangent_deviation > 1e-4)
            most = std::max(most, bent / segment.tangent_deviation);
          ++bends;
        }
      }
      constexpr double kNoBound = 100;  // m
      const auto free = [&](double margin) {
        segment.margin = margin;
        return !query.find_violating_pair_over_motion(
            segment, q, Threshold(ClearanceRule::kMidpoint, kNoBound));
      };
      if (!free(0)) continue;
      ++proved;
      double least = 0, greatest = 1;  // m: as much as can be asked for besides
      while (greatest - least > kVerdictBand / 4)
        (free((least + greatest) / 2) ? least : greatest) = (least + greatest) / 2;
      for (int i = -5; i <= 5; ++i)
        ASSERT_FALSE(plain.find_violating_pair(
            q + i / 5.0 * segment.half, Threshold(ClearanceRule::kMidpoint, least - kVerdictBand)))
            << "trial " << trial << " " << k << " " << i;
    }
  }
  std::printf("%d stretches proved; %d paths of points, at most %.2f of the bound\n", proved, bends,
              most);
  EXPECT_GE(proved, test::at_least(300));
  EXPECT_GE(bends, test::at_least(15'000));
}

}  // namespace
}  // namespace swivel
