// SPDX-License-Identifier: BSD-3-Clause
// Joints outside the arm that mimic its own, and joints between base and tip that are held.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "linkages.hpp"
#include "robots.hpp"
#include "swivel/core/kinematics/srs/arm_guess.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {
namespace {

using namespace test;

/// Returns the robot with its links and joints in another order.
RobotModel shuffled(const RobotModel& model, Random& random) {
  const auto order = [&](std::size_t count) {
    std::vector<int> to(count);  // by old place
    std::iota(to.begin(), to.end(), 0);
    for (std::size_t k = count; k > 1; --k)
      std::swap(to[k - 1], to[static_cast<std::size_t>(random.below(static_cast<int>(k)))]);
    return to;
  };
  const std::vector<int> link_to = order(model.links.size()), joint_to = order(model.joints.size());
  const auto at = [](const std::vector<int>& to, int old) {
    return old < 0 ? -1 : to[static_cast<std::size_t>(old)];
  };
  RobotModel result = model;
  for (std::size_t k = 0; k < model.links.size(); ++k) {
    Link& link = result.links[static_cast<std::size_t>(link_to[k])] = model.links[k];
    link.parent_joint = at(joint_to, link.parent_joint);
  }
  for (std::size_t k = 0; k < model.joints.size(); ++k) {
    Joint& joint = result.joints[static_cast<std::size_t>(joint_to[k])] = model.joints[k];
    joint.parent_link = at(link_to, joint.parent_link);
    joint.child_link = at(link_to, joint.child_link);
    if (joint.mimic) joint.mimic->joint = at(joint_to, joint.mimic->joint);
  }
  result.root_link = at(link_to, model.root_link);
  return result;
}

/// Six to nine joints in a row, some links fixed, on random axes; linkages beside it.
struct RandomArm {
  RobotModel model;
  std::string base, tip;
  bool six = false;
};
RandomArm random_arm(Random& random) {
  RandomArm arm;
  RobotModel& model = arm.model;
  model.name = model.source = "random arm";
  model.links.push_back({"root", {{Box{Vector3d(0.1, 0.1, 0.1)}, Pose::Identity()}}, -1});
  const int joints = 6 + random.below(4);
  arm.six = joints == 6;
  std::vector<std::string> leaders;
  const int above = random.below(3);  // fixed links above the base
  for (int k = 0; k < joints + above + 1; ++k) {
    Joint joint;
    joint.name = "joint_" + std::to_string(k);
    joint.parent_link = static_cast<int>(model.links.size()) - 1;
    joint.child_link = joint.parent_link + 1;
    joint.origin = random_pose(0.3, random);
    joint.axis = random_pose(1, random).linear().col(2);
    if (k >= above && k < joints + above) {
      joint.type = Joint::Type::kRevolute;
      joint.lower = random.uniform(-3, -0.5);
      joint.upper = random.uniform(0.5, 3);
      leaders.push_back(joint.name);
    }
    model.links.push_back({"link_" + std::to_string(k),
                           {{Capsule{0.04, random.uniform(0.05, 0.3)}, random_pose(0.1, random)}},
                           static_cast<int>(model.joints.size())});
    model.joints.push_back(joint);
  }
  arm.base = "root";
  arm.tip = model.links.back().name;
  if (random.coin(0.3)) std::swap(arm.base, arm.tip);  // the part in the hand
  add_linkages(model, leaders, 1 + random.below(6), random);
  if (!random.coin(0.3)) arm.model = shuffled(model, random);
  return arm;
}

ArmModel build(const RandomArm& arm, const std::map<std::string, double>& hold) {
  return build_arm(arm.model, arm.base, arm.tip, hold, Pose::Identity(),
                   arm.six ? std::optional(Roll{}) : std::nullopt);
}

/// Positions of all joints of the model, for the chain's.
std::vector<double> positions_of(const RobotModel& model, const ArmModel& arm, const Config& q) {
  std::vector<double> positions(model.joints.size(), 0.0);
  for (const HeldJoint& held : arm.held)
    positions[static_cast<std::size_t>(model.find_joint(held.name))] = held.position;
  for (std::size_t k = 0; k < kDof; ++k)
    if (const int j = model.find_joint(arm.chain.joint_names[k]); j >= 0)
      positions[static_cast<std::size_t>(j)] = q[static_cast<Eigen::Index>(k)];
  return positions;
}

TEST(Linkage, EveryLinkStandsWherePlainKinematicsHasIt) {
  const std::uint64_t base = seed("Linkage.Places");
  double worst = 0;
  int robots = 0, links = 0, on_followers = 0, behind_followers = 0, in_hand = 0;
  for (int trial = 0; trial < trials(400); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const RandomArm robot = random_arm(random);
    const ArmModel arm = build(robot, {});
    const Chain& chain = arm.chain;
    ++robots;
    in_hand += robot.base != "root";
    const std::size_t base_link = static_cast<std::size_t>(robot.model.find_link(robot.base));
    for (int k = 0; k < 4; ++k) {
      const Config q = random_config(chain, random);
      const std::vector<double> positions = positions_of(robot.model, arm, q);
      const std::vector<Pose> moved = chain.all_displacements(q);
      const Pose to_base =
          plain_pose(robot.model, static_cast<int>(base_link), positions).inverse(Eigen::Isometry);
      for (std::size_t link = 0; link < robot.model.links.size(); ++link, ++links) {
        const int group = arm.links[link].group;
        const Pose expected = to_base * plain_pose(robot.model, static_cast<int>(link), positions);
        const Pose found = moved[static_cast<std::size_t>(group)] * arm.links[link].pose;
        const double miss = (found.matrix() - expected.matrix()).lpNorm<Eigen::Infinity>();
        ASSERT_LT(miss, 1e-10) << "trial " << trial << ": " << robot.model.links[link].name;
        worst = std::max(worst, miss);
        if (group <= kDof) continue;
        ++on_followers;
        behind_followers +=
            chain.followers[static_cast<std::size_t>(group) - kDof - 1].parent > kDof;
      }
    }
  }
  std::printf(
      "%d robots (%d seen from the hand), %d links, %d on linkages, %d of them on others; worst "
      "error %.1e\n",
      robots, in_hand, links, on_followers, behind_followers, worst);
  EXPECT_GE(robots, at_least(400));
  EXPECT_GE(in_hand, at_least(60));
  EXPECT_GE(on_followers, at_least(3000));
  EXPECT_GE(behind_followers, at_least(500));
}

/// Counts points and pairs of bodies that were moved, pairs at rest, and the largest share of a
/// bound that a point reached.
struct RadiiCounts {
  int points = 0, pairs = 0, still = 0;
  double most = 0;
};

/// A motion of an arm from joints q0 to q1 (rad), the radii (m) that bound it, and the
/// displacements of the groups at its ends.
struct BoundedMotion {
  const Chain& chain;
  const std::array<double, kDof>& radii;
  Config q0, q1;
  std::vector<Pose> G0, G1;
  /// Returns the bound (m) by the joints between two groups.
  [[nodiscard]] double bound(int group_a, int group_b) const {
    const Chain::Joints joints = chain.joints_between(group_a, group_b);
    double sum = 0;
    for (int j = joints.first; j < joints.last; ++j)
      sum += std::abs(q1[j] - q0[j]) * radii[static_cast<std::size_t>(j)];
    return sum;
  }
};

/// Draws a motion within the limits, of some of the joints.
BoundedMotion random_motion(const Chain& chain, const std::array<double, kDof>& radii,
                            Random& random) {
  const Config q0 = random_config(chain, random);
  Config q1 = q0;
  const double length = random.coin() ? 0.3 : 1e-3;
  for (int j = 0; j < kDof; ++j)
    if (random.coin(0.4))
      q1[j] = std::clamp(q1[j] + random.uniform(-length, length), chain.limit[j].lower,
                         chain.limit[j].upper);
  return {chain, radii, q0, q1, chain.all_displacements(q0), chain.all_displacements(q1)};
}

/// Checks that no point of a body moves further than the bound.
void check_points(const BoundedMotion& motion, const RobotBody& body, int trial,
                  RadiiCounts& counts) {
  const auto move = [&](const Pose& from, const Pose& to, const Vector3d& x) {
    return (to * x - from * x).norm();
  };
  const auto g = static_cast<std::size_t>(body.group);
  for (const Ball& ball : bounding_balls(body.shape))
    for (int side = 0; side < 6; ++side, ++counts.points) {
      const Vector3d x =
          body.pose * (ball.center + ball.radius * (side % 2 ? 1 : -1) * Vector3d::Unit(side / 2));
      const double moved = move(motion.G0[g], motion.G1[g], x),
                   most_allowed = motion.bound(0, body.group);
      ASSERT_LE(moved, most_allowed + 1e-12) << trial << " " << body.name;
      if (most_allowed > 0) counts.most = std::max(counts.most, moved / most_allowed);
    }
}

/// Checks that two points, of bodies of different groups, come nearer or further by no more than
/// the bound.
void check_pair(const BoundedMotion& motion, const RobotBody& a, const RobotBody& b, int trial,
                RadiiCounts& counts) {
  ++counts.pairs;
  const std::vector<Pose>&G0 = motion.G0, &G1 = motion.G1;
  const Vector3d x = a.pose * bounding_balls(a.shape)[0].center,
                 y = b.pose * bounding_balls(b.shape)[0].center;
  const auto ga = static_cast<std::size_t>(a.group), gb = static_cast<std::size_t>(b.group);
  const double before = (G0[ga] * x - G0[gb] * y).norm(), after = (G1[ga] * x - G1[gb] * y).norm();
  const double allowed = motion.bound(a.group, b.group);
  ASSERT_LE(std::abs(after - before), allowed + 1e-12) << trial << " " << a.name << " " << b.name;
  counts.still += allowed == 0;
}

/// Radii bound the motion of one body and of two: no point moves further than joints times radii
/// say, and only joints between two groups move one against the other.
TEST(Linkage, RadiiBoundEveryPointThatMoves) {
  const std::uint64_t base = seed("Linkage.Radii");
  RadiiCounts counts;
  for (int trial = 0; trial < trials(200); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const RandomArm robot = random_arm(random);
    const ArmModel arm = build(robot, {});
    const auto bodies = robot_bodies(robot.model, arm, {});
    const auto radii = motion_radii(arm.chain, bodies);
    for (int k = 0; k < 10; ++k) {
      const BoundedMotion motion = random_motion(arm.chain, radii, random);
      for (const RobotBody& body : bodies) {
        check_points(motion, body, trial, counts);
        if (HasFatalFailure()) return;
      }
      for (int pair = 0; pair < 20; ++pair) {
        const RobotBody
            &a = bodies[static_cast<std::size_t>(random.below(static_cast<int>(bodies.size())))],
            &b = bodies[static_cast<std::size_t>(random.below(static_cast<int>(bodies.size())))];
        if (a.group == b.group) continue;
        check_pair(motion, a, b, trial, counts);
        if (HasFatalFailure()) return;
      }
    }
  }
  std::printf("%d points, %d pairs, %d of them at rest; at most %.2f of the bound\n", counts.points,
              counts.pairs, counts.still, counts.most);
  EXPECT_GE(counts.points, at_least(50'000));
  EXPECT_GE(counts.pairs, at_least(20'000));
  EXPECT_GE(counts.still, at_least(300));
  EXPECT_GE(counts.most, 0.5);
}

/// iiwa14 with one more link behind a joint that mimics joint 3, on link 2.
RobotModel balanced(double multiplier, double offset, Joint::Type type = Joint::Type::kRevolute) {
  RobotModel model = *data_robot("iiwa14").model;
  Joint joint;
  joint.name = "balancer";
  joint.type = type;
  joint.parent_link = model.find_link("link_2");
  joint.child_link = static_cast<int>(model.links.size());
  joint.lower = -1.5;
  joint.upper = 1;
  joint.velocity = 0.5;
  joint.mimic = Joint::Mimic{model.find_joint("joint_a3"), multiplier, offset};
  model.links.push_back(
      {"rod", {{Sphere{0.05}, Pose::Identity()}}, static_cast<int>(model.joints.size())});
  model.joints.push_back(joint);
  return model;
}

ArmModel arm_of_iiwa(const RobotModel& model, const std::map<std::string, double>& hold = {}) {
  return build_arm(model, "base_link", "tool0", hold, Pose::Identity());
}

std::string refusal(const RobotModel& model, const std::map<std::string, double>& hold = {}) {
  try {
    (void)arm_of_iiwa(model, hold);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Linkage, LimitsAndRatesOfALinkageBoundItsLeader) {
  const JointLimit alone = arm_of_iiwa(*data_robot("iiwa14").model).chain.limit[2];
  const ArmModel arm = arm_of_iiwa(balanced(-2, 0.5));
  ASSERT_EQ(arm.chain.followers.size(), 1u);
  const JointLimit limit = arm.chain.limit[2];
  EXPECT_EQ(limit.lower, -0.25);  // -2 q + 0.5 <= 1
  EXPECT_EQ(limit.upper, 1);      // -2 q + 0.5 >= -1.5
  EXPECT_EQ(limit.velocity, 0.25);
  EXPECT_LT(alone.lower, limit.lower);
  EXPECT_GT(alone.upper, limit.upper);
  EXPECT_NE(refusal(balanced(0.01, 5)).find("no position of it is within the limits of both"),
            std::string::npos);
}

TEST(Linkage, RefusesWhatIsElsewhereAfterAWholeTurn) {
  const auto around = [](RobotModel model) {
    Joint& leader = model.joints[static_cast<std::size_t>(model.find_joint("joint_a3"))];
    leader.lower = -4;
    leader.upper = 4;
    model.joints.back().lower = -100;
    model.joints.back().upper = 100;
    return model;
  };
  EXPECT_EQ(refusal(around(balanced(-1, 0))), "accepted");
  for (const RobotModel& model :
       {around(balanced(0.5, 0)), around(balanced(1, 0, Joint::Type::kPrismatic))})
    EXPECT_NE(refusal(model).find(
                  "joint 'balancer' mimics 'joint_a3' of the arm, which can make a whole turn"),
              std::string::npos)
        << refusal(model);
}

TEST(Linkage, RefusesAnArmThatMimicsItself) {
  RobotModel model = *data_robot("iiwa14").model;
  Joint& joint = model.joints[static_cast<std::size_t>(model.find_joint("joint_a4"))];
  joint.mimic = Joint::Mimic{model.find_joint("joint_a2"), -1, 0};
  try {
    (void)build_arm(model, "base_link", "tool0", {}, Pose::Identity(), Roll{});
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("joint 'joint_a4', between 'base_link' and 'tool0', mimics 'joint_a2' of "
                        "the arm: not "
                        "supported"),
              std::string::npos)
        << error.what();
  }
}

/// iiwa14 on a cart, with a rail above the base, a joint that mimics it, and one beside the arm.
struct RailedArm {
  RobotModel model = *data_robot("iiwa14").model;
  int rail = static_cast<int>(model.joints.size()), post = rail + 1;

  RailedArm() {
    const int root = model.root_link, first = static_cast<int>(model.links.size());
    model.links.push_back({"hall", {}, -1});
    model.links.push_back({"cart", {}, rail});
    model.links.push_back({"aside", {}, rail + 2});
    add("rail", Joint::Type::kPrismatic, first, first + 1, 0.5, 4);
    add("post", Joint::Type::kRevolute, first + 1, root, -1, 1);
    add("lamp", Joint::Type::kRevolute, first + 1, first + 2, -1, 1);
    model.links[static_cast<std::size_t>(root)].parent_joint = post;
    model.root_link = first;
    model.joints[static_cast<std::size_t>(post)].mimic = Joint::Mimic{rail, 0.25, 0};
  }
  void add(const char* name, Joint::Type type, int parent, int child, double lower, double upper) {
    Joint joint;
    joint.name = name;
    joint.type = type;
    joint.parent_link = parent;
    joint.child_link = child;
    joint.lower = lower;
    joint.upper = upper;
    model.joints.push_back(joint);
  }
  /// Returns the joints held between hall and tool where the problem holds `hold`.
  [[nodiscard]] std::vector<HeldJoint> held(const std::map<std::string, double>& hold) const {
    return build_arm(model, "hall", "tool0", hold, Pose::Identity()).held;
  }
};

TEST(Held, AreNamedWithWhereTheyStand) {
  const RailedArm arm;
  const std::vector<HeldJoint> still = arm.held({});
  ASSERT_EQ(still.size(), 2u);
  EXPECT_EQ(words(still), "rail at 0.5 m, post at 0.125 rad (as rail)");
  EXPECT_EQ(with_held(still), " with rail held at 0.5 m, post held at 0.125 rad");
  const auto warnings = held_warnings(still);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0],
            "joint 'rail' lies between base and tip and is not planned: it is held at 0.5 m: "
            "robot.hold: {rail: POSITION} says where "
            "it stands");
  const std::vector<HeldJoint> given = arm.held({{"rail", 2.0}});
  EXPECT_EQ(words(given), "rail at 2 m, post at 0.5 rad (as rail)");
  EXPECT_TRUE(held_warnings(given).empty());

  // An eighth joint, and the torso of two arms.
  const TestRobot torso = data_robot("sda5f");
  EXPECT_EQ(words(arm_of(torso).held), "torso_joint_b1 at 0 rad");
}

TEST(Held, AreNoneWhereEveryJointIsPlanned) {
  EXPECT_TRUE(arm_of_iiwa(RailedArm().model).held.empty());
  EXPECT_EQ(words(arm_of_iiwa(*data_robot("iiwa14").model).held), "");
  EXPECT_EQ(with_held({}), "");
}

TEST(Held, KeepTheLimitsOfWhatMimicsThem) {
  RailedArm arm;
  try {
    (void)arm.held({{"rail", 3.9}});
    (void)arm.held({{"rail", 4.0}});
    arm.model.joints[static_cast<std::size_t>(arm.post)].upper = 0.9;
    (void)arm.held({{"rail", 4.0}});
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(
        std::string(error.what())
            .find("robot.hold: joint 'rail' at 4: joint 'post', which mimics it, is then at 1 "
                  "and is outside its limits"),
        std::string::npos)
        << error.what();
  }
  EXPECT_EQ(arm.held({{"rail", 3.5}}).size(), 2u);
}

}  // namespace
}  // namespace swivel
