// SPDX-License-Identifier: BSD-3-Clause
// Which pairs count. docs/model.md "Clearance".
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include "seed.hpp"
#include "support.hpp"
#include "swivel/collision/world/world.hpp"

namespace swivel {
namespace {

using namespace swivel::testing;
using Names = std::set<std::pair<std::string, std::string>>;

Names names_of(const World& world) {
  Names names;
  for (const BodyPair& p : world.pairs()) {
    EXPECT_LT(p.a, p.b);
    names.insert(std::minmax(world.body_names()[p.a], world.body_names()[p.b]));
  }
  EXPECT_EQ(names.size(), world.pairs().size());
  return names;
}

Names pairs_of(const RobotModel& robot, const PathProblem& problem) {
  return names_of(
      World(robot, build_arm(robot, "l0", "l7", problem.hold, Pose::Identity()), problem));
}

/// A flange fixed to l7 and, on it, a finger on a held joint.
RobotModel arm_with_gripper() {
  RobotModel robot = capsule_arm();
  for (const auto& [name, type] :
       {std::pair{"flange", Joint::Type::kFixed}, std::pair{"finger", Joint::Type::kPrismatic}}) {
    Joint joint;
    joint.name = std::string("to_") + name;
    joint.type = type;
    joint.parent_link = static_cast<int>(robot.links.size()) - 1;
    joint.child_link = static_cast<int>(robot.links.size());
    joint.origin.translation().z() = 0.1;
    joint.upper = 0.05;
    robot.joints.push_back(joint);
    robot.links.push_back({name,
                           {{Box{Vector3d(0.04, 0.04, 0.04)}, Pose::Identity()}},
                           static_cast<int>(robot.joints.size()) - 1});
  }
  return robot;
}

TEST(PairRules, GroupsParentsAndChildren) {
  RobotModel robot = arm_with_gripper();
  robot.has_srdf = true;
  const Names names = pairs_of(robot, problem_for(robot));
  for (int i = 0; i < 7; ++i) {
    const std::string a = numbered("l", i), b = numbered("l", i + 1);
    EXPECT_FALSE(names.count({a, b})) << a;
  }
  EXPECT_FALSE(names.count({"flange", "l7"}));  // one rigid cluster
  EXPECT_FALSE(names.count({"finger", "l7"}));  // joined by a held joint: one group
  EXPECT_FALSE(names.count({"finger", "flange"}));
  EXPECT_FALSE(names.count({"flange", "l6"}));  // child through the fixed joint
  EXPECT_TRUE(names.count({"finger", "l6"}));   // grandchild
  EXPECT_TRUE(names.count(
      {"l5", "l7"}));  // an SRDF speaks for links: near or not, what it does not name counts
  EXPECT_TRUE(names.count({"l0", "l7"}));
  EXPECT_EQ(names.size(), 10u * 9 / 2 - 7 - 3 - 1);
}

TEST(PairRules, SrdfDisablesByName) {
  RobotModel robot = capsule_arm();
  robot.has_srdf = true;
  robot.disabled_pairs = {{"l7", "l5"}, {"l0", "l2"}, {"absent", "l1"}};
  const Names names = pairs_of(robot, problem_for(robot));
  EXPECT_FALSE(names.count({"l5", "l7"}));
  EXPECT_FALSE(names.count({"l0", "l2"}));
  EXPECT_TRUE(names.count({"l1", "l3"}));
  EXPECT_EQ(names.size(), 21u - 2);
}

TEST(PairRules, WithoutSrdfAlwaysNearPairsDoNotCount) {
  RobotModel robot = capsule_arm();
  // A stub of l2 that never leaves l4's reach: it sits at the elbow, where l4 starts.
  Pose at_elbow = Pose::Identity();
  at_elbow.translation().z() = 0.21;
  robot.links[2].collision.clear();
  robot.links[2].collision.push_back({Sphere{0.05}, at_elbow});
  robot.joints[3].origin = Pose::Identity();
  EXPECT_FALSE(pairs_of(robot, problem_for(robot)).count({"l2", "l4"}));
  robot.has_srdf = true;
  EXPECT_TRUE(pairs_of(robot, problem_for(robot)).count({"l2", "l4"}));
  robot = capsule_arm();
  EXPECT_TRUE(pairs_of(robot, problem_for(robot)).count({"l0", "l7"}));
}

/// Expects the required clearances that the limits' formulas give from the medians.
void expect_keeps(const World& world, const Limits& limits) {
  for (const RobotPair& p : world.robot_pairs_with_medians()) {
    if (p.dropped) continue;
    const double self = limits.self_clearance.value_or(limits.clearance), h = limits.edge_tolerance;
    EXPECT_DOUBLE_EQ(p.required.node, std::min(self, p.median / 2));
    EXPECT_DOUBLE_EQ(p.required.motion,
                     std::min(limits.edge_clearance.value_or(self / 2), p.median / 4));
    if (p.median / 2 > kVerdictBand) {
      EXPECT_DOUBLE_EQ(p.required.tolerance, std::min(h, p.median / 2));
    }
    EXPECT_GT(p.required.tolerance, 0);
    EXPECT_EQ(p.reduced, p.required.node < self ||
                             p.required.motion < limits.edge_clearance.value_or(self / 2) ||
                             p.required.tolerance < h);
    const RequiredClearance required = world.required_clearance(p.pair);
    EXPECT_EQ(required.node, p.required.node);
    EXPECT_EQ(required.motion, p.required.motion);
  }
}

const RobotPair& find_pair(const std::vector<RobotPair>& pairs, const World& world,
                           const std::string& a, const std::string& b) {
  const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const RobotPair& p) {
    return world.names(p.pair) == std::array<std::string, 2>{a, b};
  });
  EXPECT_NE(found, pairs.end());
  return *found;
}

