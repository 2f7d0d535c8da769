// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <string>

#include "robots.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {
namespace {

using namespace test;

/// Sums over a Config have the bits of sums over seven numbers, and what is computed of
/// configurations stays zero behind the arm's coordinates.
TEST(Config, AddsUpAsSevenNumbersAndStaysZeroBehind) {
  using Seven = Eigen::Matrix<double, kDof, 1>;
  Random random(seed("Config.AddsUpAsSevenNumbersAndStaysZeroBehind"));
  const auto draw = [&] {
    Seven values;
    for (double& value : values) value = random.uniform(-1, 1) * std::pow(10, random.below(9) - 4);
    return values;
  };
  const auto is_arm = [](const Config& q) { return q.tail<kMaxDof - kDof>().isZero(0); };
  const int count = trials(2000);
  for (int trial = 0; trial < count; ++trial) {
    const Seven a = draw(), b = draw(), scale = draw().cwiseAbs();
    const Config p = a, q = Config::of(b.data()), w = scale;
    ASSERT_EQ(joint_sum(p), a.sum());
    ASSERT_EQ(joint_norm(p), a.norm());
    ASSERT_EQ(joint_dot(p, q), a.dot(b));
    ASSERT_EQ(joint_norm(w.cwiseProduct(p - q)), scale.cwiseProduct(a - b).norm());
    ASSERT_EQ(joint_squared_norm(2 * p + q / 3), (2 * a + b / 3).squaredNorm());
    ASSERT_EQ(p.coordinates(), a);
    Config r = p + Config::Constant(0.5) - random.uniform(-3, 3) * q;
    ASSERT_TRUE(is_arm(r));
    r = a.head<3>();
    ASSERT_TRUE(r.head<3>() == a.head<3>() && r.tail<kMaxDof - 3>().isZero(0));
  }
  std::printf("%d pairs of configurations\n", count);
  EXPECT_TRUE(is_arm(Config()) && is_arm(Config::Ones()));
  EXPECT_EQ((Config{1, 2, 3}), (Config{1, 2, 3, 0, 0, 0, 0}));
}

TEST(Arm, Sda5fHasTheDimensionsOfItsDataSheet) {
  const TestRobot robot = data_robot("sda5f");
  const Chain chain = arm_of(robot).chain;
  const SrsArm srs = fit_srs(chain, robot.name);
  EXPECT_LT((srs.S - Vector3d(0.195, 0.243, 0.900)).norm(), 1e-9);
  EXPECT_NEAR(srs.upper, std::hypot(0.270, 0.085), 1e-9);
  EXPECT_NEAR(srs.fore, std::hypot(0.270, 0.060), 1e-9);
  EXPECT_NEAR(srs.wrist_in_tool.norm(), 0.148, 1e-9);
  Config q = Config::Zero();
  q[3] = kPi / 3;  // the straight arm
  EXPECT_NEAR(std::sin(srs.elbow_angle(q)), 0, 1e-3);
  // Experiment A: shoulder to wrist along the line.
  const double expected[] = {0.429, 0.354, 0.294, 0.261, 0.263, 0.301};
  for (int k = 0; k < 6; ++k) {
    Pose tool = Pose::Identity();
    tool.linear() = Eigen::AngleAxisd(-kPi / 2, Vector3d::UnitY()).toRotationMatrix();
    tool.translation() = Vector3d(0.6, -0.1 + 0.1 * k, 0.9);
    EXPECT_NEAR((wrist_centre(srs, tool) - srs.S).norm(), expected[k], 6e-4);
  }
}

/// Seen from the hand, the arm is the same with its joints in the other order: what stood moves,
/// and what moved stands.
TEST(Arm, TheHandMayBeTheBase) {
  Random random(seed("Arm.TheHandMayBeTheBase"));
  double worst = 0;
  int links = 0;
  for (const TestRobot& robot : all_robots()) {
    const ArmModel from_base = arm_of(robot);
    std::map<std::string, double> others;  // a torso's joints are on the way as well
    for (const Joint& joint : robot.model->joints)
      if (const auto& own = from_base.chain.joint_names;
          joint.movable() && !joint.mimic && std::count(own.begin(), own.end(), joint.name) == 0)
        others[joint.name] =
            joint.type == Joint::Type::kContinuous ? 0 : std::clamp(0.0, joint.lower, joint.upper);
    const ArmModel from_hand =
        build_arm(*robot.model, robot.tip_link, robot.base_link, others, Pose::Identity());
    for (std::size_t k = 0; k < kDof; ++k) {
      ASSERT_EQ(from_hand.chain.joint_names[k], from_base.chain.joint_names[kDof - 1 - k]);
      ASSERT_EQ(from_hand.chain.limit[k].lower, from_base.chain.limit[kDof - 1 - k].lower);
      ASSERT_EQ(from_hand.chain.limit[k].upper, from_base.chain.limit[kDof - 1 - k].upper);
    }
    const auto hand = static_cast<std::size_t>(robot.model->find_link(robot.tip_link));
    for (int trial = 0; trial < trials(100); ++trial) {
      const Config q = random_config(from_base.chain, random);
      const auto G = from_base.chain.displacements(q),
                 H = from_hand.chain.displacements(q.coordinates().reverse());
      const auto pose = [&](const ArmModel& arm, const auto& moved, std::size_t link) {
        return moved[static_cast<std::size_t>(arm.links[link].group)] * arm.links[link].pose;
      };
      const Pose hand_in_base = pose(from_base, G, hand);
      for (std::size_t link = 0; link < robot.model->links.size(); ++link, ++links)
        worst = std::max(worst, (pose(from_hand, H, link).matrix() -
                                 (hand_in_base.inverse() * pose(from_base, G, link)).matrix())
                                    .lpNorm<Eigen::Infinity>());
    }
  }
  std::printf("%d poses of links, worst error %.1e\n", links, worst);
  EXPECT_GE(links, at_least(1000));
  EXPECT_LT(worst, 1e-12);
}

TEST(Arm, HeldJointsAreNoneOfTheArms) {
  const TestRobot robot = data_robot("sda5f");
  const std::string last = arm_of(robot).chain.joint_names.back(),
                    first = arm_of(robot).chain.joint_names.front();
  const ArmModel held =
      build_arm(*robot.model, robot.base_link, robot.tip_link, {{last, 0.5}}, Pose::Identity());
  EXPECT_EQ(held.chain.joint_names[1], first);  // after the torso's
  EXPECT_EQ(std::count(held.chain.joint_names.begin(), held.chain.joint_names.end(), last), 0);
  const TestRobot seven = data_robot("iiwa14");
  const std::string only = arm_of(seven).chain.joint_names[3];
  const ArmModel six =
      build_arm(*seven.model, seven.base_link, seven.tip_link, {{only, 0.5}}, Pose::Identity());
  EXPECT_TRUE(six.chain.roll_fixed);
  EXPECT_EQ(six.chain.coordinates(), 6u);
}

TEST(Arm, DisplacementsAreTurnsAboutTheAxes) {
  Random random(seed("Arm.Displacements"));
  double worst = 0;
  int compared = 0;
  for (const TestRobot& robot : all_robots()) {
    const Chain chain = arm_of(robot).chain;
    for (int trial = 0; trial < trials(200); ++trial) {
      const Config q = random_config(chain, random);
      const auto G = chain.displacements(q);
      Pose expected = Pose::Identity();
      for (std::size_t k = 0; k < kDof; ++k) {
        expected = expected * Eigen::Translation3d(chain.point[k]) *
                   Eigen::AngleAxisd(q[static_cast<Eigen::Index>(k)], chain.axis[k]) *
                   Eigen::Translation3d(-chain.point[k]);
        worst = std::max(worst, (G[k + 1].matrix() - expected.matrix()).lpNorm<Eigen::Infinity>());
        ++compared;
      }
      const Vector3d point = chain.tool_point(q.array().cos().matrix(), q.array().sin().matrix());
      worst = std::max(
          {worst, (point - expected * chain.home.translation()).norm(),
           (chain.tool(q).matrix() - (expected * chain.home).matrix()).lpNorm<Eigen::Infinity>()});
    }
  }
  std::printf("%d displacements, worst error %.1e\n", compared, worst);
  EXPECT_LT(worst, 1e-14 * 10);
}

TEST(Arm, JacobianIsTheDerivativeOfTheTool) {
  Random random(seed("Arm.Jacobian"));
  for (const TestRobot& robot : all_robots()) {
    const Chain chain = arm_of(robot).chain;
    for (int trial = 0; trial < trials(50); ++trial) {
      const Config q = random_config(chain, random);
      const auto J = chain.jacobian(q);
      for (int k = 0; k < kDof; ++k) {
        const double h = 1e-6;
        const Pose ahead = chain.tool(q + h * Config::Unit(k)),
                   behind = chain.tool(q - h * Config::Unit(k));
        const Vector3d linear = (ahead.translation() - behind.translation()) / (2 * h);
        const Eigen::AngleAxisd turn(ahead.linear() * behind.linear().transpose());
        EXPECT_LT((J.block<3, 1>(0, k) - linear).norm(), 1e-7);
        EXPECT_LT((J.block<3, 1>(3, k) - turn.axis() * turn.angle() / (2 * h)).norm(), 1e-7);
      }
    }
  }
}

TEST(Arm, MotionRadiiBoundEveryPointThatMoves) {
  Random random(seed("Arm.MotionRadii"));
  int moved = 0;
  for (const TestRobot& robot : all_robots()) {
    const ArmModel arm = arm_of(robot);
    const auto bodies = robot_bodies(*robot.model, arm, {});
    const auto radii = motion_radii(arm.chain, bodies);
    for (int trial = 0; trial < trials(200); ++trial) {
      const Config q0 = random_config(arm.chain, random);
      Config q1 = q0;
      for (int j = 0; j < kDof; ++j) q1[j] += random.uniform(-0.3, 0.3);
      double bound = 0;
      for (int j = 0; j < kDof; ++j)
        bound += std::abs(q1[j] - q0[j]) * radii[static_cast<std::size_t>(j)];
      const auto G0 = arm.chain.displacements(q0), G1 = arm.chain.displacements(q1);
      for (const RobotBody& body : bodies)
        for (const Ball& ball : bounding_balls(body.shape)) {
          // The farthest point of the ball from where it was: centre motion plus what its turn
          // adds, bounded by sampling its surface.
          for (int k = 0; k < 6; ++k) {
            const Vector3d x =
                body.pose * (ball.center + ball.radius * (k % 2 ? 1 : -1) * Vector3d::Unit(k / 2));
            const auto g = static_cast<std::size_t>(body.group);
            EXPECT_LE((G1[g] * x - G0[g] * x).norm(), bound + 1e-12) << robot.name;
            ++moved;
          }
        }
    }
  }
  EXPECT_GE(moved, at_least(10001));
}

TEST(Arm, RefusesWhatIsNotSrsAndSaysWhichAxesMiss) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ(),
                 o = Vector3d::Zero();
  // Axis 7 offset by 88 mm from the others: the Panda's class.
  const TestRobot panda_like = synthetic_robot("panda_like",
                                               {{z * 0.333, z, -2.9, 2.9},
                                                {o, y, -1.8, 1.8},
                                                {z * 0.316, z, -2.9, 2.9},
                                                {x * 0.0825, -y, -3, 0},
                                                {z * 0.384 - x * 0.0825, z, -2.9, 2.9},
                                                {o, -y, 0, 3.7},
                                                {x * 0.088, -z, -2.9, 2.9}},
                                               -z * 0.107, 0.05);
  try {
    (void)fit_srs(arm_of(panda_like).chain, "panda_like");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("axes 6 and 7 miss each other by"), std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("88.0 mm"), std::string::npos) << error.what();
  }
}

