// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "seed.hpp"
#include "swivel/core/problem/robot_model.hpp"

namespace swivel::test {

inline Pose random_pose(double range, Random& random) {
  Pose pose = Pose::Identity();
  pose.translation() = Vector3d(random.uniform(-range, range), random.uniform(-range, range),
                                random.uniform(-range, range));
  const Vector3d axis(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  pose.linear() =
      Eigen::AngleAxisd(random.uniform(-kPi, kPi), (axis + Vector3d(1e-3, 0, 0)).normalized())
          .toRotationMatrix();
  return pose;
}

/// Adds links, each behind a joint that mimics one of `leaders` or another joint added before, on
/// any link that there is. Leaders with a turn or more lead whole turns alone.
inline void add_linkages(RobotModel& model, const std::vector<std::string>& leaders, int count,
                         Random& random) {
  std::vector<int> may_lead;
  for (const std::string& name : leaders) may_lead.push_back(model.find_joint(name));
  for (int k = 0; k < count; ++k) {
    Joint joint;
    joint.name = "linkage_joint_" + std::to_string(k);
    joint.parent_link = random.below(static_cast<int>(model.links.size()));
    if (k > 0 && random.coin(0.3))
      joint.parent_link = static_cast<int>(model.links.size()) - 1;  // behind the last one
    joint.child_link = static_cast<int>(model.links.size());
    joint.origin = random_pose(0.25, random);
    joint.axis = random_pose(1, random).linear().col(2);
    joint.lower = -1000;
    joint.upper = 1000;
    const int leader =
        may_lead[static_cast<std::size_t>(random.below(static_cast<int>(may_lead.size())))];
    const Joint* first = &model.joints[static_cast<std::size_t>(leader)];
    while (first->mimic) first = &model.joints[static_cast<std::size_t>(first->mimic->joint)];
    const bool turns_round =
        first->type == Joint::Type::kContinuous || first->upper - first->lower > 6;
    const bool slides = !turns_round && random.coin(0.3);
    joint.type = slides ? Joint::Type::kPrismatic : Joint::Type::kRevolute;
    const double multiplier = slides        ? random.uniform(-0.1, 0.1)
                              : turns_round ? (random.coin() ? 1 : -2)
                                            : random.uniform(-1.5, 1.5);
    joint.mimic = Joint::Mimic{leader, multiplier, slides ? 0.1 : random.uniform(-1, 1)};
    Link link{"linkage_" + std::to_string(k), {}, static_cast<int>(model.joints.size())};
    link.collision.push_back({Capsule{random.uniform(0.01, 0.04), random.uniform(0.02, 0.25)},
                              random_pose(0.1, random)});
    if (random.coin(0.3))
      link.collision.push_back({Box{Vector3d(0.05, 0.1, 0.03)}, random_pose(0.1, random)});
    if (!slides) may_lead.push_back(static_cast<int>(model.joints.size()));
    model.joints.push_back(joint);
    model.links.push_back(link);
  }
}

/// Returns where a joint stands, given the positions of the joints that mimic none.
inline double plain_position(const RobotModel& model, int joint,
                             const std::vector<double>& positions) {
  const auto& mimic = model.joints[static_cast<std::size_t>(joint)].mimic;
  return mimic ? mimic->multiplier * plain_position(model, mimic->joint, positions) + mimic->offset
               : positions[static_cast<std::size_t>(joint)];
}

/// Returns the pose of a link in the root's frame, multiplied from joint to joint.
inline Pose plain_pose(const RobotModel& model, int link, const std::vector<double>& positions) {
  const int j = model.links[static_cast<std::size_t>(link)].parent_joint;
  if (j < 0) return Pose::Identity();
  const Joint& joint = model.joints[static_cast<std::size_t>(j)];
  Pose motion = Pose::Identity();
  if (joint.type == Joint::Type::kPrismatic)
    motion.translation() = plain_position(model, j, positions) * joint.axis;
  else if (joint.movable())
    motion.linear() =
        Eigen::AngleAxisd(plain_position(model, j, positions), joint.axis).toRotationMatrix();
  return plain_pose(model, joint.parent_link, positions) * joint.origin * motion;
}

}  // namespace swivel::test