TEST(PairRules, APairThatIsNearByDesignStillMayNotMeet) {
  const RobotModel robot = near_wrist_arm(0.002);
  Config apart = Config::Zero(), meeting = Config::Zero();
  meeting[5] = kPi / 2;
  for (const double clearance : {0.0, 0.001, 0.005, 0.05}) {
    PathProblem problem = problem_for(robot);
    problem.limits.clearance = clearance;
    const World world(robot, arm_of(robot), problem);
    const auto pairs = world.robot_pairs_with_medians();
    const RobotPair& wrist = find_pair(pairs, world, "l5", "l7");
    EXPECT_FALSE(wrist.dropped);
    EXPECT_NEAR(wrist.median, 0.002, 0.0004);
    for (const DistanceProofs distance_proofs : {DistanceProofs::kOff, DistanceProofs::kOn}) {
      World::Query query(world, distance_proofs);
      EXPECT_FALSE(query.find_violating_pair(apart, ClearanceRule::kNode)) << clearance;
      const auto pair = query.find_violating_pair(meeting, ClearanceRule::kNode);
      ASSERT_TRUE(pair) << clearance;
      EXPECT_EQ(*pair, wrist.pair);
    }
    World::Query query(world);
    const auto at = query.clearance(apart);
    ASSERT_TRUE(at);
    EXPECT_EQ(at->pair, wrist.pair);
    EXPECT_NEAR(at->distance, 0.002, kVerdictBand);
    EXPECT_DOUBLE_EQ(at->required, std::min(clearance, wrist.median / 2));
    EXPECT_EQ(at->least, at->distance);
    EXPECT_EQ(query.clearance(meeting)->distance, 0);
    expect_keeps(world, problem.limits);
  }
}

