// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "seed.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/io/io.hpp"

namespace swivel::test {

/// A robot of the data folder, or one made here, ready for problems.
struct TestRobot {
  std::string name;
  std::shared_ptr<const RobotModel> model;  // shared: as PathProblem holds it
  std::string base_link, tip_link;
};

inline std::filesystem::path data_dir() {
  return SWIVEL_DATA_DIR;
}

inline TestRobot data_robot(const std::string& name) {
  const auto file = [&](const char* end) { return data_dir() / "robots" / (name + end); };
  TestRobot robot{name, io::load_robot(file(".urdf"), file(".srdf")), "base_link",
                  name == "iiwa14" ? "tool0" : "arm_left_link_7_t"};
  return robot;
}

/// A joint of an arm that is built from axes and origins, for classes that no file of the data
/// folder has. synthetic_robot() puts seven of them in a row; link k carries a capsule along the
/// way to joint k + 1.
struct SyntheticJoint {
  Vector3d origin, axis;
  double lower, upper;
  bool continuous = false;
};
inline TestRobot synthetic_robot(const std::string& name, const std::vector<SyntheticJoint>& joints,
                                 const Vector3d& tip, double radius) {
  auto model = std::make_shared<RobotModel>();
  model->name = model->source = name;
  model->links.push_back({"base", {}, -1});
  for (std::size_t k = 0; k < joints.size(); ++k) {
    Joint joint;
    joint.name = "j" + std::to_string(k + 1);
    joint.type = joints[k].continuous ? Joint::Type::kContinuous : Joint::Type::kRevolute;
    joint.parent_link = static_cast<int>(k);
    joint.child_link = static_cast<int>(k) + 1;
    joint.origin.translation() = joints[k].origin;
    joint.axis = joints[k].axis.normalized();
    joint.lower = joints[k].lower;
    joint.upper = joints[k].upper;
    joint.velocity = 2.0;
    model->joints.push_back(joint);
    Link link{"l" + std::to_string(k + 1), {}, static_cast<int>(k)};
    const Vector3d end = k + 1 < joints.size() ? joints[k + 1].origin : tip;
    if (end.norm() > 3 * radius) {
      PlacedShape shape;
      shape.shape = Capsule{radius, end.norm() - 2 * radius};
      shape.pose.linear() = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), end).toRotationMatrix();
      shape.pose.translation() = end / 2;
      link.collision.push_back(shape);
    }
    model->links.push_back(link);
  }
  Joint fixed;
  fixed.name = "tip_joint";
  fixed.parent_link = static_cast<int>(joints.size());
  fixed.child_link = fixed.parent_link + 1;
  fixed.origin.translation() = tip;
  model->joints.push_back(fixed);
  model->links.push_back({"tip", {}, static_cast<int>(joints.size())});
  return {name, model, "base", "tip"};
}

/// Returns an arm with z-y-z shoulder and wrist, whose joints 1, 3, 5 and 7 are continuous.
inline TestRobot continuous_robot() {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ(),
                 o = Vector3d::Zero();
  (void)x;
  return synthetic_robot("continuous",
                         {{z * 0.3, z, 0, 0, true},
                          {o, y, -2.1, 2.1},
                          {o, z, 0, 0, true},
                          {z * 0.42, y, -2.4, 2.4},
                          {z * 0.4, z, 0, 0, true},
                          {o, y, -2.0, 2.0},
                          {o, z, 0, 0, true}},
                         z * 0.15, 0.05);
}
/// Returns an arm with x-y-z shoulder and wrist, an elbow offset in the plane of the arm,
/// asymmetric limits, and joints 1 and 7 that turn by more than a turn.
inline TestRobot windings_robot() {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ(),
                 o = Vector3d::Zero();
  return synthetic_robot("windings",
                         {{z * 0.3, x, -4.4, 4.0},
                          {o, y, -2.6, 2.6},
                          {o, z, -3.0, 3.0},
                          {z * 0.35 + x * 0.06, y, -2.5, 2.2},
                          {z * 0.32 - x * 0.06, z, -3.0, 3.0},
                          {o, y, -2.4, 2.4},
                          {o, x, -6.0, 6.0}},
                         z * 0.12, 0.05);
}

