// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "files/bad_input.hpp"
#include "files/files.hpp"
#include "problems/path_file.hpp"
#include "problems/problem_reader.hpp"
#include "robots/joint_limits.hpp"
#include "robots/srdf.hpp"
#include "robots/urdf.hpp"
#include "schema/yaml_value.hpp"
#include "swivel/core/base/rpy.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/nearest_name.hpp"
#include "swivel/core/messages/robot_key_error.hpp"
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/io/meshes/mesh.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/io/robots/robot.hpp"

namespace swivel::io {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostBodies = 10'000;  // of objects in the scene, and of attached bodies

/// Returns the joints of an arm of six joints with the roll, the seventh, at which the tool stands
/// as a waypoint has it, in the turn nearest to the middle of the roll's range.
Config with_roll_onto(const Waypoint& waypoint, const Chain& chain, Config q) {
  const auto tool_at = [&](double roll) {
    q[kDof - 1] = roll;
    return chain.tool(q);
  };
  Pose wanted = Pose::Identity();
  wanted.linear() = waypoint.orientation.normalized().toRotationMatrix();
  const Pose unturned = tool_at(0);
  const double away = roll_between(unturned, wanted);
  const bool reversed = roll_between(unturned, tool_at(0.1)) < 0;
  const JointLimit& limit = chain.limit.back();
  const double middle = limit.continuous ? 0 : (limit.lower + limit.upper) / 2,
               roll = reversed ? -away : away;
  q[kDof - 1] = roll + kTwoPi * std::round((middle - roll) / kTwoPi);
  return q;
}

Vector3d vector3_or_zero(const YamlSection& section, const std::string& key) {
  const auto value = section.find_filled(key);
  return value ? value->vector3() : Vector3d::Zero();
}

/// Throws InputError for angles beyond a turn, which are likely to be in degrees.
void require_radians(const YamlValue& value, std::initializer_list<double> angles) {
  for (const double angle : angles)
    if (std::abs(angle) > kTwoPi + 1e-6)
      value.fail(
          formatted("is %.6g rad", angle) + ": are these degrees? Angles are read as radians",
          formatted("-%.6g to %.6g, a turn", kTwoPi, kTwoPi));
}

/// Returns roll, pitch and yaw. Throws InputError as require_radians() does.
Vector3d rpy_of(const YamlValue& value) {
  const Vector3d rpy = value.vector3();
  require_radians(value, {rpy.x(), rpy.y(), rpy.z()});
  return rpy;
}

/// Returns the orientation of a section by its `quat` or `rpy`; the identity if it has neither. A
/// quaternion is returned as written: not zero, but perhaps not of unit length.
Quaterniond orientation(const YamlSection& section) {
  const auto given = section.chosen("quat");
  if (!given) return Quaterniond::Identity();
  const auto& [key, value] = *given;
  if (key == "rpy") return from_rpy(rpy_of(value));
  const std::vector<double> q = value.numbers();
  const Quaterniond result(q[0], q[1], q[2], q[3]);
  if (!(result.norm() > 1e-9) || !std::isfinite(result.norm()))
    value.fail("quaternion has no direction", "[w, x, y, z] of length 1");
  return result;
}

Pose pose(const YamlSection& section) {
  Pose result = Pose::Identity();
  result.translation() = vector3_or_zero(section, "xyz");
  result.linear() = orientation(section).normalized().toRotationMatrix();
  return result;
}

Waypoint waypoint(const YamlValue& value) {
  const YamlSection section = value.section();
  Waypoint result;
  result.position = section.require("xyz").vector3();
  result.orientation = orientation(section);
  const double norm = result.orientation.norm();
  if (!(std::abs(norm - 1) <= 1e-3))
    section.find("quat")->fail("quaternion has length " + format_double(norm),
                               "a quaternion of length 1 within 1e-3");
  if (const auto roll = section.find("roll")) {
    const std::vector<double> ends = roll->numbers();
    result.roll = Roll{ends[0], ends[1]};
    if (!(ends[0] <= ends[1])) roll->fail("is empty", "[lower, upper] with lower <= upper");
  }
  return result;
}

template <class Round>
Round round_shape(const YamlValue& value) {
  const YamlSection section = value.section();
  const double radius = section.require("radius").number();
  return {radius, section.require("length").number()};
}

Sphere sphere(const YamlValue& value) {
  if (!value.is_map()) return {value.number()};
  return {value.section().require("radius").number()};
}

}  // namespace

