// SPDX-License-Identifier: BSD-3-Clause
#include "problems/problem_difference.hpp"

#include <algorithm>
#include <variant>

namespace swivel::io {

namespace {

template <class Item, class Same>
bool same_lists(const std::vector<Item>& a, const std::vector<Item>& b, const Same& same) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
}

bool same_pose(const Pose& a, const Pose& b) {
  constexpr double kRounded = 4e-15;  // of a rotation that goes through a quaternion
  return a.translation() == b.translation() &&
         (a.linear() - b.linear()).cwiseAbs().maxCoeff() <= kRounded;
}

bool same_shape(const Shape& a, const Shape& b) {
  const MeshPtr *const x = std::get_if<MeshPtr>(&a), *const y = std::get_if<MeshPtr>(&b);
  if (x == nullptr || y == nullptr) return a == b;
  return *x == *y || ((*x)->vertices == (*y)->vertices && (*x)->triangles == (*y)->triangles &&
                      (*x)->closed == (*y)->closed);
}

bool same_link(const Link& a, const Link& b) {
  return a.name == b.name && a.parent_joint == b.parent_joint &&
         same_lists(a.collision, b.collision, [](const PlacedShape& x, const PlacedShape& y) {
           return same_pose(x.pose, y.pose) && same_shape(x.shape, y.shape);
         });
}

bool same_joint(const Joint& a, const Joint& b) {
  const auto mimics = [](const Joint& joint) {
    return joint.mimic
               ? std::tuple(joint.mimic->joint, joint.mimic->multiplier, joint.mimic->offset)
               : std::tuple(-1, 0.0, 0.0);
  };
  const auto hard = [](const Joint& joint) {
    return joint.hard ? std::optional(std::pair(joint.hard->lower, joint.hard->upper))
                      : std::nullopt;
  };
  const auto numbers = [](const Joint& joint) {
    return std::tuple(joint.type, joint.parent_link, joint.child_link, joint.lower, joint.upper,
                      joint.velocity, joint.acceleration, joint.jerk, joint.passive);
  };
  return a.name == b.name && numbers(a) == numbers(b) && a.axis == b.axis &&
         same_pose(a.origin, b.origin) && mimics(a) == mimics(b) && hard(a) == hard(b);
}

bool same_model(const RobotModel& a, const RobotModel& b) {
  return a.name == b.name && a.root_link == b.root_link && a.has_srdf == b.has_srdf &&
         a.disabled_pairs == b.disabled_pairs && same_lists(a.links, b.links, same_link) &&
         same_lists(a.joints, b.joints, same_joint);
}

bool same_object(const SceneObject& a, const SceneObject& b) {
  return a.name == b.name && a.allow == b.allow && same_pose(a.pose, b.pose) &&
         same_shape(a.shape, b.shape);
}

std::vector<AttachedBody> by_name(std::vector<AttachedBody> bodies) {
  std::sort(bodies.begin(), bodies.end(),
            [](const AttachedBody& a, const AttachedBody& b) { return a.name < b.name; });
  return bodies;
}

std::string difference_of_robots(const Robot& a, const Robot& b) {
  if (a.model != b.model && !same_model(*a.model, *b.model)) return "robot";
  if (a.base_link != b.base_link) return "robot.base_link";
  if (a.tip_link != b.tip_link) return "robot.tip_link";
  if (!same_pose(a.tool, b.tool)) return "robot.tool";
  if (a.hold != b.hold) return "robot.hold";
  if (a.roll != b.roll) return "path.roll";
  const bool attached = same_lists(
      by_name(a.attached), by_name(b.attached), [](const AttachedBody& x, const AttachedBody& y) {
        return x.name == y.name && x.link == y.link && same_pose(x.pose, y.pose) &&
               same_shape(x.shape, y.shape);
      });
  return attached ? "" : "robot.attached";
}

/// Returns a task in the way in which a file states it.
Task as_stated(const Task& given, const std::string& base_link) {
  Task task = given;
  if (task.path_frame.empty()) task.path_frame = base_link;
  if (!task.start) task.start_tolerance = Task().start_tolerance;
  return task;
}

std::string difference_of_tasks(const Task& a, const Task& b) {
  if (a.path_frame != b.path_frame) return "path.frame";
  if (a.waypoints != b.waypoints) return "path.waypoints";
  if (a.smooth != b.smooth) return "path.smooth";
  if (a.end != b.end) return "path.end";
  if (a.closed != b.closed) return "path.closed";
  if (a.resolution != b.resolution) return "resolution";
  if (a.limits != b.limits) return "limits";
  if (a.start != b.start) return "start";
  if (a.start_at != b.start_at) return "start_at";
  if (a.start_tolerance != b.start_tolerance) return "start_tolerance";
  if (a.cost != b.cost) return "cost";
  if (a.refinement != b.refinement) return "refine";
  return a == b ? "" : "the path's layers";  // chosen rolls or steps, of which no file speaks
}

bool same_variation(const Variation& a, const Variation& b) {
  return a.object == b.object && a.xyz == b.xyz && a.rpy == b.rpy;
}

std::string difference_of_strokes(const Stroke& a, const Stroke& b, const std::string& base_link) {
  if (a.name != b.name) return "name";
  if (std::string task = difference_of_tasks(as_stated(a, base_link), as_stated(b, base_link));
      !task.empty())
    return task;
  if (a.reversible != b.reversible) return "reversible";
  if (a.approach != b.approach) return "approach";
  if (a.retract != b.retract) return "retract";
  if (a.process_speed != b.process_speed) return "process_speed";
  if (a.approach_speed != b.approach_speed) return "approach_speed";
  if (a.feed != b.feed) return "feed";
  return a.piece == b.piece ? "" : "lift-off";
}

}  // namespace

std::string difference(const PathProblem& a, const PathProblem& b) {
  if (std::string robot = difference_of_robots(a, b); !robot.empty()) return robot;
  if (std::string task = difference_of_tasks(as_stated(a, a.base_link), as_stated(b, b.base_link));
      !task.empty())
    return task;
  if (!same_lists(a.scene, b.scene, same_object)) return "scene";
  return same_lists(a.vary, b.vary, same_variation) ? "" : "vary";
}

std::string difference(const Problem& before, const Problem& after) {
  const ArmTask &a = before.arm(), &b = after.arm();
  if (std::string robot = difference_of_robots(a, b); !robot.empty()) return robot;
  if (a.strokes.size() != b.strokes.size()) return "number of strokes";
  for (std::size_t k = 0; k < a.strokes.size(); ++k)
    if (std::string stroke = difference_of_strokes(a.strokes[k], b.strokes[k], a.base_link);
        !stroke.empty())
      return stroke + " of stroke '" + a.strokes[k].name + "'";
  if (!same_lists(before.scene, after.scene, same_object)) return "scene";
  if (!same_lists(before.vary, after.vary, same_variation)) return "vary";
  if (a.transition_limits != b.transition_limits) return "limits";
  if (a.home != b.home) return "home";
  if (a.order != b.order) return "order";
  if (a.process_speed != b.process_speed) return "process_speed";
  if (a.approach_speed != b.approach_speed) return "approach_speed";
  if (a.rapid != b.rapid) return "rapid";
  return a.lift == b.lift ? "" : "lift";
}

}  // namespace swivel::io
