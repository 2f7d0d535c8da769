// SPDX-License-Identifier: BSD-3-Clause
// Robot, scene and task are made here, without any file: an arm of seven joints passes a box.
#include <iostream>
#include <memory>
#include <string>
#include <swivel/planner/plan/planner.hpp>

using swivel::Vector3d;

/// Joint axes are z, y, z, y, z, y, z: shoulder 0.34 m above the base, elbow and wrist 0.40 m
/// further each, tool 0.13 m past the wrist.
swivel::RobotModel make_arm() {
  constexpr double kOffset[] = {0.14, 0.20, 0.20, 0.20,
                                0.20, 0.20, 0.08, 0.05};  // m, from frame to frame
  swivel::RobotModel arm;
  arm.links.emplace_back().name = "base";
  for (int k = 0; k < 8; ++k) {
    swivel::Joint& joint = arm.joints.emplace_back();
    joint.name = "joint_" + std::to_string(k + 1);
    joint.parent_link = k, joint.child_link = k + 1;
    joint.origin.translation().z() = kOffset[k];
    if (k < 7) {  // the last one is fixed
      joint.type = swivel::Joint::Type::kRevolute;
      joint.axis = k % 2 == 0 ? Vector3d::UnitZ() : Vector3d::UnitY();
      joint.lower = -2.9, joint.upper = 2.9, joint.velocity = 2;
    }
    swivel::Link& link = arm.links.emplace_back();
    link.name = k < 7 ? "link_" + std::to_string(k + 1) : "tool";
    link.parent_joint = k;
    if (k == 2 || k == 4)
      link.collision = {{.shape = swivel::Capsule{.radius = 0.05, .length = 0.36}}};
  }
  arm.has_srdf = true;
  arm.disabled_pairs = {{"link_3", "link_5"}};  // they meet at the elbow
  return arm;
}

int main() {
  swivel::Robot robot;
  robot.model = std::make_shared<const swivel::RobotModel>(make_arm());
  robot.base_link = "base", robot.tip_link = "tool";

  swivel::Task task;
  const swivel::Quaterniond down(0, 1, 0, 0);  // w, x, y, z
  task.waypoints = {{{0.5, -0.3, 0.4}, down}, {{0.5, 0.3, 0.4}, down}};
  task.limits.clearance = 0.02;

  swivel::Planner planner(robot);
  planner.add(
      {"box", swivel::Box{{0.1, 0.1, 0.1}}, swivel::Pose(Eigen::Translation3d(0.2, 0.1, 0.75))});
  planner.set_task(task);
  const swivel::PlanResult result = planner.plan();
  std::cout << to_string(result.status) << ", " << result.trajectory.size() << " rows, cost "
            << result.cost << '\n';
  return result.status == swivel::PlanStatus::kSolved ? 0 : 1;
}