/// Returns an arm of seven joints of which no three meet in a point; joint 7 turns without end.
inline TestRobot offset_robot() {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  return synthetic_robot("offsets",
                         {{z * 0.3, z, -2.9, 2.9},
                          {x * 0.05, y, -2.0, 2.0},
                          {y * 0.04, z, -2.9, 2.9},
                          {z * 0.38 + x * 0.06, y, -2.3, 2.3},
                          {z * 0.33 - y * 0.05, z, -2.9, 2.9},
                          {x * 0.08, y, -2.0, 2.0},
                          {z * 0.06, x, 0, 0, true}},
                         z * 0.12, 0.04);
}

/// Returns the robot with the joints of its arm changed, their limits for example, by
/// change(number of the joint, 0 ... 6, joint).
template <class Change>
TestRobot with_limits(const TestRobot& robot, const Change& change) {
  auto model = std::make_shared<RobotModel>(*robot.model);
  int number = 0;
  for (const std::string& name :
       build_arm(*robot.model, robot.base_link, robot.tip_link, {}, Pose::Identity())
           .chain.joint_names)
    change(number++, model->joints[static_cast<std::size_t>(model->find_joint(name))]);
  return {robot.name, model, robot.base_link, robot.tip_link};
}

/// Returns the robot without its SRDF.
inline TestRobot without_srdf(TestRobot robot) {
  auto model = std::make_shared<RobotModel>(*robot.model);
  model->has_srdf = false;
  model->disabled_pairs.clear();
  robot.model = model;
  robot.name += " without SRDF";
  return robot;
}

/// Returns a robot without SRDF whose links 5 and 7 are some 2 mm apart, whatever the joints, and
/// meet where sin q6 cos q7 > 0.91.
inline TestRobot near_wrist_robot() {
  TestRobot robot = continuous_robot();
  auto model = std::make_shared<RobotModel>(*robot.model);
  const auto put = [&](const char* name, const Shape& shape, const Vector3d& at) {
    PlacedShape placed;
    placed.shape = shape;
    placed.pose.translation() = at;
    model->links[static_cast<std::size_t>(model->find_link(name))].collision = {placed};
  };
  put("l4", Capsule{0.05, 0.2}, Vector3d(0, 0, 0.12));
  put("l5", Sphere{0.065}, Vector3d(0, 0, -0.09));
  put("l7", Sphere{0.023}, Vector3d(0.0022, 0, 0));
  robot.model = model;
  robot.name = "near wrist";
  return robot;
}

inline std::vector<TestRobot> all_robots() {
  return {data_robot("sda5f"), data_robot("sda10f"), data_robot("iiwa14"), continuous_robot(),
          windings_robot()};
}

inline ArmModel arm_of(const TestRobot& robot) {
  return build_arm(*robot.model, robot.base_link, robot.tip_link, {}, Pose::Identity());
}

inline Config random_config(const Chain& chain, Random& random) {
  Config q;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    q[j] = limit.continuous ? random.uniform(-kPi, kPi) : random.uniform(limit.lower, limit.upper);
  }
  return q;
}

/// Returns whether the arm without a roll is S-R-S.
inline bool has_arm_angle(const TestRobot& robot) {
  try {
    static_cast<void>(fit_srs(arm_of(robot).chain, robot.name));
    return true;
  } catch (const InputError&) {  // of six joints, too
    return false;
  }
}

/// Returns an empty problem of the robot, with nodes at every layer.
inline PathProblem problem_for(const TestRobot& robot) {
  PathProblem problem;
  problem.source = robot.name;
  problem.model = robot.model;
  problem.base_link = problem.path_frame = robot.base_link;
  problem.tip_link = robot.tip_link;
  problem.resolution.knot = 0;
  return problem;
}

inline Waypoint waypoint_of(const Pose& pose) {
  return {pose.translation(), Quaterniond(pose.linear()).normalized()};
}

}  // namespace swivel::test