PathProblem ProblemReader::read() {
  require_one_path();
  read_surroundings();
  const YamlValue path = root_.require("path");
  read_path(path);
  read_task();
  const ArmModel model = suitable_arm();
  require_free_axis(model);
  const auto limits = root_.find_filled("limits");
  require_in_scale(model, path, limits ? std::vector{*limits} : std::vector<YamlValue>());
  require_used(unused_keys_of(model));
  if (const auto value = root_.find_filled("start")) read_start(*value);
  read_start_place();
  read_end(path, model.chain);
  read_closed(path, model.chain);
  read_cost();
  read_vary();
  return std::move(problem_);
}

void ProblemReader::require_one_path() const {
  if (root_.find_filled("strokes")) {
    const auto [key, value] = *root_.chosen("path");  // throws where there is a path as well
    value.fail(
        "makes this file a job, which `swivel plan`, `check`, `time`, `campaign`, `place` and "
        "io::load_problem() take",
        "a `path` here");
  }
  if (root_.find_filled("arms")) {
    const auto [key, value] = *root_.chosen("path");  // throws where there is a path as well
    value.fail(
        "makes this file a workcell, which `swivel plan`, `check`, `time`, `campaign`, `place` and "
        "io::load_problem() take",
        "a `path` here");
  }
  if (lift_offs_of(root_))
    root_.find_filled("lift")->fail(
        "makes this file a job, which `swivel plan`, `check`, `time`, `campaign`, `place` and "
        "io::load_problem() take",
        "no `lift` here");
  require_keys_beside();
}

void ProblemReader::require_keys_beside() const {
  require_keys_beside(root_, problem_schema());
}

void ProblemReader::require_keys_beside(const YamlSection& section, const Schema& schema) {
  for (const Schema::Key& key : schema.keys)
    if (!key.beside.empty() && !section.find_filled(key.beside))
      if (const auto value = section.find_filled(key.name))
        value->fail("is given without " + key.beside, "this key beside " + key.beside);
}

void ProblemReader::require_free_axis(const ArmModel& model) const {
  if (!free_axis_ || !model.chain.free_roll) return;
  try {
    static_cast<void>(fit_srs(model.chain, problem_.model->source));
  } catch (const NotSrs& error) {
    free_axis_->fail(
        "has the tool's axis alone, about which an arm of seven joints can turn it only if it is "
        "S-R-S; here " +
            error.why(),
        "the direction of the tool's x axis besides (tangents or quaternions), or one joint less "
        "(robot.hold)");
  }
}

void ProblemReader::read_surroundings() {
  problem_.source = file_.string();
  read_robot(root_.require("robot"));
  read_scene();
}

void ProblemReader::read_task() {
  if (const auto value = root_.find_filled("resolution")) read_resolution(*value);
  if (const auto value = root_.find_filled("limits")) read_limits(*value);
  if (const auto value = root_.find_filled("refine")) read_refine(*value);
}

fs::path ProblemReader::resolve(const YamlValue& name) const {
  return (file_.parent_path() / name.text()).lexically_normal();
}

std::string ProblemReader::link_name(const YamlValue& value) const {
  const std::string name = value.text();
  if (problem_.model->find_link(name) >= 0) return name;
  std::vector<std::string> known;
  for (const Link& link : problem_.model->links) known.push_back(link.name);
  value.fail("unknown link '" + name + "', nearest is '" + nearest_name(name, known) + "'",
             "a link of " + problem_.model->source);
}

bool ProblemReader::is_attached(const std::string& name) const {
  return std::any_of(problem_.attached.begin(), problem_.attached.end(),
                     [&](const auto& body) { return body.name == name; });
}

bool ProblemReader::is_object(const std::string& name) const {
  return std::any_of(problem_.scene.begin(), problem_.scene.end(),
                     [&](const auto& object) { return object.name == name; });
}

void ProblemReader::read_robot(const YamlValue& value) {
  static_cast<void>(value.section().require("tip_link"));
  read_model(value);
  read_hand(value);
}

