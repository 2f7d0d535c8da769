// SPDX-License-Identifier: BSD-3-Clause
// Which pairs count. design.md 1.
#include <gtest/gtest.h>

#include <set>

#include "support.hpp"
#include "swivel/collision/world.hpp"

namespace swivel {
namespace {

using namespace swivel::testing;
using Names = std::set<std::pair<std::string, std::string>>;

Names names_of(const World& world) {
  Names names;
  for (const BodyPair& p : world.pairs()) {
    EXPECT_LT(p.a, p.b);
    names.insert(std::minmax(world.body_names()[static_cast<std::size_t>(p.a)], world.body_names()[static_cast<std::size_t>(p.b)]));
  }
  EXPECT_EQ(names.size(), world.pairs().size());
  return names;
}

Names pairs_of(const RobotModel& robot, const Problem& problem) {
  return names_of(World(robot, build_arm(robot, "l0", "l7", problem.hold, Pose::Identity()), problem));
}

/// A flange fixed to l7 and, on it, a finger on a held joint.
RobotModel arm_with_gripper() {
  RobotModel robot = capsule_arm();
  for (const auto& [name, type] : {std::pair{"flange", Joint::Type::kFixed}, std::pair{"finger", Joint::Type::kPrismatic}}) {
    Joint joint;
    joint.name = std::string("to_") + name;
    joint.type = type;
    joint.parent_link = static_cast<int>(robot.links.size()) - 1;
    joint.child_link = static_cast<int>(robot.links.size());
    joint.origin.translation().z() = 0.1;
    joint.upper = 0.05;
    robot.joints.push_back(joint);
    robot.links.push_back({name, {{Box{Vector3d(0.04, 0.04, 0.04)}, Pose::Identity()}}, static_cast<int>(robot.joints.size()) - 1});
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
  EXPECT_TRUE(names.count({"l5", "l7"}));       // an SRDF speaks for links: near or not, what it does not name counts
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

TEST(PairRules, AttachedBodies) {
  RobotModel robot = capsule_arm();
  robot.has_srdf = true;
  Problem problem = problem_for(robot);
  Pose tip = Pose::Identity();
  tip.translation().z() = 0.15;
  problem.attached.push_back({"tool", Sphere{0.03}, tip, "l7"});
  problem.attached.push_back({"collar", Sphere{0.12}, Pose::Identity(), "l6"});  // about joint 6, so always in l5 and l7
  const Names names = pairs_of(robot, problem);
  EXPECT_FALSE(names.count({"l7", "tool"}));
  EXPECT_TRUE(names.count({"l5", "tool"}));
  EXPECT_TRUE(names.count({"l0", "tool"}));
  EXPECT_FALSE(names.count({"collar", "l6"}));
  EXPECT_FALSE(names.count({"collar", "l7"}));  // near in all samples, and attached: the SRDF cannot know
  EXPECT_TRUE(names.count({"collar", "l1"}));
}

TEST(PairRules, SceneObjects) {
  RobotModel robot = capsule_arm();
  robot.has_srdf = true;
  Problem problem = problem_for(robot);
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
  Problem problem = problem_for(robot);
  problem.scene.push_back({"ball", Sphere{0.1}, Pose::Identity(), {}});
  const World world(robot, arm_of(robot), problem);
  ASSERT_GT(world.pairs().size(), 7u);
  for (int k = 0; k < 7; ++k) {
    const BodyPair& p = world.pairs()[static_cast<std::size_t>(k)];
    EXPECT_EQ(world.body_names()[static_cast<std::size_t>(p.a)], numbered("l", 7 - k));
    EXPECT_EQ(world.body_names()[static_cast<std::size_t>(p.b)], "ball");
  }
}

}  // namespace
}  // namespace swivel
