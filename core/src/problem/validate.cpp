// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/problem/validate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/invalid_argument.hpp"

namespace swivel {

namespace {

/// The path of a value within a problem, such as scene[2].pose. Its text is made only for a
/// message, so that validating a valid problem allocates nothing.
struct Field {
  const Field* parent = nullptr;
  const char* name = "";
  std::ptrdiff_t index = -1;
  [[nodiscard]] Field operator()(const char* member) const { return {this, member}; }
  [[nodiscard]] Field operator()(const char* list, std::size_t at) const {
    return {this, list, static_cast<std::ptrdiff_t>(at)};
  }
  [[nodiscard]] std::string text() const {
    std::string result = parent ? parent->text() : "";
    if (!result.empty()) result += parent->parent ? "." : ": ";
    result += name;
    if (index >= 0) result += "[" + std::to_string(index) + "]";
    return result;
  }
};

[[noreturn]] void fail(const Field& field, const std::string& what, const std::string& allowed) {
  throw InvalidArgument(field.text() + ": " + what + ": allowed is " + allowed);
}

constexpr std::int64_t kMostSteps = 2'000'000;  // of a path: each layer takes about 1 kB

enum class Range { kFinite, kNonNegative, kPositive, kLength };

void number(const Field& field, double value, Range range) {
  if (range == Range::kLength
          ? value > 0 && value <= kMostMetres
          : std::isfinite(value) && (range == Range::kFinite || value > 0 ||
                                     (value == 0 && range == Range::kNonNegative)))
    return;
  const std::string text = formatted("is %g", value);
  fail(field, text,
       range == Range::kFinite        ? "a finite number"
       : range == Range::kNonNegative ? "a finite number >= 0"
       : range == Range::kLength      ? "a number > 0, at most 1000"
                                      : "a finite number > 0");
}
void number(const Field& field, const std::optional<double>& value, Range range) {
  if (value) number(field, *value, range);
}
template <class Vector>
void numbers(const Field& field, const Vector& values, Range range) {
  for (Eigen::Index k = 0; k < values.size(); ++k)
    number({field.parent, field.name, k}, values[k], range);
}

void pose(const Field& field, const Pose& pose) {
  constexpr double kTolerance = 1e-6;
  const Matrix3d R = pose.linear();
  if (!pose.matrix().allFinite())
    fail(field, "has numbers that are not finite", "a rotation and a finite translation");
  // The bound is twice that of files, since campaigns move objects.
  if (!(pose.translation().array().abs() <= 2 * kMostMetres).all())
    fail(field, "is too far away", "a translation within 2000 m");
  if (!((R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff() <= kTolerance &&
        R.determinant() > 0 && pose.matrix().row(3) == Eigen::RowVector4d(0, 0, 0, 1)))
    fail(field, "is no rigid transform", "a rotation within 1e-6 and a finite translation");
}

void mesh(const Field& field, const MeshPtr& mesh) {
  if (!mesh) fail(field, "is a null mesh", "a mesh");
  for (const Vector3d& vertex : mesh->vertices)
    if (!(vertex.array().abs() <= kMostMetres).all())  // NaN fails this too
      fail(field, "has a vertex that is not finite or too far away", "vertices within 1000 m");
  const auto count = static_cast<int>(mesh->vertices.size());
  for (const auto& triangle : mesh->triangles)
    for (const int corner : triangle)
      if (corner < 0 || corner >= count)
        fail(field, "has a triangle without a vertex", "indices of the mesh's vertices");
}

void shape(const Field& field, const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    number(field("radius"), sphere->radius, Range::kLength);
  if (const auto* box = std::get_if<Box>(&shape)) numbers(field("size"), box->size, Range::kLength);
  const auto round = [&](const auto& body) {
    number(field("radius"), body.radius, Range::kLength);
    number(field("length"), body.length, Range::kLength);
  };
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) round(*cylinder);
  if (const auto* capsule = std::get_if<Capsule>(&shape)) round(*capsule);
  if (const auto* triangles = std::get_if<MeshPtr>(&shape)) mesh(field, *triangles);
}

/// Throws unless every item of a list has a valid name that no other item has.
template <class Item>
void names(const Field& parent, const char* list, const std::vector<Item>& items) {
  std::vector<std::pair<std::string_view, std::size_t>> sorted;
  sorted.reserve(items.size());
  for (std::size_t k = 0; k < items.size(); ++k) {
    if (items[k].name.empty()) fail(parent(list, k)("name"), "is empty", "a name of its own");
    if (!is_valid_name(items[k].name))
      fail(parent(list, k)("name"), "is '" + printable(items[k].name) + "'", kValidName);
    sorted.emplace_back(items[k].name, k);
  }
  std::sort(sorted.begin(), sorted.end());
  const auto twice =
      std::adjacent_find(sorted.begin(), sorted.end(),
                         [](const auto& a, const auto& b) { return a.first == b.first; });
  if (twice != sorted.end())
    fail(parent(list, std::next(twice)->second)("name"),
         "'" + std::string(twice->first) + "' is taken", "a name of its own");
}

bool named(const std::vector<SceneObject>& scene, const std::string& name) {
  return std::any_of(scene.begin(), scene.end(),
                     [&](const auto& object) { return object.name == name; });
}
bool named(const std::vector<AttachedBody>& attached, const std::string& name) {
  return std::any_of(attached.begin(), attached.end(),
                     [&](const auto& body) { return body.name == name; });
}

void validate_robot(const Field& root, const PathProblem& problem) {
  if (!problem.model) fail(root("model"), "is null", "a robot model, as io::load_robot gives it");
  pose(root("tool"), problem.tool);
  for (const auto& [joint, position] : problem.hold)
    number(root("hold")(joint.c_str()), position, Range::kFinite);
  if (problem.roll) {
    number(root("roll")("lower"), problem.roll->lower, Range::kFinite);
    number(root("roll")("upper"), problem.roll->upper, Range::kFinite);
    if (!(problem.roll->lower < problem.roll->upper))
      fail(root("roll")("lower"), "is not below `upper`", "lower < upper");
  }
  names(root, "attached", problem.attached);
  for (std::size_t k = 0; k < problem.attached.size(); ++k) {
    const AttachedBody& body = problem.attached[k];
    const Field field = root("attached", k);
    if (problem.model->find_link(body.name) >= 0)
      fail(field("name"), "'" + body.name + "' is a link", "a name of its own");
    if (problem.model->find_link(body.link) < 0)
      fail(field("link"), "unknown link '" + body.link + "'", "a link of the robot");
    shape(field("shape"), body.shape);
    pose(field("pose"), body.pose);
  }
}

void validate_scene(const Field& root, const PathProblem& problem) {
  names(root, "scene", problem.scene);
  for (std::size_t k = 0; k < problem.scene.size(); ++k) {
    const SceneObject& object = problem.scene[k];
    const Field field = root("scene", k);
    if (object.name == problem.base_link)
      fail(field("name"), "'" + object.name + "' is the base link", "a name of its own");
    if (named(problem.attached, object.name))
      fail(field("name"), "'" + object.name + "' is an attached body", "a name of its own");
    shape(field("shape"), object.shape);
    pose(field("pose"), object.pose);
    for (std::size_t i = 0; i < object.allow.size(); ++i) {
      const Allowed& allowed = object.allow[i];
      if (problem.model->find_link(allowed.body) < 0 && !named(problem.attached, allowed.body))
        fail(field("allow", i), "unknown body '" + printable(allowed.body) + "'",
             "a link of the robot or the name of an attached body");
      number(field("allow", i)("depth"), allowed.depth, Range::kLength);
      if (const auto fault = depth_fault(problem, object, allowed))
        fail(field("allow", i)("depth"), fault->what, fault->allowed);
    }
  }
  for (std::size_t k = 0; k < problem.vary.size(); ++k) {
    const Field field = root("vary", k);
    if (!named(problem.scene, problem.vary[k].object))
      fail(field("object"), "unknown object '" + problem.vary[k].object + "'",
           "the name of a scene object");
    numbers(field("xyz"), problem.vary[k].xyz, Range::kNonNegative);
    numbers(field("rpy"), problem.vary[k].rpy, Range::kNonNegative);
  }
}

/// Returns a bound on how deep a point can lie beneath the shape's surface, m.
double most_beneath(const Shape& shape) {
  struct Visitor {
    double operator()(const Sphere& s) const { return s.radius; }
    double operator()(const Capsule& c) const { return c.radius; }
    double operator()(const Box& b) const { return b.size.minCoeff() / 2; }
    double operator()(const Cylinder& c) const { return std::min(c.radius, c.length / 2); }
    double operator()(const MeshPtr& mesh) const {
      Eigen::AlignedBox3d box;
      for (const Vector3d& vertex : mesh->vertices) box.extend(vertex);
      return box.sizes().minCoeff() / 2;
    }
  };
  return std::visit(Visitor{}, shape);
}

std::optional<DepthFault> depth_fault(const Shape& body, const Shape& object, double depth) {
  const auto* const mesh_of_body = std::get_if<MeshPtr>(&body);
  const auto* const mesh_of_object = std::get_if<MeshPtr>(&object);
  for (const auto* mesh : {mesh_of_body, mesh_of_object})
    if (mesh && !(*mesh)->closed)
      return DepthFault{
          "mesh " + printable((*mesh)->source) + " is not closed: nothing is deep in it",
          "a closed mesh, or no depth"};
  if (mesh_of_body && mesh_of_object)
    return DepthFault{"both are meshes, of which no depth can be proved",
                      "a depth where one of the two is a sphere, capsule, cylinder or box (swivel "
                      "fit makes capsules)"};
  if (const double most = most_beneath(body) + most_beneath(object); depth >= most)
    return DepthFault{
        formatted("is %.6g, which no depth exceeds: the two are at most %.6g m deep in each other",
                  depth, most),
        formatted("a number below %.6g, or no depth", most)};
  return std::nullopt;
}

}  // namespace

std::optional<DepthFault> depth_fault(const Robot& robot, const SceneObject& object,
                                      const Allowed& allowed) {
  if (!allowed.depth) return std::nullopt;
  for (const AttachedBody& body : robot.attached)
    if (body.name == allowed.body) return depth_fault(body.shape, object.shape, *allowed.depth);
  const int link = robot.model->find_link(allowed.body);
  if (link < 0) return std::nullopt;
  const auto& shapes = robot.model->links[static_cast<std::size_t>(link)].collision;
  if (shapes.empty())
    return DepthFault{"'" + printable(allowed.body) + "' has no collision shape",
                      "a body that has one"};
  for (const PlacedShape& placed : shapes)
    if (auto fault = depth_fault(placed.shape, object.shape, *allowed.depth)) return fault;
  return std::nullopt;
}

namespace {

void validate_window(const Field& field, const PathProblem& problem, const Waypoint& waypoint) {
  if (waypoint.roll.has_value() != problem.waypoints.front().roll.has_value())
    fail(field, "is not given at all waypoints", "a range at each waypoint, or at none");
  if (!waypoint.roll) return;
  number(field("lower"), waypoint.roll->lower, Range::kFinite);
  number(field("upper"), waypoint.roll->upper, Range::kFinite);
  if (!(waypoint.roll->lower <= waypoint.roll->upper))
    fail(field("lower"), "is above `upper`", "lower <= upper");
  if (!problem.roll || problem.roll->circle())
    fail(field,
         "is given, but the robot's roll is " + std::string(problem.roll ? "a circle" : "not free"),
         "a robot whose roll has a range of less than a turn");
  if (!(waypoint.roll->lower >= problem.roll->lower && waypoint.roll->upper <= problem.roll->upper))
    fail(field, "is not within the robot's roll", "a part of its range");
}

void validate_path(const Field& root, const PathProblem& problem) {
  if (!problem.path_frame.empty() && problem.path_frame != problem.base_link &&
      !named(problem.scene, problem.path_frame))
    fail(root("path_frame"), "unknown frame '" + problem.path_frame + "'",
         "the base link or the name of a scene object");
  for (std::size_t k = 0; k < problem.waypoints.size(); ++k) {
    const Waypoint& waypoint = problem.waypoints[k];
    const Field field = root("waypoints", k);
    numbers(field("position"), waypoint.position, Range::kFinite);
    if (!(std::abs(waypoint.orientation.norm() - 1) <= 1e-3))
      fail(field("orientation"), "is no rotation", "a finite quaternion of length 1 within 1e-3");
    validate_window(field("roll"), problem, waypoint);
  }
  if (problem.steps.empty()) return;
  if (problem.steps.size() + 1 != problem.waypoints.size())
    fail(root("steps"), "has " + std::to_string(problem.steps.size()) + " entries",
         "one for each waypoint but the last");
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < problem.steps.size(); ++k) {
    sum += problem.steps[k];
    if (problem.steps[k] < 1 || sum > kMostSteps)
      fail(root("steps", k), "is " + std::to_string(problem.steps[k]),
           "a number of at least 1, of at most 2e6 in all");
  }
}

/// Throws for a start or an end that is not finite, and for a place or a tolerance of the start
/// that makes no sense.
void validate_postures(const Field& root, const PathProblem& problem) {
  if (problem.start) numbers(root("start"), *problem.start, Range::kFinite);
  if (problem.end) numbers(root("end"), *problem.end, Range::kFinite);
  if (problem.closed && (problem.start || problem.end) && problem.start != problem.end)
    fail(root("closed"), "is given beside a start or an end",
         "neither, or both with the same joints");
  if (problem.closed && problem.start_at)
    fail(root("closed"), "is given beside start_at", "one of the two");
  if (problem.start_at && !problem.start)
    fail(root("start_at"), "is given without a start", "a number beside a start");
  number(root("start_at"), problem.start_at, Range::kNonNegative);
  number(root("start_tolerance"), problem.start_tolerance, Range::kPositive);
  if (problem.start_tolerance > kMostStartTolerance)
    fail(root("start_tolerance"), "is more than 0.1", "a number > 0, at most 0.1");
}

void validate_numbers(const Field& root, const PathProblem& problem) {
  constexpr auto kPositive = Range::kPositive, kNonNegative = Range::kNonNegative;
  const Field resolution = root("resolution");
  number(resolution("ds"), problem.resolution.ds, kPositive);
  number(resolution("dphi"), problem.resolution.dphi, kPositive);
  if (problem.resolution.dphi > kTwoPi)
    fail(resolution("dphi"), "is more than a turn", "a finite number > 0, at most 2*pi");
  number(resolution("dalpha"), problem.resolution.dalpha, kPositive);
  number(resolution("droll"), problem.resolution.droll, kPositive);
  number(resolution("knot"), problem.resolution.knot, Range::kNonNegative);
  if (problem.resolution.arc) number(resolution("arc"), *problem.resolution.arc, kPositive);
  const Field field = root("limits");
  const Limits& limits = problem.limits;
  number(field("clearance"), limits.clearance, kNonNegative);
  number(field("self_clearance"), limits.self_clearance, kNonNegative);
  number(field("manipulability"), limits.manipulability, kNonNegative);
  number(field("joint_margin"), limits.joint_margin, kNonNegative);
  number(field("joint_step"), limits.joint_step, kPositive);
  number(field("arm_slope"), limits.arm_slope, kPositive);
  number(field("roll_slope"), limits.roll_slope, kPositive);
  number(field("step_error"), limits.step_error, kPositive);
  number(field("tool_path_error"), limits.tool_path_error, kPositive);
  number(field("tool_angle_error"), limits.tool_angle_error, kPositive);
  number(field("tool_speed"), limits.tool_speed, kPositive);
  number(field("tool_turn_speed"), limits.tool_turn_speed, kPositive);
  number(field("edge_clearance"), limits.edge_clearance, kNonNegative);
  number(field("edge_tolerance"), limits.edge_tolerance, kPositive);
  const auto rates = [&](const char* name, const std::optional<std::array<double, kDof>>& values) {
    for (std::size_t k = 0; values && k < kDof; ++k)
      number(field(name, k), (*values)[k], kPositive);
  };
  rates("joint_speed", limits.joint_speed);
  rates("joint_acceleration", limits.joint_acceleration);
  rates("joint_jerk", limits.joint_jerk);
  if (problem.smooth) {
    number(root("smooth")("position"), problem.smooth->position, kNonNegative);
    number(root("smooth")("angle"), problem.smooth->angle, kNonNegative);
  }
  const Field refine = root("refine");
  number(refine("smoothing"), problem.refinement.smoothing, kNonNegative);
  number(refine("joint_margin"), problem.refinement.joint_margin, kNonNegative);
  number(refine("singular_margin"), problem.refinement.singular_margin, kNonNegative);
  validate_postures(root, problem);
  for (std::size_t k = 0; problem.cost.weights && k < kDof; ++k) {
    const double weight = (*problem.cost.weights)[k];
    if (weight_allowed(weight)) continue;
    const std::string text = formatted("is %g", weight);
    fail(root("cost")("weights", k), text, kAllowedWeights);
  }
  if (!weight_allowed(problem.cost.roll))
    fail(root("cost")("roll"), "is no weight", kAllowedWeights);
  if (problem.cost.roll > 0 && !problem.roll)
    fail(root("cost")("roll"), "is given, but no roll is free", "0, or a problem with a roll");
}

void validate_joint(const Field& field, const Joint& joint, const RobotModel& robot) {
  const auto index = [&](const char* name, int value, std::size_t size) {
    if (value < 0 || static_cast<std::size_t>(value) >= size)
      fail(field(name), "is " + std::to_string(value), "an index of the robot model");
  };
  index("parent_link", joint.parent_link, robot.links.size());
  index("child_link", joint.child_link, robot.links.size());
  pose(field("origin"), joint.origin);
  if (!joint.movable()) return;
  if (!(std::abs(joint.axis.norm() - 1) <= 1e-6))
    fail(field("axis"), "is no unit vector", "a finite vector of length 1 within 1e-6");
  if (!(joint.velocity >= 0))
    fail(field("velocity"), "is negative or not a number", "a number >= 0, 0 for none");
  if (!(joint.acceleration >= 0))
    fail(field("acceleration"), "is negative or not a number", "a number >= 0, 0 for none");
  if (!(joint.jerk >= 0))
    fail(field("jerk"), "is negative or not a number", "a number >= 0, 0 for none");
  if (joint.type != Joint::Type::kContinuous && !(joint.lower <= joint.upper))
    fail(field("lower"), "is not a number up to `upper`", "lower <= upper");
  if (!joint.mimic) return;
  index("mimic.joint", joint.mimic->joint, robot.joints.size());
  number(field("mimic.multiplier"), joint.mimic->multiplier, Range::kFinite);
  number(field("mimic.offset"), joint.mimic->offset, Range::kFinite);
}

}  // namespace