TEST(Arm, HeldJointsAndWrongNames) {
  const TestRobot robot = data_robot("sda5f");
  const Pose none = Pose::Identity();
  EXPECT_THROW((void)build_arm(*robot.model, "nowhere", robot.tip_link, {}, none), InputError);
  EXPECT_THROW((void)build_arm(*robot.model, robot.base_link, "nowhere", {}, none), InputError);
  EXPECT_THROW((void)build_arm(*robot.model, robot.base_link, "arm_left_link_4_u", {}, none),
               InputError);
  EXPECT_THROW(
      (void)build_arm(*robot.model, robot.base_link, robot.tip_link, {{"nope", 0.0}}, none),
      InputError);
  EXPECT_THROW((void)build_arm(*robot.model, robot.base_link, robot.tip_link,
                               {{"torso_joint_b1", 9.0}}, none),
               InputError);
  const Chain turned =
      build_arm(*robot.model, robot.base_link, robot.tip_link, {{"torso_joint_b1", 0.5}}, none)
          .chain;
  const Chain straight = arm_of(robot).chain;
  const Eigen::AngleAxisd turn(0.5, Vector3d::UnitZ());
  const Vector3d axis_of_torso(0.045, 0, 0);
  EXPECT_LT((turned.tool(Config::Zero()).translation() -
             (turn * (straight.tool(Config::Zero()).translation() - axis_of_torso) + axis_of_torso))
                .norm(),
            1e-9);
}