void ProblemReader::read_model(const YamlValue& value) {
  const YamlSection section = value.section();
  const YamlValue urdf = section.require("urdf");
  const auto srdf = section.find_filled("srdf");
  const YamlValue base = section.require("base_link");
  const auto packages = read_packages(section);
  RobotOptions options{.without = read_without(section)};
  if (const auto limits = root_.find_filled("limits"))
    if (const auto soft = limits->section().find("soft_limits"))
      options.soft_limits = word(*soft, {true, false});
  const UrdfRobot robot = at_their_keys([&] {
    return with_key(urdf, resolve(urdf),
                    [&](const fs::path& file) { return load_urdf(file, packages, options); });
  });
  if (const auto limits = root_.find_filled("limits")) read_robot_limits(*limits, *robot.model);
  if (srdf)
    with_key(*srdf, resolve(*srdf),
             [&](const fs::path& file) { load_srdf({file}, *robot.model, robot.left_out); });
  problem_.model = model_file_ = robot.model;
  problem_.base_link = link_name(base);
  if (const auto hold = section.find_filled("hold")) read_hold(*hold);
}

void ProblemReader::read_robot_limits(const YamlValue& value, RobotModel& robot) const {
  const auto require = [](const YamlValue& place, const std::optional<LimitFault>& fault) {
    if (fault) place.fail(fault->what, fault->allowed);
  };
  const YamlSection section = value.section();
  if (const auto file = section.find_filled("file"))
    with_key(*file, resolve(*file),
             [&](const fs::path& limits) { read_joint_limits(limits, robot); });
  if (const auto joints = section.find_filled("joints"))
    for (const auto& [joint, range] : joints->entries()) {
      const std::vector<double> ends = range.numbers();
      require(range, narrow_range(robot, joint, {ends[0], ends[1]}));
      robot.files.limits[joint] = {ends[0], ends[1]};
    }
  if (const auto margins = section.find("joint_margin"); margins && margins->is_map())
    for (const auto& [joint, margin] : margins->entries()) {
      require(margin, keep_off_limits(robot, joint, margin.number()));
      robot.files.joint_margin[joint] = margin.number();
    }
}

void ProblemReader::read_hand(const YamlValue& value) {
  const YamlSection section = value.section();
  problem_.tip_link = link_name(section.require("tip_link"));
  if (const auto tool = section.find_filled("tool")) problem_.tool = pose(tool->section());
  if (const auto attached = section.find_filled("attached"))
    for (const YamlValue& item : attached->items()) read_attached(item);
  if (problem_.attached.size() > kMostBodies)
    value.fail(std::to_string(problem_.attached.size()) + " attached bodies",
               "at most " + std::to_string(kMostBodies));
}

std::vector<std::string> ProblemReader::read_without(const YamlSection& section) {
  std::vector<std::string> links;
  if (const auto without = section.find_filled("without"))
    for (const YamlValue& link : without->items()) links.push_back(link.text());
  return links;
}

Packages ProblemReader::read_packages(const YamlSection& section) const {
  Packages packages;
  const auto value = section.find_filled("packages");
  if (!value) return packages;
  for (const auto& [name, folder] : value->entries()) {
    std::error_code error;
    const fs::path path = resolve(folder);
    if (!fs::is_directory(path, error))
      folder.fail("no such folder: " + path.string(), "an existing folder");
    packages[name] = path;
  }
  return packages;
}

std::vector<std::string> ProblemReader::joint_names() const {
  std::vector<std::string> names;
  for (const Joint& joint : problem_.model->joints) names.push_back(joint.name);
  return names;
}

void ProblemReader::read_hold(const YamlValue& value) {
  for (const auto& [joint, position] : value.entries()) {
    if (problem_.model->find_joint(joint) < 0)
      position.fail(
          "unknown joint '" + joint + "', nearest is '" + nearest_name(joint, joint_names()) + "'",
          "a joint of " + problem_.model->source);
    problem_.hold[joint] = position.number();
  }
}

void ProblemReader::read_attached(const YamlValue& value) {
  const YamlSection section = value.section();
  AttachedBody body;
  const YamlValue name = section.require("name");
  body.name = name.name();
  if (problem_.model->find_link(body.name) >= 0)
    name.fail("'" + body.name + "' is a link of the robot", "a name of its own");
  if (is_attached(body.name))
    name.fail("'" + body.name + "' is attached twice", "a name of its own");
  body.shape = shape(section);
  body.pose = pose(section);
  const auto link = section.find_filled("link");
  body.link = link ? link_name(*link) : problem_.tip_link;
  problem_.attached.push_back(std::move(body));
}

