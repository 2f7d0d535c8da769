// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/scale.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

namespace {

/// Returns how far the arm reaches without `tool`, m: the sum of the distances from axis to axis
/// and on to the flange, and the furthest position of a slide.
double reach_of_arm(const Chain& chain, const Pose& tool) {
  const std::size_t joints =
      chain.roll ? kDof - 1 : kDof;  // the roll is no joint of the arm; its axis is the tool's
  double reach = ((chain.home * tool.inverse()).translation() - chain.point[joints - 1]).norm();
  for (std::size_t j = 1; j < joints; ++j) reach += (chain.point[j] - chain.point[j - 1]).norm();
  for (const JointLimit& limit : chain.limit)
    if (limit.slides) reach += std::max(std::abs(limit.lower), std::abs(limit.upper));
  return reach;
}

struct Size {
  /// The shortest and longest edge of a box about the shape, m.
  double least = 0, most = 0;
};
Size size_of(const Shape& shape) {
  const auto of = [](double a, double b) { return Size{std::min(a, b), std::max(a, b)}; };
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    return of(2 * sphere->radius, 2 * sphere->radius);
  if (const auto* box = std::get_if<Box>(&shape))
    return of(box->size.minCoeff(), box->size.maxCoeff());
  if (const auto* cylinder = std::get_if<Cylinder>(&shape))
    return of(2 * cylinder->radius, cylinder->length);
  if (const auto* capsule = std::get_if<Capsule>(&shape))
    return of(2 * capsule->radius, capsule->length + 2 * capsule->radius);
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vector3d& vertex : std::get<MeshPtr>(shape)->vertices)
    low = low.cwiseMin(vertex), high = high.cwiseMax(vertex);
  const Vector3d edges = (high - low).cwiseMax(0);
  return of(edges.minCoeff(), edges.maxCoeff());
}

std::string suspicion(double reach) {
  return formatted(
      ", and the arm reaches %.3g m: are these millimetres? Lengths are read as metres", reach);
}

constexpr const char* kAskDegrees = ": are these degrees? Angles are read as radians";
constexpr double kMostTurnSpeed = 50;  // rad/s: joints of arms reach 20
// Limits of joints beyond the first, rad, are suspected; those beyond the second mean that there is
// no limit.
constexpr double kFarTurned = 25, kUnlimited = 1000;

/// Returns what a joint's limits say that is suspected to be in degrees; "" if nothing is.
std::string large_turns(const Joint& joint) {
  std::string text;
  const double furthest = std::max(std::abs(joint.lower), std::abs(joint.upper));
  if (joint.type == Joint::Type::kRevolute && furthest > kFarTurned && furthest <= kUnlimited)
    text = formatted("may turn from %.4g to %.4g rad", joint.lower, joint.upper);
  const bool turns = joint.type == Joint::Type::kRevolute || joint.type == Joint::Type::kContinuous;
  if (turns && joint.velocity > kMostTurnSpeed)
    text += formatted(text.empty() ? "may turn at %.4g rad/s" : ", at %.4g rad/s", joint.velocity);
  return text;
}

/// Returns one warning for all joints of the chain whose limits are suspected to be in degrees.
std::vector<std::string> turn_warnings(const Chain& chain, const RobotModel& robot) {
  std::vector<const Joint*> suspects;
  for (const std::string& name : chain.joint_names)
    if (const int index = robot.find_joint(name); index >= 0) {  // the roll is no joint
      const Joint& joint = robot.joints[static_cast<std::size_t>(index)];
      if (!large_turns(joint).empty()) suspects.push_back(&joint);
    }
  if (suspects.empty()) return {};
  const Joint& first = *suspects.front();
  std::string text = first.line > 0 ? robot.source + ":" + std::to_string(first.line) : "robot";
  text += ": joint '" + first.name + "' " + large_turns(first);
  if (suspects.size() > 1)
    text +=
        formatted(", and %zu more joint%s", suspects.size() - 1, suspects.size() > 2 ? "s" : "");
  return {text + kAskDegrees};
}

class Scale {
 public:
  explicit Scale(double reach) : reach_(reach) {}

  void distance(const std::string& what, double metres, const char* hint = "") {
    if (metres > kFar * reach_) tell(what, formatted(" is %.4g m from the arm", metres), hint);
  }
  /// A box or another plain shape must also be thick: floors and walls are large, but thin.
  void size(const std::string& what, const Shape& shape) {
    const Size size = size_of(shape);
    const bool mesh = std::holds_alternative<MeshPtr>(shape);
    if (size.most > kFar * reach_ && (mesh || size.least > reach_))
      tell(what, formatted(" is %.4g m long", size.most), mesh ? " (a mesh has a `scale`)" : "");
  }
  void length(const std::string& what, double metres) {
    if (metres > kFar * reach_) tell(what, formatted(" is %.4g m long", metres), "");
  }
  [[nodiscard]] std::vector<std::string> take() { return std::move(warnings_); }

 private:
  void tell(const std::string& what, const std::string& found, const char* hint) {
    warnings_.push_back(what + found + suspicion(reach_) + hint);
  }

  double reach_;
  std::vector<std::string> warnings_;
};

}  // namespace

