// SPDX-License-Identifier: BSD-3-Clause
#include "robot_state.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace swivel::ros {

double within_limits(const Joint& joint, double position) {
  return joint.type == Joint::Type::kContinuous ? position
                                                : std::clamp(position, joint.lower, joint.upper);
}

std::string RobotState::set(const JointValues& joints) {
  if (joints.names.size() != joints.positions.size())
    throw std::invalid_argument("joint_state has " + std::to_string(joints.names.size()) +
                                " names and " + std::to_string(joints.positions.size()) +
                                " positions");
  std::string unknown;
  for (std::size_t k = 0; k < joints.names.size(); ++k) {
    const int joint = model_->find_joint(joints.names[k]);
    if (joint < 0) {
      if (unknown.empty()) unknown = joints.names[k];
      continue;
    }
    if (!std::isfinite(joints.positions[k]))
      throw std::invalid_argument("the position of joint '" + joints.names[k] + "' is not finite");
    known_[static_cast<std::size_t>(joint)] = joints.positions[k];
  }
  return unknown;
}

std::optional<double> RobotState::known(int joint) const {
  const Joint& one = model_->joints[static_cast<std::size_t>(joint)];
  if (!one.mimic) return known_[static_cast<std::size_t>(joint)];
  const auto leader = known(one.mimic->joint);
  if (!leader) return leader;
  return one.mimic->multiplier * *leader + one.mimic->offset;
}

double RobotState::position(int joint) const {
  const Joint& one = model_->joints[static_cast<std::size_t>(joint)];
  if (one.mimic) return one.mimic->multiplier * position(one.mimic->joint) + one.mimic->offset;
  return known(joint).value_or(within_limits(one, 0));
}

Pose RobotState::link(int link) const {
  const int index = model_->links[static_cast<std::size_t>(link)].parent_joint;
  if (index < 0) return Pose::Identity();
  const Joint& joint = model_->joints[static_cast<std::size_t>(index)];
  Pose pose = this->link(joint.parent_link) * joint.origin;
  if (joint.type == Joint::Type::kPrismatic)
    pose.translate(position(index) * joint.axis);
  else if (joint.movable())
    pose.rotate(Eigen::AngleAxisd(position(index), joint.axis));
  return pose;
}

JointValues RobotState::values() const {
  JointValues values;
  for (std::size_t k = 0; k < model_->joints.size(); ++k) {
    if (!model_->joints[k].movable()) continue;
    values.names.push_back(model_->joints[k].name);
    values.positions.push_back(position(static_cast<int>(k)));
  }
  return values;
}

Pose to_pose(const Pose7& pose) {
  Pose result = Pose::Identity();
  const Quaterniond turn(pose.qw, pose.qx, pose.qy, pose.qz);
  if (turn.norm() > 0) result.linear() = turn.normalized().toRotationMatrix();
  result.translation() = Vector3d(pose.x, pose.y, pose.z);
  return result;
}

Pose7 to_pose7(const Pose& pose) {
  const Quaterniond turn(pose.linear());
  const Vector3d at = pose.translation();
  return {at.x(), at.y(), at.z(), turn.w(), turn.x(), turn.y(), turn.z()};
}

}  // namespace swivel::ros
