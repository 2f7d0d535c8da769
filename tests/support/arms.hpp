// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "concatenated.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"

namespace swivel::test {

/// A joint of an arm as URDFs have it: origin (m, and roll, pitch, yaw in rad), axis and limits
/// (rad). Dimensions are those of the makers' descriptions, rounding included; "like" in an arm's
/// name means lengths of that class. chain_of() gives an arm of six joints a seventh that turns the
/// tool about its own z axis.
struct JointRow {
  Vector3d xyz, rpy, axis;
  double lower, upper;
  bool continuous = false;
};
struct ArmTable {
  std::string name;
  std::vector<JointRow> joints;
  Vector3d tip_xyz = Vector3d::Zero(), tip_rpy = Vector3d::Zero();
};

inline Pose urdf_pose(const Vector3d& xyz, const Vector3d& rpy) {
  Pose pose = Pose::Identity();
  pose.translation() = xyz;
  pose.linear() = (Eigen::AngleAxisd(rpy.z(), Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(rpy.y(), Vector3d::UnitY()) *
                   Eigen::AngleAxisd(rpy.x(), Vector3d::UnitX()))
                      .toRotationMatrix();
  return pose;
}

/// Builds a robot with links "base", "l1", ...; a fixed joint leads to the tip.
inline RobotModel model_of(const ArmTable& arm, const std::vector<JointRow>& rows,
                           const Pose& tip) {
  RobotModel model;
  model.name = model.source = arm.name;
  model.links.push_back({"base", {}, -1});
  const auto add = [&](const Joint& joint) {
    model.joints.push_back(joint);
    model.joints.back().name = "j" + std::to_string(model.joints.size());
    model.joints.back().parent_link = static_cast<int>(model.links.size()) - 1;
    model.joints.back().child_link = static_cast<int>(model.links.size());
    model.links.push_back(
        {"l" + std::to_string(model.links.size()), {}, static_cast<int>(model.joints.size()) - 1});
  };
  for (const JointRow& row : rows) {
    Joint joint;
    joint.type = row.continuous ? Joint::Type::kContinuous : Joint::Type::kRevolute;
    joint.origin = urdf_pose(row.xyz, row.rpy);
    joint.axis = row.axis.normalized();
    joint.lower = row.lower;
    joint.upper = row.upper;
    add(joint);
  }
  Joint fixed;
  fixed.origin = tip;
  add(fixed);
  return model;
}

inline Chain chain_of(const ArmTable& arm) {
  std::vector<JointRow> rows = arm.joints;
  Pose tip = urdf_pose(arm.tip_xyz, arm.tip_rpy);
  if (rows.size() + 1 == kDof) {
    rows.push_back({arm.tip_xyz, arm.tip_rpy, Vector3d::UnitZ(), 0, 0, true});
    tip.setIdentity();
  }
  const RobotModel model = model_of(arm, rows, tip);
  return build_arm(model, "base", model.links.back().name, {}, Pose::Identity()).chain;
}

/// Builds an arm of six joints with a tool that may turn about its own z axis, within `roll`.
inline ArmModel arm_with_roll(const ArmTable& arm, const Roll& roll) {
  const RobotModel model = model_of(arm, arm.joints, urdf_pose(arm.tip_xyz, arm.tip_rpy));
  return build_arm(model, "base", model.links.back().name, {}, Pose::Identity(), roll);
}

namespace arm_tables {

constexpr double half = kPi / 2;  // a right angle, rad

/// Returns the vector (a, b, c) of a row's origin: a position, m, or roll, pitch and yaw, rad.
inline Vector3d v(double a, double b, double c) {
  return Vector3d(a, b, c);
}

/// Arms of seven joints that all have limits; none is S-R-S.
inline std::vector<ArmTable> bounded_7r() {
  const Vector3d z = Vector3d::UnitZ(), o = Vector3d::Zero();
  return {
      {"panda",
       {{v(0, 0, 0.333), o, z, -2.8973, 2.8973},
        {o, v(-half, 0, 0), z, -1.7628, 1.7628},
        {v(0, -0.316, 0), v(half, 0, 0), z, -2.8973, 2.8973},
        {v(0.0825, 0, 0), v(half, 0, 0), z, -3.0718, -0.0698},
        {v(-0.0825, 0.384, 0), v(-half, 0, 0), z, -2.8973, 2.8973},
        {o, v(half, 0, 0), z, -0.0175, 3.7525},
        {v(0.088, 0, 0), v(half, 0, 0), z, -2.8973, 2.8973}},
       v(0, 0, 0.2104),
       v(0, 0, -kPi / 4)},
      {"xarm7",
       {{v(0, 0, 0.267), o, z, -kTwoPi, kTwoPi},
        {o, v(-1.5708, 0, 0), z, -2.059, 2.0944},
        {v(0, -0.293, 0), v(1.5708, 0, 0), z, -kTwoPi, kTwoPi},
        {v(0.0525, 0, 0), v(1.5708, 0, 0), z, -0.19198, 3.927},
        {v(0.0775, -0.3425, 0), v(1.5708, 0, 0), z, -kTwoPi, kTwoPi},
        {o, v(1.5708, 0, 0), z, -1.69297, kPi},
        {v(0.076, 0.097, 0), v(-1.5708, 0, 0), z, -kTwoPi, kTwoPi}}},
      {"gen72-like",
       {{v(0, 0, 0.218), o, z, -3.0, 3.0},
        {o, v(-half, 0, 0), z, -1.83, 1.83},
        {v(0, -0.28, 0), v(half, 0, 0), z, -3.0, 3.0},
        {v(0.04, 0, 0), v(half, 0, 0), z, -2.87, 0.96},
        {v(-0.019, 0.2525, 0), v(-half, 0, 0), z, -3.0, 3.0},
        {o, v(half, 0, 0), z, -1.71, 1.78},
        {v(0.067, 0, 0), v(half, 0, 0), z, -3.0, 3.0}},
       v(0, 0, 0.1)},
  };
}

/// Arms of seven joints of which some turn without limits; none is S-R-S.
inline std::vector<ArmTable> continuous_7r() {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ(),
                 o = Vector3d::Zero();
  return {
      {"fetch",
       {{v(0.119525, 0, 0.34858), o, z, -1.6056, 1.6056},
        {v(0.117, 0, 0.0599999999999999), o, y, -1.221, 1.518},
        {v(0.219, 0, 0), o, x, 0, 0, true},
        {v(0.133, 0, 0), o, y, -2.251, 2.251},
        {v(0.197, 0, 0), o, x, 0, 0, true},
        {v(0.1245, 0, 0), o, y, -2.16, 2.16},
        {v(0.1385, 0, 0), o, x, 0, 0, true}},
       v(0.16645, 0, 0)},
      {"pr2-like",
       {{v(0, -0.188, 0), o, z, -2.2854, 0.7146},
        {v(0.1, 0, 0), o, y, -0.5236, 1.3963},
        {o, o, x, -3.9, 0.8},
        {v(0.4, 0, 0), o, y, -2.3213, 0},
        {o, o, x, 0, 0, true},
        {v(0.321, 0, 0), o, y, -2.18, 0},
        {o, o, x, 0, 0, true}},
       v(0.18, 0, 0)},
      {"j2s7s300-like",
       {{v(0, 0, 0.15675), v(0, kPi, 0), z, 0, 0, true},
        {v(0, 0.0016, -0.11875), v(-half, 0, kPi), z, 0.8203, 5.4629},
        {v(0, -0.205, 0), v(-half, 0, 0), z, 0, 0, true},
        {v(0, 0, -0.205), v(half, 0, kPi), z, 0.5236, 5.7596},
        {v(0, 0.2073, -0.0114), v(-half, 0, kPi), z, 0, 0, true},
        {v(0, 0, -0.10375), v(half, 0, kPi), z, 1.1345, 5.1487},
        {v(0, 0.10375, 0), v(-half, 0, kPi), z, 0, 0, true}},
       v(0, 0, -0.16)},
      {"gen3",
       {{v(0, 0, 0.15643), v(3.1416, 2.7629e-18, -4.9305e-36), z, 0, 0, true},
        {v(0, 0.005375, -0.12838), v(1.5708, 2.1343e-17, -1.1102e-16), z, -2.24, 2.24},
        {v(0, -0.21038, -0.006375), v(-1.5708, 1.2326e-32, -2.9122e-16), z, 0, 0, true},
        {v(0, 0.006375, -0.21038), v(1.5708, -6.6954e-17, -1.6653e-16), z, -2.57, 2.57},
        {v(0, -0.20843, -0.006375), v(-1.5708, 2.2204e-16, -6.373e-17), z, 0, 0, true},
        {v(0, 0.00017505, -0.10593), v(1.5708, 9.2076e-28, -8.2157e-15), z, -2.09, 2.09},
        {v(0, -0.10593, -0.00017505), v(-1.5708, -5.5511e-17, 9.6396e-17), z, 0, 0, true}},
       v(0, 0, -0.061525),
       v(kPi, 0, 0)},
  };
}

/// The arm of seven joints that is S-R-S.
inline std::vector<ArmTable> srs_7r() {
  const Vector3d z = Vector3d::UnitZ(), o = Vector3d::Zero();
  return {
      {"iiwa7",
       {{v(0, 0, 0.15), o, z, -2.967, 2.967},
        {v(0, 0, 0.19), v(half, 0, kPi), z, -2.094, 2.094},
        {v(0, 0.21, 0), v(half, 0, kPi), z, -2.967, 2.967},
        {v(0, 0, 0.19), v(half, 0, 0), z, -2.094, 2.094},
        {v(0, 0.21, 0), v(-half, kPi, 0), z, -2.967, 2.967},
        {v(0, 0.0607, 0.19), v(half, 0, 0), z, -2.094, 2.094},
        {v(0, 0.081, 0.0607), v(-half, kPi, 0), z, -3.054, 3.054}},
       v(0, 0, 0.045)},
  };
}

/// Arms of six joints with a spherical wrist of which neighbouring axes are square.
inline std::vector<ArmTable> square_wrists_6r() {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ(),
                 o = Vector3d::Zero();
  return {
      {"kr6-r900",
       {{v(0, 0, 0.4), o, -z, -2.967, 2.967},
        {v(0.025, 0, 0), o, y, -3.316, 0.785},
        {v(0.455, 0, 0), o, y, -2.094, 2.723},
        {v(0, 0, 0.035), o, -x, -3.229, 3.229},
        {v(0.42, 0, 0), o, y, -2.094, 2.094},
        {v(0.08, 0, 0), o, -x, -6.109, 6.109}},
       v(0.1, 0.02, 0.05),
       v(0, 1.1, 0.3)},
      {"puma560",
       {{o, o, z, -kPi, kPi},
        {o, v(half, 0, 0), z, -kPi, kPi},
        {v(0.4318, 0, 0), o, z, -kPi, kPi},
        {v(0.0203, 0, 0.15005), v(-half, 0, 0), z, -kPi, kPi},
        {v(0, 0, 0.4318), v(half, 0, 0), z, -kPi, kPi},
        {o, v(-half, 0, 0), z, -kPi, kPi}},
       v(0.05, 0.02, 0.1),
       v(0.7, 0, 0)},
      {"irb120-like",
       {{v(0, 0, 0.29), o, z, -2.88, 2.88},
        {o, o, y, -1.92, 1.92},
        {v(0, 0, 0.27), o, y, -1.92, 1.22},
        {v(0, 0, 0.07), o, x, -2.79, 2.79},
        {v(0.302, 0, 0), o, y, -2.09, 2.09},
        {v(0.072, 0, 0), o, x, -6.98, 6.98}},
       v(0.08, 0, 0.05),
       v(0, 0.8, 0)},
  };
}

/// Arms of six joints, three of them with parallel axes.
inline std::vector<ArmTable> parallel_axes_6r() {
  const Vector3d y = Vector3d::UnitY(), z = Vector3d::UnitZ(), o = Vector3d::Zero();
  return {
      {"ur5e",
       {{v(0, 0, 0.1625), v(0, 0, kPi), z, -kTwoPi, kTwoPi},
        {o, v(1.570796327, 0, 0), z, -kTwoPi, kTwoPi},
        {v(-0.425, 0, 0), o, z, -kPi, kPi},
        {v(-0.3922, 0, 0.1333), o, z, -kTwoPi, kTwoPi},
        {v(0, -0.0997, -2.044881182297852e-11), v(1.570796327, 0, 0), z, -kTwoPi, kTwoPi},
        {v(0, 0.0996, -2.042830148012698e-11), v(1.570796326589793, kPi, kPi), z, -kTwoPi, kTwoPi}},
       v(0.05, 0, 0.1),
       v(0, 0.6, 0)},
      {"ur10e-like",
       {{v(0, 0, 0.1807), o, z, -kTwoPi, kTwoPi},
        {v(0, 0.1, 0), o, y, -kTwoPi, kTwoPi},
        {v(0.6127, -0.05, 0), o, y, -kPi, kPi},
        {v(0.57155, 0, 0), o, y, -kTwoPi, kTwoPi},
        {v(0, 0.12415, 0), o, -z, -kTwoPi, kTwoPi},
        {v(0, 0, -0.11985), o, y, -kTwoPi, kTwoPi}},
       v(0, 0.11655, 0.03),
       v(-half + 0.5, 0, 0)},
      // No axes meet or stand square: axes 5 and 6 pass each other, so that the position of the
      // parallel axes is a quartic.
      {"skew-parallel",
       {{v(0, 0, 0.2), o, z, -kPi, kPi},
        {v(0.07, 0.1, 0), v(0.2, 0, 0.1), y, -kPi, kPi},
        {v(0.5, -0.05, 0.04), o, y, -kPi, kPi},
        {v(0.45, 0.03, 0), o, -y, -kPi, kPi},
        {v(0.02, 0.12, 0), v(0.4, 0, 0), -z, -kPi, kPi},
        {v(0.06, 0, -0.12), v(0.3, 0.2, 0), y, -kPi, kPi}},
       v(0, 0.1, 0.03),
       v(0.5, 0, 0)},
      // Like skew-parallel with its axes in the order from tip to base: axes 3, 4 and 5 are
      // parallel.
      {"parallel-3-4-5",
       {{v(0, 0.1, 0.3), v(0.3, 0, 0), y, -kPi, kPi},
        {v(0.06, 0, 0.12), o, z, -kPi, kPi},
        {v(0.02, 0.1, 0), o, y, -kPi, kPi},
        {v(0.45, 0.03, 0), o, y, -kPi, kPi},
        {v(0.5, 0.05, 0), o, y, -kPi, kPi},
        {v(0.03, 0, 0.1), o, z, -kPi, kPi}},
       v(0, 0.1, 0.03),
       v(0.5, 0, 0)},
  };
}

/// The arm of six joints with a spherical wrist of which neighbouring axes are not square.
inline std::vector<ArmTable> oblique_wrists_6r() {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ(),
                 o = Vector3d::Zero();
  return {
      // Neighbours of the wrist at 70 and 60 degrees.
      {"oblique-wrist",
       {{v(0, 0, 0.3), o, z, -kPi, kPi},
        {v(0.08, 0.03, 0), v(0.2, 0, 0), y, -kPi, kPi},
        {v(0.1, 0, 0.4), v(0, 0.1, 0.3), y, -kPi, kPi},
        {v(0.35, 0.05, 0.04), o, x, -kPi, kPi},
        {o, v(0, 0, 7 * kPi / 18), x, -kPi, kPi},
        {o, v(0, kPi / 3, 0), x, -kPi, kPi}},
       v(0.1, 0, 0.05),
       v(0, 0.8, 0)},
  };
}

}  // namespace arm_tables

/// Arms of seven joints. Only the last of them is S-R-S.
inline std::vector<ArmTable> arms_7r() {
  return concatenated(
      {arm_tables::bounded_7r(), arm_tables::continuous_7r(), arm_tables::srs_7r()});
}

/// Arms of six joints; the turn of the tool is their redundancy.
inline std::vector<ArmTable> arms_6r() {
  return concatenated({arm_tables::square_wrists_6r(), arm_tables::parallel_axes_6r(),
                       arm_tables::oblique_wrists_6r()});
}

}  // namespace swivel::test