Shape ProblemReader::shape(const YamlSection& section) {
  const auto [kind, value] = *section.chosen("mesh");
  const auto scale = section.find_filled("scale");
  if (scale && kind != "mesh") scale->fail("scale of a " + kind, "scale with mesh only");
  if (kind == "box") return Box{value.vector3()};
  if (kind == "cylinder") return round_shape<Cylinder>(value);
  if (kind == "capsule") return round_shape<Capsule>(value);
  if (kind == "sphere") return sphere(value);
  const fs::path mesh = resolve(value);
  const Vector3d factors = scale ? mesh_scale(*scale) : Vector3d::Ones();
  return with_key(value, mesh,
                  [&](const fs::path& file) { return load_mesh(file, factors, meshes_); });
}

Vector3d ProblemReader::mesh_scale(const YamlValue& value) {
  const Vector3d factors =
      value.is_sequence() ? value.vector3() : Vector3d::Constant(value.number());
  if ((factors.array() == 0).any()) value.fail("is zero", "a number or [x, y, z], none of them 0");
  return factors;
}

void ProblemReader::read_scene() {
  const auto value = root_.find_filled("scene");
  if (!value) return;
  const std::vector<YamlValue> items = value->items();
  if (items.size() > kMostBodies)
    value->fail(std::to_string(items.size()) + " objects",
                "at most " + std::to_string(kMostBodies));
  for (const YamlValue& item : items) {
    const YamlSection section = item.section();
    const YamlValue name = section.require("name");
    SceneObject object;
    object.name = name.name();
    if (object.name == problem_.base_link)
      name.fail("'" + object.name + "' is the base link", "a name of its own");
    if (is_attached(object.name))
      name.fail("'" + object.name + "' is an attached body", "a name of its own");
    if (is_object(object.name))
      name.fail("'" + object.name + "' is in the scene twice", "a name of its own");
    object.shape = shape(section);
    object.pose = pose(section);
    const auto frame = section.find_filled("frame"), allow = section.find_filled("allow");
    if (frame && frame->text() != problem_.base_link) {
      fix_to_link(*frame, allow, std::move(object));
      continue;
    }
    if (allow) read_allowed(*allow, object);
    problem_.scene.push_back(std::move(object));
  }
}

void ProblemReader::fix_to_link(const YamlValue& frame, const std::optional<YamlValue>& allow,
                                SceneObject object) {
  const std::string link = link_name(frame);
  if (allow)
    allow->fail(
        "is given of a body that is fixed to link '" + link + "'",
        "`allow` of bodies in the frame of `base_link`; the SRDF says which links may touch");
  problem_.attached.push_back({std::move(object.name), std::move(object.shape), object.pose, link});
}

void ProblemReader::read_allowed(const YamlValue& value, SceneObject& object) const {
  const auto add = [&](const YamlValue& where, const Allowed& allowed) {
    if (problem_.model->find_link(allowed.body) < 0 && !is_attached(allowed.body))
      where.fail("unknown body '" + allowed.body + "'",
                 "a link of the robot or the name of an attached body");
    if (const auto fault = depth_fault(problem_, object, allowed))
      where.fail(fault->what, fault->allowed);
    object.allow.push_back(allowed);
  };
  if (value.is_map())
    for (const auto& [body, depth] : value.entries()) add(depth, {body, depth.number()});
  else
    for (const YamlValue& body : value.items()) add(body, {body.text()});
}