/// sda5f behind three prismatic joints m1, m2, m3 along x, y, z; m1 follows m2 and m2 follows m3.
/// In the order of `order` in the file.
RobotModel mimicking(const std::array<int, 3>& order) {
  RobotModel model = *data_robot("sda5f").model;
  const int first_link = static_cast<int>(model.links.size()),
            first_joint = static_cast<int>(model.joints.size());
  std::array<int, 3> index{};
  for (int place = 0; place < 3; ++place)
    index[static_cast<std::size_t>(order[static_cast<std::size_t>(place)])] = first_joint + place;
  for (int k = 0; k < 3; ++k)
    model.links.push_back(
        {"w" + std::to_string(k), {}, k == 0 ? -1 : index[static_cast<std::size_t>(k) - 1]});
  model.joints.resize(model.joints.size() + 3);
  for (std::size_t k = 0; k < 3; ++k) {
    Joint& joint = model.joints[static_cast<std::size_t>(index[k])];
    joint.name = "m" + std::to_string(k + 1);
    joint.type = Joint::Type::kPrismatic;
    joint.parent_link = first_link + static_cast<int>(k);
    joint.child_link = k < 2 ? first_link + static_cast<int>(k) + 1 : model.root_link;
    joint.axis = Vector3d::Unit(static_cast<Eigen::Index>(k));
    joint.lower = -10, joint.upper = 10;
    if (k < 2) joint.mimic = Joint::Mimic{index[k + 1], 2, 0.1};
  }
  model.links[static_cast<std::size_t>(model.root_link)].parent_joint = index[2];
  model.root_link = first_link;
  return model;
}