double most_reach(const Chain& chain) {
  return reach_of_arm(chain, Pose::Identity());
}

double most_tool_speed(const Chain& chain) {
  return 10 * most_reach(chain);
}

std::vector<std::string> tool_speed_warnings(const Chain& chain, double speed,
                                             const std::string& what) {
  if (!(speed > most_tool_speed(chain))) return {};
  return {what + formatted(" is %.4g m/s", speed) + suspicion(most_reach(chain))};
}

void require_tool_speed(const Chain& chain, double speed, const std::string& what) {
  for (const std::string& fault : tool_speed_warnings(chain, speed, what + ":"))
    throw InputError(fault + formatted(": allowed is at most %.3g m/s", most_tool_speed(chain)));
}

std::optional<int> first_far_waypoint(const Chain& chain, const ToolPath& path) {
  const double most = kFar * most_reach(chain);
  for (int i = 0; i < path.size(); ++i)
    if (path.layer(i).waypoint >= 0 &&
        (path.layer(i).tool.translation() - chain.point[0]).norm() > most)
      return i;
  return std::nullopt;
}

ToolPath path_within_scale(const PathProblem& problem, const Chain& chain, const Budget& budget) {
  ToolPath path = problem_path(problem, chain, budget);
  if (const auto far = first_far_waypoint(chain, path)) path.end_at(std::max(1, *far));
  return path;
}

std::vector<LargeLength> large_lengths(const Chain& chain, const PathProblem& problem) {
  const double reach = reach_of_arm(chain, problem.tool);
  const Limits& limits = problem.limits;
  std::vector<LargeLength> found;
  const auto look = [&](const char* section, const char* key, const std::optional<double>& value,
                        double most, const char* unit) {
    if (value && *value > most)
      found.push_back(
          {section, key, formatted("is %.4g ", *value) + unit + suspicion(reach), most});
  };
  const double tolerance = reach / 4, speed = 10 * reach;
  look("limits", "clearance", limits.clearance, reach, "m");
  look("limits", "self_clearance", limits.self_clearance, reach, "m");
  look("limits", "edge_clearance", limits.edge_clearance, reach, "m");
  look("limits", "edge_tolerance", limits.edge_tolerance, tolerance, "m");
  look("limits", "tool_path_error", limits.tool_path_error, tolerance, "m");
  look("limits", "tool_speed", limits.tool_speed, speed, "m/s");
  if (problem.smooth) look("path.smooth", "position", problem.smooth->position, tolerance, "m");
  const auto look_at_turn = [&](const char* key, const std::optional<double>& value, double most,
                                const char* unit) {
    if (value && *value > most)
      found.push_back({"limits", key, formatted("is %.4g ", *value) + unit + kAskDegrees, most});
  };
  look_at_turn("joint_step", limits.joint_step, kTwoPi, "rad");
  look_at_turn("tool_angle_error", limits.tool_angle_error, kPi, "rad");
  look_at_turn("tool_turn_speed", limits.tool_turn_speed, kMostTurnSpeed, "rad/s");
  for (std::size_t k = 0; limits.joint_speed && k < kDof; ++k) {
    const double joint_speed = (*limits.joint_speed)[k];
    if (chain.limit[k].slides || joint_speed <= kMostTurnSpeed) continue;
    look_at_turn("joint_speed", joint_speed, kMostTurnSpeed, "rad/s");
    break;
  }
  return found;
}

std::vector<std::string> limit_scale_warnings(const Chain& chain, const PathProblem& problem) {
  std::vector<std::string> warnings;
  for (const LargeLength& one : large_lengths(chain, problem))
    warnings.push_back(one.section + "." + one.key + " " + one.fault);
  return warnings;
}

std::vector<std::string> scale_warnings(const Chain& chain, const Robot& robot) {
  Scale scale(reach_of_arm(chain, robot.tool));
  scale.length("robot.tool", robot.tool.translation().norm());
  for (const Link& link : robot.model->links)
    for (const PlacedShape& body : link.collision)
      scale.size("robot: link '" + link.name + "'", body.shape);
  for (const AttachedBody& body : robot.attached) {
    scale.size("robot.attached: '" + body.name + "'", body.shape);
    scale.length("robot.attached: the way from its link to '" + body.name + "'",
                 body.pose.translation().norm());
  }
  std::vector<std::string> warnings = scale.take();
  for (std::string& warning : turn_warnings(chain, *robot.model))
    warnings.push_back(std::move(warning));
  return warnings;
}

std::vector<std::string> scale_warnings(const Chain& chain, const ToolPath& path,
                                        const std::vector<SceneObject>& scene) {
  Scale scale(most_reach(chain));
  const auto away = [&](const Pose& pose) { return (pose.translation() - chain.point[0]).norm(); };
  if (const auto far = first_far_waypoint(chain, path))
    scale.distance("path: waypoint " + std::to_string(path.layer(*far).waypoint),
                   away(path.layer(*far).tool), " (a path's file may have `units: mm`)");
  for (const SceneObject& object : scene) {
    scale.size("scene: '" + object.name + "'", object.shape);
    scale.distance("scene: '" + object.name + "'", away(object.pose) - size_of(object.shape).most);
  }
  return scale.take();
}

}  // namespace swivel