void ProblemReader::read_path(const YamlValue& value) {
  const YamlSection section = value.section();
  if (const auto smooth = section.find("smooth")) read_smooth(*smooth);
  if (const auto roll = section.find_filled("roll")) read_roll(*roll);
  path_roll_ = problem_.roll;
  problem_.path_frame = problem_.base_link;
  if (const auto frame = section.find_filled("frame")) {
    problem_.path_frame = frame->text();
    const bool is_other = std::find(more_frames_.begin(), more_frames_.end(),
                                    problem_.path_frame) != more_frames_.end();
    if (problem_.path_frame != problem_.base_link && !is_object(problem_.path_frame) && !is_other)
      frame->fail("unknown frame '" + problem_.path_frame + "'",
                  "'" + problem_.base_link + "' or the name of a scene object in its frame");
  }
  const auto [key, poses] = *section.chosen("waypoints");
  require_keys_beside(section, problem_schema().find("path")->value);
  if (feeds_) feeds_->clear();
  if (key == "file")
    read_path_file(section, poses);
  else
    read_waypoints(poses);
  if (problem_.waypoints.front().roll) narrow_roll(poses);
  if (problem_.roll && problem_.roll->circle()) choose_sides(problem_.waypoints);
}

void ProblemReader::read_path_file(const YamlSection& section, const YamlValue& name) {
  PathFileOptions options;
  if (const auto units = section.find_filled("units"))
    options.units = word(*units, {LengthUnit::kMetre, LengthUnit::kMillimetre, LengthUnit::kInch});
  if (const auto cut = section.find_filled("cut"))
    options.cut = static_cast<std::size_t>(cut->whole_number());
  options.feeds = feeds_.has_value();
  options.turns_freely = problem_.roll && problem_.roll->circle();
  PathFile path = with_key(name, resolve(name), [&](const fs::path& file) {
    return load_path_file(file, options, apt_file_);
  });
  problem_.waypoints = std::move(path.waypoints);
  if (feeds_) *feeds_ = std::move(path.feeds);
  if (path.axis_alone) free_axis(section, name, path.warnings);
  warn(path.warnings);
}

void ProblemReader::free_axis(const YamlSection& section, const YamlValue& name,
                              std::vector<std::string>& warnings) {
  if (problem_.roll && !problem_.roll->circle())
    section.find("roll")->fail(
        "is a range, but the path's file has the tool's axis alone, and says of no turn about it "
        "that it is 0",
        "free, or tangents in the file");
  const bool first = !free_axis_;
  if (first) free_axis_ = name;
  if (problem_.roll) return;
  problem_.roll = path_roll_ = Roll{};
  if (first)
    warnings.push_back(name.where() +
                       ": has the tool's axis alone: the tool may turn about it (`roll: free`)");
}

void ProblemReader::warn(const std::vector<std::string>& warnings) {
  std::vector<std::string>& all = model_file_->warnings;
  for (const std::string& warning : warnings)
    if (std::find(all.begin(), all.end(), warning) == all.end()) all.push_back(warning);
}

void ProblemReader::read_waypoints(const YamlValue& value) {
  for (const YamlValue& item : value.items()) {
    problem_.waypoints.push_back(waypoint(item));
    if (problem_.waypoints.back().roll.has_value() != problem_.waypoints.front().roll.has_value())
      item.fail("roll is given at some waypoints alone", "a roll at each waypoint, or at none");
  }
  if (problem_.waypoints.size() < 2)
    value.fail("has " + std::to_string(problem_.waypoints.size()) + " waypoint(s)",
               "at least two waypoints");
}

void ProblemReader::narrow_roll(const YamlValue& poses) {
  if (!problem_.roll)
    poses.fail("says how far the tool may stand turned, but the roll is not free",
               "path.roll beside it");
  // A window of a whole turn has ends, so that it is no circle.
  constexpr double kHalf = kPi - 1e-6;
  Roll all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t k = 0; k < problem_.waypoints.size(); ++k) {
    Roll& window = *problem_.waypoints[k].roll;
    if (window.circle()) window = {-kHalf, kHalf};
    if (!problem_.roll->circle()) {
      window = {std::max(window.lower, problem_.roll->lower),
                std::min(window.upper, problem_.roll->upper)};
      if (!(window.lower <= window.upper))
        poses.fail("waypoint " + std::to_string(k) + " (from 0) allows no roll that path.roll does",
                   "rolls in common");
    }
    all = {std::min(all.lower, window.lower), std::max(all.upper, window.upper)};
  }
  if (all.circle() || !(all.lower < all.upper))
    poses.fail("allows rolls from " + format_double(all.lower) + " to " + format_double(all.upper) +
                   " in all",
               "more than one, less than a turn");
  problem_.roll = all;
}

