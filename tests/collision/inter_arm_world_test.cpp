// SPDX-License-Identifier: BSD-3-Clause
// The world between two arms against the world of one arm in which the other's bodies stand as
// objects, and its motions against samples.
#include "swivel/collision/arms/inter_arm_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "robots.hpp"
#include "seed.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"

namespace swivel::test {

namespace {

/// Both arms of a two-armed robot, each with a body in its hand.
struct TwoArms {
  explicit TwoArms(const char* name) : robot(data_robot(name)) {
    for (std::size_t k = 0; k < 2; ++k) {
      const std::string tip = k == 0 ? "arm_left_link_tool0" : "arm_right_link_tool0";
      arms.push_back(
          build_arm(*robot.model, robot.base_link, tip, {{"torso_joint_b1", 0}}, Pose::Identity()));
      AttachedBody tool;
      tool.name = k == 0 ? "left_tool" : "right_tool";
      tool.link = tip;
      tool.shape = k == 0 ? Shape(Box{Vector3d(0.2, 0.15, 0.02)}) : Shape(Capsule{0.03, 0.06});
      tool.pose.translation() = Vector3d(0, 0, 0.06);
      attached[k].push_back(tool);
    }
    limits.clearance = 0.01;
    const std::array<ArmInPair, 2> two{ArmInPair{&arms[0], &attached[0]},
                                       ArmInPair{&arms[1], &attached[1]}};
    world.emplace(*robot.model, two, std::vector<std::array<std::string, 2>>(), limits);
    for (std::size_t k = 0; k < 2; ++k)
      radii[k] = motion_radii(arms[k].chain, robot_bodies(*robot.model, arms[k], attached[k]));
  }
  /// Returns postures of both arms whose hands are near each other.
  std::array<Config, 2> postures(Random& random) const {
    constexpr int kMostDraws = 2000;
    constexpr double kNear = 0.3;  // m
    std::array<Config, 2> q;
    for (int draw = 0; draw < kMostDraws; ++draw) {
      std::array<Vector3d, 2> hands;
      for (std::size_t k = 0; k < 2; ++k) {
        for (std::size_t j = 0; j < kDof; ++j) {
          const JointLimit& limit = arms[k].chain.limit[j];
          q[k][static_cast<Eigen::Index>(j)] = random.uniform(limit.lower, limit.upper);
        }
        hands[k] = arms[k].chain.tool(q[k]).translation();
      }
      if ((hands[0] - hands[1]).norm() < kNear) break;
    }
    return q;
  }
  TestRobot robot;
  std::vector<ArmModel> arms;
  std::array<std::vector<AttachedBody>, 2> attached;
  Limits limits;
  std::array<std::array<double, kDof>, 2> radii{};
  std::optional<InterArmWorld> world;
};

/// A World of arm 0 alone in which the bodies of arm 1 at q[1] are scene objects. Pairs that the
/// inter-arm world does not have may touch.
struct OtherArmAsObjects {
  OtherArmAsObjects(const TwoArms& two, const std::array<Config, 2>& q) {
    auto model = std::make_shared<RobotModel>(*two.robot.model);
    for (std::size_t l = 0; l < model->links.size(); ++l)
      if (two.arms[0].links[l].group == 0) model->links[l].collision.clear();
    problem.model = model;
    problem.base_link = two.robot.base_link;
    problem.tip_link = "arm_left_link_tool0";
    problem.attached = two.attached[0];
    problem.limits = two.limits;
    problem.limits.self_clearance = 0;  // its own pairs are not asked about
    const auto moved = two.arms[1].chain.all_displacements(q[1]);
    for (const RobotBody& body : robot_bodies(*two.robot.model, two.arms[1], two.attached[1])) {
      if (body.group == 0) continue;
      SceneObject object;
      object.name = "object" + std::to_string(problem.scene.size());
      object.shape = body.shape;
      object.pose = moved[static_cast<std::size_t>(body.group)] * body.pose;
      for (const RobotBody& own : robot_bodies(*model, two.arms[0], two.attached[0])) {
        if (own.group == 0) continue;
        const bool kept = std::any_of(
            two.world->pairs().begin(), two.world->pairs().end(), [&](const RobotPair& pair) {
              const auto names = two.world->names(pair.pair);
              return !pair.dropped && names[0] == own.name && names[1] == body.name;
            });
        if (!kept) object.allow.emplace_back(own.name);
      }
      problem.scene.push_back(object);
    }
    const World whole(*model, two.arms[0], problem, {});
    std::vector<int> objects(problem.scene.size());
    std::iota(objects.begin(), objects.end(), 0);
    world.emplace(whole, objects);
  }
  PathProblem problem;
  std::optional<World> world;  ///< of the pairs with an object
};

/// Returns whether arm 0 at q[0] is too near to arm 1 at q[1], by a World of objects.
bool too_near_as_objects(const TwoArms& two, const std::array<Config, 2>& q) {
  const OtherArmAsObjects as(two, q);
  World::Query query(*as.world, DistanceProofs::kOff);
  for (const BodyPair& pair : as.world->pairs())
    if (query.pair_violates(q[0], pair, ClearanceRule::kNode)) return true;
  return false;
}

TEST(InterArmWorld, AnswersAsAWorldInWhichTheOtherArmStandsAsObjects) {
  Random random(seed("InterArmWorld.AnswersAsAWorldInWhichTheOtherArmStandsAsObjects"));
  const TwoArms two("sda10f");
  for (const RobotPair& pair : two.world->pairs())
    ASSERT_FALSE(pair.reduced && !pair.dropped) << two.world->names(pair.pair)[0];
  InterArmWorld::Query quick(*two.world), plain(*two.world, DistanceProofs::kOff);
  int near = 0;
  const int count = trials(2000);
  for (int trial = 0; trial < count; ++trial) {
    const auto q = two.postures(random);
    const bool expected = too_near_as_objects(two, q);
    near += expected;
    EXPECT_EQ(plain.find_violating_pair(q, ClearanceRule::kNode).has_value(), expected);
    EXPECT_EQ(quick.find_violating_pair(q, ClearanceRule::kNode).has_value(), expected);
    EXPECT_EQ(quick.find_deepest_pair(q).has_value(), expected);
    const auto clearance = quick.clearance(q);
    ASSERT_TRUE(clearance);
    EXPECT_EQ(clearance->margin() < 0, expected);
  }
  std::printf("%d postures, %d too near\n", count, near);
  EXPECT_GE(near, at_least(count / 20));
}

TEST(InterArmWorld, BodiesAreAsNearAsToObjects) {
  Random random(seed("InterArmWorld.BodiesAreAsNearAsToObjects"));
  const TwoArms two("sda10f");
  InterArmWorld::Query query(*two.world);
  int compared = 0, touching = 0;
  const int count = trials(400);
  for (int trial = 0; trial < count; ++trial) {
    const auto q = two.postures(random);
    const OtherArmAsObjects as(two, q);
    const auto expected = World::Query(*as.world, DistanceProofs::kOff).body_clearances(q[0]);
    const auto found = query.body_clearances(q);
    ASSERT_EQ(found.size(), two.world->body_names().size());
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t body = 0; body < found.size(); ++body) {
      ASSERT_EQ(found[body].has_value(), expected[body].has_value());
      if (!found[body]) continue;
      const BodyPair& pair = found[body]->pair;
      EXPECT_TRUE(pair.a == static_cast<int>(body) || pair.b == static_cast<int>(body));
      EXPECT_NEAR(found[body]->distance, expected[body]->distance, 1e-9)
          << two.world->body_names()[body];
      ++compared;
      touching += found[body]->distance == 0;
    }
    const auto least = query.clearance(q);
    EXPECT_EQ(found[static_cast<std::size_t>(least->pair.a)]->required, least->required);
  }
  std::printf("%d bodies of %d postures, %d touch\n", compared, count, touching);
  EXPECT_GE(compared, at_least(10 * count));
  EXPECT_GE(touching, at_least(count / 20));
}

TEST(InterArmWorld, StancesAnswerAsPostures) {
  Random random(seed("InterArmWorld.StancesAnswerAsPostures"));
  const TwoArms two("sda5f");
  InterArmWorld::Query query(*two.world);
  std::array<std::vector<Config>, 2> q;
  for (int k = 0; k < 40; ++k) {
    const auto both = two.postures(random);
    q[0].push_back(both[0]), q[1].push_back(both[1]);
  }
  const auto a = query.stances(0, -1, q[0]), b = query.stances(1, -1, q[1]);
  int near = 0;
  for (std::size_t i = 0; i < q[0].size(); ++i)
    for (std::size_t j = 0; j < q[1].size(); ++j) {
      const bool expected =
          query.find_violating_pair({q[0][i], q[1][j]}, ClearanceRule::kNode).has_value();
      near += expected;
      EXPECT_EQ(query.any_violates(a, a.stance_of(i), b, b.stance_of(j)), expected);
    }
  EXPECT_GE(near, 10);
}

TEST(InterArmWorld, ConfigurationsWithEqualPosesShareAStance) {
  Random random(seed("InterArmWorld.ConfigurationsWithEqualPosesShareAStance"));
  const TwoArms two("sda10f");
  InterArmWorld::Query query(*two.world);
  std::vector<Config> q;
  for (int k = 0; k < 20; ++k) {
    Config joints = two.postures(random)[0];
    q.push_back(joints);
    joints[6] += 0.5;  // turns what is behind the last joint alone
    q.push_back(joints);
  }
  const auto& names = two.world->body_names();
  const auto number = [&](const char* name) {
    return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  EXPECT_EQ(query.stances(0, number("arm_left_link_3_e"), q).count(), 20u);
  EXPECT_EQ(query.stances(0, number("left_tool"), q).count(), 40u);
  EXPECT_EQ(query.stances(0, -1, q).count(), 40u);
}

TEST(InterArmWorld, MotionsThatAreFreeKeepTheirClearance) {
  Random random(seed("InterArmWorld.MotionsThatAreFreeKeepTheirClearance"));
  const TwoArms two("sda10f");
  InterArmWorld::Query query(*two.world), plain(*two.world, DistanceProofs::kOff);
  int free = 0, barred = 0, close = 0;
  const int count = trials(1000);
  for (int trial = 0; trial < count; ++trial) {
    const auto from = two.postures(random);
    auto to = from;
    for (Config& q : to)
      for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(kDof); ++j)
        q[j] += random.uniform(-0.15, 0.15);
    const bool blocked = query.find_pair_blocking_motion(two.radii, from, to).has_value();
    EXPECT_EQ(plain.find_pair_blocking_motion(two.radii, from, to).has_value(), blocked);
    blocked ? ++barred : ++free;
    double least = 1;
    for (int k = 0; k < 199; ++k) {
      const double t = random.uniform(0, 1);
      const auto at =
          query.clearance({from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])});
      least = std::min(least, at->distance);
    }
    if (!blocked) EXPECT_GE(least, two.limits.d_self_edge());
    close += !blocked && least < 0.05;
  }
  std::printf("%d motions: %d free, of which %d within 50 mm, %d barred\n", count, free, close,
              barred);
  EXPECT_GE(barred, at_least(count / 20));
  EXPECT_GE(close, at_least(count / 50));
}

TEST(InterArmWorld, ArmsAtRestAreFreeAsTheirPostureIs) {
  Random random(seed("InterArmWorld.ArmsAtRestAreFreeAsTheirPostureIs"));
  const TwoArms two("sda10f");
  InterArmWorld::Query query(*two.world);
  const int count = trials(1000);
  for (int trial = 0; trial < count; ++trial) {
    const auto q = two.postures(random);
    const bool below = query.find_violating_pair(q, ClearanceRule::kMidpoint).has_value();
    EXPECT_EQ(query.find_pair_blocking_motion(two.radii, q, q).has_value(), below);
  }
}

}  // namespace

}  // namespace swivel::test
