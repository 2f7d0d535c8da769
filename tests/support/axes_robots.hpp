// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "robots.hpp"

namespace swivel::test {

/// A joint that is put into an arm: it slides or turns along `axis` of the frame of the joint that
/// it precedes.
struct MoreAxis {
  Joint::Type type;
  Vector3d axis;
  double lower, upper;  ///< m or rad
};

/// Returns the robot with one joint more between base and tip, without a shape of its own. `place`
/// of its other movable joints come before it.
inline TestRobot with_axis(const TestRobot& robot, int place, const MoreAxis& more) {
  auto model = std::make_shared<RobotModel>(*robot.model);
  std::vector<int> way;  // joints from base to tip, fixed ones included
  for (int link = model->find_link(robot.tip_link); link != model->find_link(robot.base_link);) {
    const int joint = model->links[static_cast<std::size_t>(link)].parent_joint;
    way.insert(way.begin(), joint);
    link = model->joints[static_cast<std::size_t>(joint)].parent_link;
  }
  std::size_t at = 0;
  for (int movable = 0; movable < place; ++at)
    movable += model->joints[static_cast<std::size_t>(way[at])].movable();
  const int next = way[at], link = static_cast<int>(model->links.size());
  Joint joint;
  joint.name = more.type == Joint::Type::kPrismatic ? "slide" : "torso";
  joint.type = more.type;
  joint.axis = more.axis.normalized();
  joint.lower = more.lower;
  joint.upper = more.upper;
  joint.velocity = 1;
  Joint& after = model->joints[static_cast<std::size_t>(next)];
  joint.origin = after.origin;
  joint.parent_link = after.parent_link;
  joint.child_link = after.parent_link = link;
  after.origin = Pose::Identity();
  model->links.push_back({joint.name + "_link", {}, static_cast<int>(model->joints.size())});
  model->joints.push_back(joint);
  return {robot.name + " with a " + joint.name + " at " + std::to_string(place), model,
          robot.base_link, robot.tip_link};
}

/// Returns arms of six joints with one that slides: under the base along it, up a column, between
/// shoulder and elbow, and behind the wrist.
inline std::vector<TestRobot> slide_robots() {
  TestRobot kr6 = data_robot("kr6_like"), ur5e = data_robot("ur5e_like");
  kr6.tip_link = ur5e.tip_link = "flange";
  const auto slide = [](const Vector3d& axis, double lower, double upper) {
    return MoreAxis{Joint::Type::kPrismatic, axis, lower, upper};
  };
  return {with_axis(kr6, 0, slide(Vector3d(0, 1, 0), -4, 4)),
          with_axis(ur5e, 0, slide(Vector3d(1, 0, 0), -0.8, 0.8)),
          with_axis(kr6, 0, slide(Vector3d(0, 0, 1), 0, 0.6)),
          with_axis(kr6, 2, slide(Vector3d(0.3, 1, 0.5), -0.2, 0.3)),
          with_axis(ur5e, 6, slide(Vector3d(1, 0.2, 0.1), -0.1, 0.4))};
}

/// Returns an arm of six joints on a torso that turns.
inline TestRobot torso_robot() {
  TestRobot kr6 = data_robot("kr6_like");
  kr6.tip_link = "flange";
  return with_axis(kr6, 0, {Joint::Type::kRevolute, Vector3d(0.2, 1, 0.1), -1.2, 1.0});
}

}  // namespace swivel::test