void ProblemReader::read_roll(const YamlValue& value) {
  problem_.roll = Roll{};
  if (!value.is_sequence()) {
    constexpr const char* kAllowed = "free, or [lower, upper] in rad";
    if (value.is_map()) value.fail("is a map", kAllowed);
    if (value.text() != "free") value.fail("is '" + value.text() + "'", kAllowed);
    return;
  }
  const std::vector<double> ends = value.numbers();
  problem_.roll = Roll{ends[0], ends[1]};
  if (!(ends[0] < ends[1])) value.fail("is empty", "[lower, upper] with lower < upper");
  require_radians(value, {ends[0], ends[1]});
}

void ProblemReader::read_smooth(const YamlValue& value) {
  problem_.smooth = value.is_null() ? PathSmoothing{0, 0} : PathSmoothing{};
  if (value.is_null()) return;
  const YamlSection section = value.section();
  set(section, "position", problem_.smooth->position);
  set(section, "angle", problem_.smooth->angle);
}

void ProblemReader::read_refine(const YamlValue& value) {
  const YamlSection section = value.section();
  set(section, "smoothing", problem_.refinement.smoothing);
  set(section, "joint_margin", problem_.refinement.joint_margin);
  set(section, "singular_margin", problem_.refinement.singular_margin);
}

void ProblemReader::read_resolution(const YamlValue& value) {
  const YamlSection section = value.section();
  Resolution& resolution = problem_.resolution;
  set(section, "ds", resolution.ds);
  set(section, "dphi", resolution.dphi);
  set(section, "dalpha", resolution.dalpha);
  set(section, "arc", resolution.arc);
  set(section, "droll", resolution.droll);
  set(section, "knot", resolution.knot);
  if (const auto arcs = section.find("arcs")) resolution.arcs = word(*arcs, {false, true});
}

void ProblemReader::read_limits(const YamlValue& value) {
  const YamlSection section = value.section();
  Limits& limits = problem_.limits;
  set(section, "clearance", limits.clearance);
  set(section, "self_clearance", limits.self_clearance);
  set(section, "manipulability", limits.manipulability);
  if (const auto margin = section.find("joint_margin"); margin && !margin->is_map()) {
    const auto of_file = root_.find_filled("limits");
    const auto by_name = of_file ? of_file->section().find("joint_margin") : std::nullopt;
    if (by_name && by_name->is_map())
      margin->fail("is given, and the `limits` of the file have one for each joint",
                   "joint_margin in one of the two");
    limits.joint_margin = margin->number();
  }
  set(section, "joint_step", limits.joint_step);
  set(section, "arm_slope", limits.arm_slope);
  set(section, "roll_slope", limits.roll_slope);
  set(section, "step_error", limits.step_error);
  set(section, "tool_path_error", limits.tool_path_error);
  set(section, "tool_angle_error", limits.tool_angle_error);
  set(section, "tool_speed", limits.tool_speed);
  set(section, "tool_turn_speed", limits.tool_turn_speed);
  set(section, "edge_clearance", limits.edge_clearance);
  set(section, "edge_tolerance", limits.edge_tolerance);
  set(section, "joint_speed", limits.joint_speed);
  set(section, "joint_acceleration", limits.joint_acceleration);
  set(section, "joint_jerk", limits.joint_jerk);
  if (const auto edges = section.find("edges"))
    limits.edges = word(*edges, {EdgeMode::kContinuous, EdgeMode::kNodes});
}

std::vector<double> ProblemReader::joint_numbers(const YamlValue& value) const {
  const Chain chain = suitable_arm().chain;
  if (!value.is_sequence() || (!chain.roll && value.items().size() != kDof - 1))
    return value.numbers();
  const std::string by_arm =
      more_joints_.empty() ? "" : "; where two arms differ, weights by joint, rates by arm";
  if (value.items().size() != chain.coordinates())
    value.fail("has " + std::to_string(value.items().size()) + " entries",
               (chain.roll_fixed ? "a list of 6 numbers, one for each joint, base to tip: without "
                                   "path.roll the tool does not turn"
                : chain.roll ? "a list of 7 numbers: one for each of the six joints, base to tip, "
                               "and a seventh for the roll of the tool"
                             : "a list of 7 numbers, one for each joint, base to tip") +
                   by_arm);
  std::vector<double> numbers;
  for (const YamlValue& item : value.items()) numbers.push_back(item.number());
  numbers.resize(kDof, 0);
  return numbers;
}