TEST(Arm, MimicJointsFollowTheirLeadersInAnyOrderOfTheFile) {
  const Pose none = Pose::Identity();
  const TestRobot robot = data_robot("sda5f");
  const Vector3d alone = arm_of(robot).chain.home.translation();
  std::array<int, 3> order{0, 1, 2};
  int orders = 0;
  do {
    const RobotModel model = mimicking(order);
    const Chain chain = build_arm(model, "w0", robot.tip_link, {{"m3", 0.5}}, none).chain;
    EXPECT_LT((chain.home.translation() - alone - Vector3d(2.3, 1.1, 0.5)).norm(), 1e-12)
        << chain.home.translation().transpose();
    ++orders;
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(orders, 6);

  RobotModel loop = mimicking(order);
  const int m1 = loop.find_joint("m1");
  loop.joints[static_cast<std::size_t>(loop.find_joint("m3"))].mimic = Joint::Mimic{m1, 1, 0};
  EXPECT_THROW((void)build_arm(loop, "w0", robot.tip_link, {}, none), InputError);
  loop.joints[static_cast<std::size_t>(m1)].mimic->joint = m1;
  EXPECT_THROW((void)build_arm(loop, "w0", robot.tip_link, {}, none), InputError);
  RobotModel of_arm = mimicking(order);
  of_arm.joints[static_cast<std::size_t>(of_arm.find_joint("m3"))].mimic =
      Joint::Mimic{of_arm.find_joint("arm_left_joint_1_s"), 1, 0};
  EXPECT_THROW((void)build_arm(of_arm, "w0", robot.tip_link, {}, none), InputError);
}

/// A long chain that the file lists from its end, so that every parent comes after its child.
TEST(Arm, LongChainsNeedNoStackAndLinearTime) {
  constexpr int kLinks = 300000;
  RobotModel model = *data_robot("sda5f").model;
  const int first_link = static_cast<int>(model.links.size());
  for (int k = 0; k < kLinks; ++k) {
    Joint joint;
    joint.name = "c" + std::to_string(k);
    joint.parent_link = k + 1 < kLinks ? first_link + k + 1 : model.find_link("arm_left_link_7_t");
    joint.child_link = first_link + k;
    joint.origin.translation() = Vector3d(1e-6, 0, 0);
    model.links.push_back({"l" + std::to_string(k), {}, static_cast<int>(model.joints.size())});
    model.joints.push_back(joint);
  }
  const ArmModel arm = build_arm(model, "base_link", "l0", {}, Pose::Identity());
  const TestRobot robot = data_robot("sda5f");
  EXPECT_NEAR((arm.chain.home.translation() - arm_of(robot).chain.home.translation()).norm(),
              1e-6 * kLinks, 1e-6);
  EXPECT_EQ(arm.links[static_cast<std::size_t>(first_link)].group, kDof);
}

TEST(Arm, CylinderWithTwoSpheresReadsAsACapsule) {
  RobotModel model;
  model.links.push_back({"base", {}, -1});
  PlacedShape cylinder{Cylinder{0.05, 0.3}, Pose(Eigen::Translation3d(0.1, 0, 0) *
                                                 Eigen::AngleAxisd(0.7, Vector3d::UnitX()))};
  PlacedShape top{Sphere{0.05}, Pose(Eigen::Translation3d(cylinder.pose * Vector3d(0, 0, 0.15)))};
  PlacedShape bottom{Sphere{0.05},
                     Pose(Eigen::Translation3d(cylinder.pose * Vector3d(0, 0, -0.15)))};
  PlacedShape lone{Sphere{0.05}, Pose::Identity()};
  model.links[0].collision = {lone, top, cylinder, bottom};
  ArmModel arm;
  arm.links.resize(1);
  const auto bodies = robot_bodies(model, arm, {});
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_TRUE(std::holds_alternative<Sphere>(bodies[0].shape));
  ASSERT_TRUE(std::holds_alternative<Capsule>(bodies[1].shape));
  EXPECT_EQ(std::get<Capsule>(bodies[1].shape).length, 0.3);
}

/// Limits and speeds of a URDF that has degrees are suspected, once for all joints.
TEST(Scale, JointsInDegreesAreSuspected) {
  const TestRobot robot = data_robot("iiwa14");
  const Chain chain = arm_of(robot).chain;
  Robot whole;
  auto model = std::make_shared<RobotModel>(*robot.model);
  whole.model = model;
  EXPECT_TRUE(scale_warnings(chain, whole).empty());
  Joint& second = model->joints[static_cast<std::size_t>(model->find_joint(chain.joint_names[1]))];
  second.velocity = 98;
  ASSERT_EQ(scale_warnings(chain, whole).size(), 1u);
  EXPECT_EQ(scale_warnings(chain, whole)[0],
            model->source + ":" + std::to_string(second.line) + ": joint '" + second.name +
                "' may turn at 98 rad/s: are these degrees? Angles are read as radians");
  second.lower = -120, second.upper = 120;
  Joint& last = model->joints[static_cast<std::size_t>(model->find_joint(chain.joint_names[6]))];
  last.lower = -175, last.upper = 175;
  ASSERT_EQ(scale_warnings(chain, whole).size(), 1u);
  EXPECT_NE(scale_warnings(chain, whole)[0].find(
                "may turn from -120 to 120 rad, at 98 rad/s, and 1 more joint: are these degrees?"),
            std::string::npos)
      << scale_warnings(chain, whole)[0];
  second.velocity = 1;
  for (Joint* const joint : {&second, &last}) {  // a joint without limits
    joint->lower = -1e9, joint->upper = 1e9;
  }
  EXPECT_TRUE(scale_warnings(chain, whole).empty());
}

TEST(Scale, SpeedsOfMillimetresAreRefused) {
  const TestRobot robot = data_robot("iiwa14");
  const Chain chain = arm_of(robot).chain;
  EXPECT_NO_THROW(require_tool_speed(chain, 5, "speed"));
  EXPECT_THROW(require_tool_speed(chain, 50, "speed"), InputError);
  EXPECT_TRUE(tool_speed_warnings(chain, most_tool_speed(chain), "speed").empty());
}

/// What a file says so large is refused at its line; problems made in memory are warned of.
TEST(Scale, LimitsOfMillimetresAreSuspected) {
  const TestRobot robot = data_robot("iiwa14");
  const Chain chain = arm_of(robot).chain;
  PathProblem problem;
  EXPECT_TRUE(limit_scale_warnings(chain, problem).empty());
  problem.limits.clearance = 0.5;
  problem.limits.tool_path_error = 0.05;
  problem.limits.tool_speed = 5;
  EXPECT_TRUE(limit_scale_warnings(chain, problem).empty());
  problem.limits.clearance = problem.limits.self_clearance.emplace(5);
  problem.limits.tool_path_error = 1;
  problem.limits.edge_tolerance = 0.5;
  problem.limits.tool_speed = 100;
  problem.smooth = PathSmoothing{1, 0.001};
  const std::vector<std::string> warnings = limit_scale_warnings(chain, problem);
  ASSERT_EQ(warnings.size(), 6u);
  EXPECT_EQ(warnings[0].find("limits.clearance is 5 m, and the arm reaches 1."), 0u) << warnings[0];
  EXPECT_NE(warnings[0].find(" m: are these millimetres? Lengths are read as metres"),
            std::string::npos)
      << warnings[0];
  EXPECT_EQ(warnings[3].find("limits.tool_path_error is 1 m, "), 0u) << warnings[3];
  EXPECT_EQ(warnings[4].find("limits.tool_speed is 100 m/s, "), 0u) << warnings[4];
  EXPECT_EQ(warnings[5].find("path.smooth.position is 1 m, "), 0u) << warnings[5];
}

}  // namespace
}  // namespace swivel