TEST(PairRules, WhatPairsKeepGrowsWithTheLimits) {
  const std::vector<RobotModel> robots{near_wrist_arm(0.0006), near_wrist_arm(0.002),
                                       capsule_arm()};
  Random random(51);
  int pairs = 0, reduced = 0, plain = 0;
  for (const RobotModel& robot : robots) {
    PathProblem problem = problem_for(robot);
    const World first(robot, arm_of(robot), problem);
    for (int trial = 0; trial < test::trials(20); ++trial) {
      problem.limits = {};
      if (trial % 3 == 1) problem.limits.self_clearance = random.uniform(0, 0.02);
      if (trial % 4 == 1) problem.limits.edge_clearance = random.uniform(0, 0.02);
      std::vector<RobotPair> before;
      for (double clearance = 0; clearance < 0.2; clearance += random.uniform(0, 0.02)) {
        problem.limits.clearance = clearance;
        const World world(first, problem);  // prepared for other limits
        const std::vector<RobotPair> now = world.robot_pairs();
        for (std::size_t k = 0; k < before.size(); ++k) {
          ASSERT_EQ(now[k].pair, before[k].pair);
          ASSERT_EQ(now[k].dropped, before[k].dropped);
          ASSERT_GE(now[k].required.node, before[k].required.node);
          ASSERT_GE(now[k].required.motion, before[k].required.motion);
          ASSERT_EQ(now[k].required.tolerance, before[k].required.tolerance);
          ++pairs;
          ++(now[k].reduced ? reduced : plain);
        }
        before = now;
      }
      expect_keeps(World(first, problem), problem.limits);
    }
  }
  std::printf("%d pairs compared, %d reduced, %d not\n", pairs, reduced, plain);
  EXPECT_GE(reduced, test::at_least(301));
  EXPECT_GE(plain, test::at_least(301));
}

TEST(PairRules, AnSrdfLeavesNothingToSamples) {
  RobotModel robot = near_wrist_arm(0.002);
  robot.has_srdf = true;
  PathProblem problem = problem_for(robot);
  problem.limits.self_clearance = 0.003;
  const World world(robot, arm_of(robot), problem);
  for (const RobotPair& p : world.robot_pairs()) {
    EXPECT_FALSE(p.dropped || p.reduced);
    EXPECT_EQ(p.required.node, 0.003);
    EXPECT_EQ(p.required.motion, 0.0015);
  }
  EXPECT_TRUE(world.warnings().empty());
  EXPECT_TRUE(
      World::Query(world).find_violating_pair(Config::Zero(), ClearanceRule::kNode));  // 2 mm apart
}

TEST(PairRules, ForgivenNearnessIsNoContact) {
  RobotModel robot = near_wrist_arm(0.002);
  robot.has_srdf = true;
  PathProblem problem = problem_for(robot);
  Config touching = Config::Zero();
  touching[5] = kPi / 2;
  for (const auto& [clearance, apart_is_forgiven] :
       {std::pair(0.00203, true), std::pair(0.0021, false), std::pair(0.0, true)}) {
    problem.limits.clearance = clearance;
    const World strict(robot, arm_of(robot), problem), forgiving(strict, problem, {}, kVerdictBand);
    World::Query query(forgiving);
    EXPECT_EQ(
        World::Query(strict).find_violating_pair(Config::Zero(), ClearanceRule::kNode).has_value(),
        clearance > 0.002);
    EXPECT_EQ(query.find_violating_pair(Config::Zero(), ClearanceRule::kNode).has_value(),
              !apart_is_forgiven)
        << clearance;
    EXPECT_TRUE(query.find_violating_pair(touching, ClearanceRule::kNode)) << clearance;
    EXPECT_TRUE(
        edge_blocked(query, forgiving.edge_rule({1, 1, 1, 1, 1, 0.2, 0.2}), touching, touching));
  }
}

TEST(PairRules, SpecialPairsAreTold) {
  RobotModel robot = near_wrist_arm(0.002);
  EXPECT_EQ(World(robot, arm_of(robot), problem_for(robot)).warnings().size(), 1u);
  robot.links[2].collision[0] = {Sphere{0.3}, Pose::Identity()};  // in contact with l0 everywhere
  const World world(robot, arm_of(robot), problem_for(robot));
  ASSERT_EQ(world.warnings().size(), 2u);
  EXPECT_NE(world.warnings()[0].find("touch in every posture"), std::string::npos);
  EXPECT_NE(world.warnings()[0].find("l0 - l2"), std::string::npos);
  EXPECT_NE(world.warnings()[1].find("keep less than 5 mm: l5 - l7"), std::string::npos);
  EXPECT_FALSE(pairs_of(robot, problem_for(robot)).count({"l0", "l2"}));
}