ArmModel ProblemReader::arm() const {
  return build_arm(*problem_.model, problem_.base_link, problem_.tip_link, problem_.hold,
                   problem_.tool, problem_.roll);
}

ArmModel ProblemReader::suitable_arm() const {
  return at_their_keys([&] { return arm(); });
}

void ProblemReader::require_in_scale(const ArmModel& model, const YamlValue& path,
                                     const std::vector<YamlValue>& limits) const {
  for (const LargeLength& found : large_lengths(model.chain, problem_)) {
    std::optional<YamlValue> value;
    if (found.section == "path.smooth") {
      if (const auto smooth = path.section().find_filled("smooth"))
        value = smooth->section().find(found.key);
    } else {
      for (const YamlValue& section : limits)
        if (const auto given = section.section().find(found.key)) value = given;
    }
    if (value) value->fail(found.fault, formatted("at most %.3g", found.most));
  }
}

std::vector<UnusedKey> ProblemReader::unused_keys_of(const ArmModel& model) const {
  return unused_keys(model.chain, classify(model.chain, problem_.model->source));
}

void ProblemReader::require_used(const std::vector<UnusedKey>& unused, const YamlValue& value,
                                 const std::string& section) {
  for (const UnusedKey& key : unused)
    if (key.section == section)
      if (const auto given = value.section().find_filled(key.key))
        given->fail("is given, but " + key.why, "no such key for this arm");
}

void ProblemReader::require_used(const std::vector<UnusedKey>& unused) const {
  for (const char* const section : {"resolution", "limits"})
    if (const auto value = root_.find_filled(section)) require_used(unused, *value, section);
}

void ProblemReader::read_start(const YamlValue& value) {
  const YamlValue joints = value.section().require("joints");
  problem_.start = Config::of(joint_numbers(joints).data());
}

void ProblemReader::read_start_place() {
  const auto at = root_.find_filled("start_at"), tolerance = root_.find_filled("start_tolerance");
  for (const auto& value : {at, tolerance})
    if (value && !problem_.start) value->fail("is given without start", "this key beside start");
  if (at) problem_.start_at = at->number();
  if (!tolerance) return;
  problem_.start_tolerance = tolerance->number();
  if (problem_.start_tolerance > kMostStartTolerance)
    tolerance->fail("is more than 0.1", "a number > 0, at most 0.1");
}

Config ProblemReader::without_roll(const YamlValue& joints) {
  Config q = Config::Zero();
  for (std::size_t k = 0; k + 1 < kDof; ++k)
    q[static_cast<Eigen::Index>(k)] = joints.items()[k].number();
  return q;
}

void ProblemReader::read_end(const YamlValue& path, const Chain& chain) {
  const auto end = path.section().find_filled("end");
  if (!end) return;
  const YamlValue joints = end->section().require("joints");
  problem_.end =
      leaves_out_roll(joints, chain)
          ? with_roll_onto(given_waypoints_in_base(problem_).back(), chain, without_roll(joints))
          : Config::of(joint_numbers(joints).data());
}

void ProblemReader::read_closed(const YamlValue& path, const Chain& chain) {
  const auto closed = path.section().find_filled("closed");
  if (!closed || !closed->boolean()) return;
  if (chain.free_roll)
    closed->fail(
        "is given for an arm of seven joints whose roll is free, which is not supported yet",
        "this key or path.roll");
  if ((problem_.start || problem_.end) && problem_.start != problem_.end)
    closed->fail("is given beside `start` or `end`", "neither, or both with the same joints");
  if (problem_.start_at) closed->fail("is given beside `start_at`", "one of the two");
  problem_.closed = true;
  try {
    static_cast<void>(waypoints_in_base(problem_));
  } catch (const InputError& error) {
    problem_.closed = false;
    static_cast<void>(waypoints_in_base(problem_));  // or the error is another one
    const Waypoint &first = problem_.waypoints.front(), &last = problem_.waypoints.back();
    if (first.roll != last.roll)
      closed->fail("is true, but the last waypoint allows other rolls than the first",
                   "one range at both");
    closed->fail(
        formatted("is true, but the last waypoint is %.3g m and %.3g rad from the first",
                  (last.position - first.position).norm(),
                  last.orientation.normalized().angularDistance(first.orientation.normalized())),
        "at most 1e-6 m and 1e-6 rad");
  }
}

