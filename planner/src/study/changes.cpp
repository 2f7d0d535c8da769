// SPDX-License-Identifier: BSD-3-Clause
#include "study/changes.hpp"

#include <algorithm>

namespace swivel {

namespace {

template <class Member>
LimitPlace place_of_member(Member member) {
  return {[member](const Limits& limits) { return std::optional<double>(limits.*member); },
          [member](Limits& limits, double value) { limits.*member = value; }};
}

}  // namespace

LimitPlace place_of(Advice::Change change) {
  switch (change) {
    case Advice::Change::kClearance:
      return {[](const Limits& limits) { return std::optional(limits.clearance); },
              // the shares that pairs keep between layers and among robot bodies stay
              [](Limits& limits, double value) {
                const double share = limits.clearance > 0 ? value / limits.clearance : 1;
                if (limits.self_clearance) *limits.self_clearance *= share;
                if (limits.edge_clearance) *limits.edge_clearance *= share;
                limits.clearance = value;
              }};
    case Advice::Change::kJointMargin:
      return place_of_member(&Limits::joint_margin);
    case Advice::Change::kManipulability:
      return place_of_member(&Limits::manipulability);
    case Advice::Change::kArmSlope:
      return place_of_member(&Limits::arm_slope);
    case Advice::Change::kRollSlope:
      return place_of_member(&Limits::roll_slope);
    case Advice::Change::kJointStep:
      return place_of_member(&Limits::joint_step);
    case Advice::Change::kToolSpeed:
      return place_of_member(&Limits::tool_speed);
    case Advice::Change::kToolTurnSpeed:
      return place_of_member(&Limits::tool_turn_speed);
    case Advice::Change::kPathError:
      return place_of_member(&Limits::tool_path_error);
    case Advice::Change::kAngleError:
      return place_of_member(&Limits::tool_angle_error);
    default:
      return place_of_member(&Limits::step_error);
  }
}

bool relaxed_downwards(Advice::Change change) {
  return change == Advice::Change::kClearance || change == Advice::Change::kJointMargin ||
         change == Advice::Change::kManipulability || change == Advice::Change::kToolSpeed ||
         change == Advice::Change::kToolTurnSpeed;
}

int dearness(Advice::Change change) {
  switch (change) {
    case Advice::Change::kFreeRoll:
    case Advice::Change::kHold:
    case Advice::Change::kTurnedOver:
      return 1;
    case Advice::Change::kArmSlope:
    case Advice::Change::kRollSlope:
      return 2;
    case Advice::Change::kFiner:
      return 3;
    case Advice::Change::kJointStep:
      return 4;
    default:
      return 0;
  }
}

double most_relaxed(Advice::Change change, double from) {
  constexpr double kFactor = 8;
  switch (change) {
    case Advice::Change::kClearance:
    case Advice::Change::kJointMargin:
    case Advice::Change::kManipulability:
      return 0;
    default:
      return relaxed_downwards(change) ? from / kFactor : from * kFactor;
  }
}

bool is_of_scene(Advice::Change change) {
  return change == Advice::Change::kDepth || change == Advice::Change::kMoveObject ||
         change == Advice::Change::kWithoutObject;
}

void change_arm(const Advice& advice, Robot& robot, Task& task) {
  switch (advice.change) {
    case Advice::Change::kFreeStart:
      task.start.reset();
      break;
    case Advice::Change::kFreeEnd:
      task.end.reset();
      break;
    case Advice::Change::kFreeRoll:
      robot.roll = Roll{};
      for (Waypoint& waypoint : task.waypoints) waypoint.roll.reset();
      break;
    case Advice::Change::kTurnedOver:
      robot.tool.linear() *= Eigen::AngleAxisd(kPi, Vector3d::UnitX()).toRotationMatrix();
      break;
    case Advice::Change::kHold:
      robot.hold[advice.object] = *advice.to;
      break;
    case Advice::Change::kFiner:
      task.resolution.ds /= 2;
      task.resolution.dphi /= 2;
      task.resolution.dalpha /= 2;
      task.resolution.arc = task.resolution.arc_of_nodes() / 2;
      if (task.resolution.knot) *task.resolution.knot /= 2;
      task.resolution.arcs = true;
      break;
    default:
      place_of(advice.change).set(task.limits, *advice.to);
  }
}

void change_scene(const Advice& advice, std::vector<SceneObject>& scene,
                  std::vector<Variation>& vary) {
  if (advice.change == Advice::Change::kWithoutObject) {
    const auto goes = [&](const std::string& name) {
      return name == advice.object || name == advice.also;
    };
    std::erase_if(scene, [&](const SceneObject& object) { return goes(object.name); });
    std::erase_if(vary, [&](const Variation& one) { return goes(one.object); });
    return;
  }
  for (SceneObject& object : scene) {
    if (object.name == advice.also) object.pose.translation() += advice.also_offset;
    if (object.name != advice.object) continue;
    if (advice.change == Advice::Change::kDepth)
      object = deeper(object, *advice.to / *advice.from);
    else
      object.pose.translation() += advice.offset;
  }
}

std::vector<Vector3d> directions_of_moves(const std::vector<SceneObject>& scene,
                                          const std::string& object) {
  constexpr double kParallel = 1 - 1e-3;
  std::vector<Vector3d> directions{Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
  for (const SceneObject& one : scene) {
    if (one.name != object) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d own = one.pose.linear().col(axis);
      if (own.cwiseAbs().maxCoeff() < kParallel) directions.push_back(own);
    }
  }
  return directions;
}

SceneObject deeper(SceneObject object, double factor) {
  for (Allowed& allowed : object.allow)
    if (allowed.depth) *allowed.depth *= factor;
  return object;
}

}  // namespace swivel