TEST(PairRules, LinksWithoutAShapeAreTold) {
  RobotModel robot = arm_with_gripper();
  robot.has_srdf = true;
  EXPECT_TRUE(World(robot, arm_of(robot), problem_for(robot)).warnings().empty());
  robot.links[7].collision.clear();  // the flange and the finger move with it and have shapes
  EXPECT_TRUE(World(robot, arm_of(robot), problem_for(robot)).warnings().empty());
  robot.links[3].collision.clear();
  robot.links[5].collision.clear();
  const auto warnings = World(robot, arm_of(robot), problem_for(robot)).warnings();
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_EQ(warnings[0].rfind("l3:", 0), 0u) << warnings[0];
  EXPECT_EQ(warnings[1].rfind("l5:", 0), 0u) << warnings[1];
  for (Link& link : robot.links) link.collision.clear();
  const World bare(robot, arm_of(robot), problem_for(robot));
  ASSERT_EQ(bare.warnings().size(), 1u);
  EXPECT_NE(bare.warnings()[0].find("no collision shape at all"), std::string::npos);
}

TEST(PairRules, AttachedBodies) {
  RobotModel robot = capsule_arm();
  robot.has_srdf = true;
  PathProblem problem = problem_for(robot);
  Pose tip = Pose::Identity();
  tip.translation().z() = 0.15;
  problem.attached.push_back({"tool", Sphere{0.03}, tip, "l7"});
  problem.attached.push_back(
      {"collar", Sphere{0.12}, Pose::Identity(), "l6"});  // about joint 6, so always in l5 and l7
  const Names names = pairs_of(robot, problem);
  EXPECT_FALSE(names.count({"l7", "tool"}));
  EXPECT_TRUE(names.count({"l5", "tool"}));
  EXPECT_TRUE(names.count({"l0", "tool"}));
  EXPECT_FALSE(names.count({"collar", "l6"}));
  EXPECT_FALSE(
      names.count({"collar", "l7"}));  // near in all samples, and attached: the SRDF cannot know
  EXPECT_TRUE(names.count({"collar", "l1"}));
}

TEST(PairRules, SceneObjects) {
  RobotModel robot = capsule_arm();
  robot.has_srdf = true;
  PathProblem problem = problem_for(robot);
  problem.attached.push_back({"tool", Sphere{0.03}, Pose::Identity(), "l7"});
  problem.scene.push_back({"table", Box{Vector3d(2, 2, 0.02)}, Pose::Identity(), {"l1", "tool"}});
  problem.scene.push_back({"ball", Sphere{0.1}, Pose::Identity(), {}});
  const Names names = pairs_of(robot, problem);
  EXPECT_FALSE(names.count({"l0", "table"}));  // neither moves
  EXPECT_FALSE(names.count({"l1", "table"}));
  EXPECT_FALSE(names.count({"table", "tool"}));
  EXPECT_TRUE(names.count({"l2", "table"}));
  EXPECT_TRUE(names.count({"ball", "tool"}));
  EXPECT_TRUE(names.count({"ball", "l1"}));
  EXPECT_FALSE(names.count({"ball", "table"}));
}

TEST(PairRules, EnvironmentComesFirstAndTheToolFirstOfAll) {
  RobotModel robot = capsule_arm();
  PathProblem problem = problem_for(robot);
  problem.scene.push_back({"ball", Sphere{0.1}, Pose::Identity(), {}});
  const World world(robot, arm_of(robot), problem);
  ASSERT_GT(world.pairs().size(), 7u);
  for (int k = 0; k < 7; ++k) {
    const BodyPair& p = world.pairs()[k];
    EXPECT_EQ(world.body_names()[p.a], numbered("l", 7 - k));
    EXPECT_EQ(world.body_names()[p.b], "ball");
  }
}

}  // namespace
}  // namespace swivel