void ProblemReader::refuse_closed(const YamlValue& path, const std::string& what) {
  if (const auto closed = path.section().find_filled("closed"); closed && closed->boolean())
    closed->fail("is not supported yet for " + what, "no such key here");
}

void ProblemReader::read_cost() {
  const auto value = root_.find_filled("cost");
  if (!value) return;
  const YamlSection section = value->section();
  if (const auto metric = section.find("metric"))
    problem_.cost.metric =
        word(*metric, {CostMetric::kL2, CostMetric::kL1, CostMetric::kMax, CostMetric::kTime});
  if (const auto weights = section.find_filled("weights")) read_weights(*weights);
  if (const auto roll = section.find("roll")) {
    problem_.cost.roll = roll->number();
    if (!weight_allowed(problem_.cost.roll))
      roll->fail("is " + format_double(problem_.cost.roll), kAllowedWeights);
    if (problem_.cost.roll > 0 && !problem_.roll)
      roll->fail("is given, but no roll is free",
                 "this key beside path.roll, of arms of six joints");
  }
}

void ProblemReader::read_weights(const YamlValue& value) {
  const auto allowed = [](const YamlValue& place, double weight) {
    if (!weight_allowed(weight)) place.fail("is " + format_double(weight), kAllowedWeights);
    return weight;
  };
  if (!value.is_map()) {
    const std::vector<double> numbers = joint_numbers(value);
    std::array<double, kDof>& weights = problem_.cost.weights.emplace();
    std::copy(numbers.begin(), numbers.end(), weights.begin());
    for (std::size_t k = 0; k < value.items().size(); ++k)
      static_cast<void>(allowed(value.items()[k], numbers[k]));
    return;
  }
  const Chain chain = arm().chain;
  const auto& names = chain.joint_names;
  std::array<double, kDof> weights = joint_weights(Cost(), chain);
  const auto end = names.begin() + static_cast<std::ptrdiff_t>(named_joints(names));
  for (const auto& [joint, weight] : value.entries()) {
    const auto at = std::find(names.begin(), end, joint);
    if (at == end &&
        std::find(more_joints_.begin(), more_joints_.end(), joint) != more_joints_.end())
      continue;
    if (at == end)
      weight.fail("'" + joint + "' is no joint of the arm, nearest is '" +
                      nearest_name(joint, {names.begin(), end}) + "'",
                  "a joint of the arm");
    weights[static_cast<std::size_t>(at - names.begin())] = allowed(weight, weight.number());
  }
  problem_.cost.weights = weights;
}

void ProblemReader::read_vary() {
  const auto value = root_.find_filled("vary");
  if (!value) return;
  for (const YamlValue& item : value->items()) {
    const YamlSection section = item.section();
    const YamlValue object = section.require("object");
    if (!is_object(object.text()))
      object.fail("unknown object '" + object.text() + "'",
                  "the name of a scene object in the frame of `base_link`");
    const auto rpy = section.find_filled("rpy");
    problem_.vary.push_back({object.text(), vector3_or_zero(section, "xyz"),
                             rpy ? rpy_of(*rpy) : Vector3d(Vector3d::Zero())});
  }
}

void ProblemReader::set(const YamlSection& section, const char* key, double& target) {
  if (const auto value = section.find(key)) target = value->number();
}

void ProblemReader::set(const YamlSection& section, const char* key,
                        std::optional<double>& target) {
  if (const auto value = section.find(key))
    target = value->is_null() ? std::nullopt : std::optional(value->number());
}

void ProblemReader::set(const YamlSection& section, const char* key,
                        std::optional<std::array<double, kDof>>& target) const {
  const auto value = section.find(key);
  if (!value) return;
  target.reset();
  if (value->is_null()) return;
  target.emplace();
  if (!value->is_sequence()) return target->fill(value->number());
  const std::vector<double> values = joint_numbers(*value);
  std::copy(values.begin(), values.end(), target->begin());
  if (value->items().size() < kDof) target->back() = target->at(kDof - 2);  // of no joint
}

}  // namespace swivel::io