bool weight_allowed(double weight) {
  return weight == 0 || (weight >= 1e-6 && weight <= 1e6);
}

void validate(const PathProblem& problem) {
  const Field root{nullptr, problem.source.empty() ? "problem" : problem.source.c_str()};
  validate_robot(root, problem);
  validate_scene(root, problem);
  validate_path(root, problem);
  validate_numbers(root, problem);
}

void validate(const Pose& object_pose, const std::string& object) {
  const Field root{nullptr, object.c_str()};
  pose(root("pose"), object_pose);
}

void validate(const RobotModel& robot) {
  const Field root{nullptr, robot.source.empty() ? "robot" : robot.source.c_str()};
  names(root, "links", robot.links);
  names(root, "joints", robot.joints);
  if (robot.root_link < 0 || static_cast<std::size_t>(robot.root_link) >= robot.links.size())
    fail(root("root_link"), "is " + std::to_string(robot.root_link), "an index of the robot model");
  for (std::size_t j = 0; j < robot.joints.size(); ++j)
    validate_joint(root("joints", j), robot.joints[j], robot);
  for (std::size_t k = 0; k < robot.links.size(); ++k) {
    const Link& link = robot.links[k];
    const Field field = root("links", k);
    if (link.parent_joint >= static_cast<int>(robot.joints.size()) ||
        (link.parent_joint >= 0 &&
         robot.joints[static_cast<std::size_t>(link.parent_joint)].child_link !=
             static_cast<int>(k)))
      fail(field("parent_joint"), "is " + std::to_string(link.parent_joint),
           "the index of the joint that has this link as its child");
    for (std::size_t i = 0; i < link.collision.size(); ++i) {
      shape(field("collision", i)("shape"), link.collision[i].shape);
      pose(field("collision", i)("pose"), link.collision[i].pose);
    }
  }
  // Follow each link up to the root; links seen in an earlier round are known to lead there.
  std::vector<std::size_t> seen(robot.links.size(), 0);
  for (std::size_t first = 0; first < robot.links.size(); ++first)
    for (std::size_t link = first; seen[link] == 0 || seen[link] == first + 1;) {
      if (seen[link] == first + 1)
        fail(root("links", first)("parent_joint"), "closes a loop", "a tree of links");
      seen[link] = first + 1;
      if (robot.links[link].parent_joint < 0) break;
      link = static_cast<std::size_t>(
          robot.joints[static_cast<std::size_t>(robot.links[link].parent_joint)].parent_link);
    }
}

}  // namespace swivel
