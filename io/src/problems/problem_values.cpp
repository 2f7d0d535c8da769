// SPDX-License-Identifier: BSD-3-Clause
#include "problems/problem_values.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <type_traits>
#include <variant>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "schema/schema.hpp"
#include "schema/yaml_edit.hpp"
#include "swivel/core/base/rpy.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/study/placement.hpp"

namespace swivel::io {

namespace fs = std::filesystem;

namespace {

YAML::Node text_node(const std::string& text) {
  return YAML::Node(text);
}
YAML::Node number_node(double value) {
  return text_node(csv_number(value));
}
YAML::Node number_node(const std::optional<double>& value) {
  return value ? number_node(*value) : YAML::Node(YAML::NodeType::Null);
}
YAML::Node word_node(bool value) {
  return text_node(value ? "true" : "false");
}
template <class Numbers>
YAML::Node numbers_node(const Numbers& numbers) {
  YAML::Node list(YAML::NodeType::Sequence);
  for (const double number : numbers) list.push_back(number_node(number));
  return list;
}
YAML::Node vector_node(const Vector3d& v) {
  return numbers_node(std::array{v.x(), v.y(), v.z()});
}
YAML::Node joints_node(const Config& joints, std::size_t count) {
  YAML::Node section;
  section["joints"] = numbers_node(std::vector<double>(joints.data(), joints.data() + count));
  return section;
}
/// Returns a limit of the first `count` joints: one number where it is the same for all, else a
/// list; null where the problem does not give it.
YAML::Node of_joints_node(const std::optional<std::array<double, kDof>>& numbers,
                          std::size_t count) {
  if (!numbers) return YAML::Node(YAML::NodeType::Null);
  const bool same = std::all_of(numbers->begin(), numbers->end(),
                                [&](double number) { return number == numbers->front(); });
  return same ? number_node(numbers->front()) : numbers_node(std::span(*numbers).first(count));
}
template <class Value, class Node>
YAML::Node map_node(const std::map<std::string, Value>& values, const Node& node) {
  YAML::Node map;
  for (const auto& [name, value] : values) map[name] = node(value);
  return map;
}

/// Adds a rotation to a pose unless it is none: by angles where these give it bit for bit, else by
/// a quaternion, which gives it to a rounding error.
void add_rotation(YAML::Node& pose, const Matrix3d& rotation) {
  if (rotation == Matrix3d::Identity()) return;
  const Matrix3d& r = rotation;
  const Vector3d exact(std::atan2(r(2, 1), r(2, 2)),
                       std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0))),
                       std::atan2(r(1, 0), r(0, 0)));
  for (const Vector3d& rpy : {written_rpy(rotation), exact})
    if (rotation_from_rpy(rpy) == rotation) {
      pose["rpy"] = vector_node(rpy);
      return;
    }
  const Quaterniond q(rotation);
  pose["quat"] = numbers_node(std::array{q.w(), q.x(), q.y(), q.z()});
}
void add_pose(YAML::Node& section, const Pose& pose) {
  if (pose.translation() != Vector3d::Zero()) section["xyz"] = vector_node(pose.translation());
  add_rotation(section, pose.linear());
}

/// Makes the values of one problem.
class ProblemValues {
 public:
  ProblemValues(const PathProblem& problem, const fs::path& folder,
                const std::vector<std::string>& scene_names, const std::string& file)
      : problem_(problem),
        folder_(folder),
        scene_names_(scene_names),
        file_(file),
        joints_(coordinates_of(problem)) {}

  YAML::Node all() {
    YAML::Node root;
    root["robot"] = robot();
    root["path"] = path();
    if (YAML::Node bodies = scene(); bodies.size() > 0) root["scene"] = bodies;
    root["resolution"] = resolution();
    root["limits"] = limits();
    add_start(root);
    root["cost"] = cost();
    root["refine"] = refine();
    if (!problem_.vary.empty()) root["vary"] = vary();
    return root;
  }

 private:
  [[noreturn]] void refuse(const std::string& what, const std::string& allowed) const {
    bad_input(file_, what, allowed);
  }
  [[nodiscard]] YAML::Node file_node(const std::string& name) const {
    return text_node(name_seen_from(folder_, name));
  }
  [[nodiscard]] bool is_in_scene(const std::string& body) const {
    return std::find(scene_names_.begin(), scene_names_.end(), body) != scene_names_.end();
  }

  [[nodiscard]] YAML::Node robot() const {
    const ModelFiles& files = problem_.model->files;
    if (files.urdf.empty())
      refuse("robot.urdf: the robot was made of a text, or by hand",
             "a robot that was loaded from a URDF file");
    YAML::Node section;
    section["urdf"] = file_node(files.urdf);
    if (!files.srdf.empty()) section["srdf"] = file_node(files.srdf);
    if (!files.packages.empty())
      section["packages"] =
          map_node(files.packages, [&](const std::string& name) { return file_node(name); });
    for (const std::string& link : files.without) section["without"].push_back(text_node(link));
    section["base_link"] = problem_.base_link;
    section["tip_link"] = problem_.tip_link;
    YAML::Node tool(YAML::NodeType::Map);
    add_pose(tool, problem_.tool);
    if (tool.size() > 0) section["tool"] = tool;
    if (!problem_.hold.empty())
      section["hold"] = map_node(problem_.hold, [](double at) { return number_node(at); });
    for (const AttachedBody& body : problem_.attached)
      if (!is_in_scene(body.name)) section["attached"].push_back(attached(body, "link"));
    return section;
  }

  /// Returns a body on a link, whose name stands at `key`.
  [[nodiscard]] YAML::Node attached(const AttachedBody& body, const char* key) const {
    YAML::Node section;
    section["name"] = body.name;
    add_shape(section, body.name, body.shape);
    add_pose(section, body.pose);
    section[key] = body.link;
    return section;
  }

  void add_shape(YAML::Node& section, const std::string& name, const Shape& shape) const {
    const auto round = [](double radius, double length) {
      YAML::Node map;
      map["radius"] = number_node(radius);
      map["length"] = number_node(length);
      return map;
    };
    std::visit(
        [&](const auto& one) {
          using Kind = std::decay_t<decltype(one)>;
          if constexpr (std::is_same_v<Kind, Box>)
            section["box"] = vector_node(one.size);
          else if constexpr (std::is_same_v<Kind, Cylinder>)
            section["cylinder"] = round(one.radius, one.length);
          else if constexpr (std::is_same_v<Kind, Capsule>)
            section["capsule"] = round(one.radius, one.length);
          else if constexpr (std::is_same_v<Kind, Sphere>)
            section["sphere"] = number_node(one.radius);
          else
            add_mesh(section, name, *one);
        },
        shape);
  }
  void add_mesh(YAML::Node& section, const std::string& name, const TriangleMesh& mesh) const {
    std::error_code error;
    if (!fs::is_regular_file(mesh.source, error))
      refuse("mesh of '" + name + "': '" + mesh.source + "' is no file",
             "a mesh that was loaded from a file, and the folder from which it was loaded");
    section["mesh"] = file_node(mesh.source);
    if (mesh.scale == Vector3d::Ones()) return;
    section["scale"] = mesh.scale == Vector3d::Constant(mesh.scale.x())
                           ? number_node(mesh.scale.x())
                           : vector_node(mesh.scale);
  }

  [[nodiscard]] YAML::Node path() const {
    YAML::Node section;
    section["frame"] = problem_.path_frame.empty() ? problem_.base_link : problem_.path_frame;
    for (const Waypoint& waypoint : problem_.waypoints) {
      YAML::Node pose;
      const Quaterniond& q = waypoint.orientation;
      pose["xyz"] = vector_node(waypoint.position);
      pose["quat"] = numbers_node(std::array{q.w(), q.x(), q.y(), q.z()});
      if (waypoint.roll)
        pose["roll"] = numbers_node(std::array{waypoint.roll->lower, waypoint.roll->upper});
      section["waypoints"].push_back(pose);
    }
    if (const auto& smooth = problem_.smooth) {
      section["smooth"]["position"] = number_node(smooth->position);
      section["smooth"]["angle"] = number_node(smooth->angle);
    }
    if (const auto& roll = problem_.roll)
      section["roll"] =
          *roll == Roll() ? text_node("free") : numbers_node(std::array{roll->lower, roll->upper});
    if (problem_.end) section["end"] = joints_node(*problem_.end, joints_);
    section["closed"] = word_node(problem_.closed);
    return section;
  }

  /// Returns the scene: its objects, and among them the bodies on links that a file has there, each
  /// behind the one that it follows in the file.
  [[nodiscard]] YAML::Node scene() const {
    std::map<std::string, YAML::Node> bodies;
    std::vector<std::string> names;
    for (const SceneObject& object : problem_.scene) {
      bodies.emplace(object.name, scene_object(object));
      names.push_back(object.name);
    }
    for (const AttachedBody& body : problem_.attached) {
      const auto at = std::find(scene_names_.begin(), scene_names_.end(), body.name);
      if (at == scene_names_.end()) continue;
      auto before = names.end();
      for (auto k = at; k != scene_names_.begin() && before == names.end();)
        before = std::find(names.begin(), names.end(), *--k);
      names.insert(before == names.end() ? names.begin() : before + 1, body.name);
      bodies.emplace(body.name, attached(body, "frame"));
    }
    YAML::Node list(YAML::NodeType::Sequence);
    for (const std::string& name : names) list.push_back(bodies.at(name));
    return list;
  }
  [[nodiscard]] YAML::Node scene_object(const SceneObject& object) const {
    YAML::Node section;
    section["name"] = object.name;
    add_shape(section, object.name, object.shape);
    add_pose(section, object.pose);
    const auto bounded = std::count_if(object.allow.begin(), object.allow.end(),
                                       [](const Allowed& one) { return one.depth.has_value(); });
    if (bounded != 0 && bounded != static_cast<std::ptrdiff_t>(object.allow.size()))
      refuse("allow of '" + object.name + "': some bodies have a depth, others have none",
             "a depth of each, or of none");
    for (const Allowed& one : object.allow) {
      if (one.depth)
        section["allow"][one.body] = number_node(*one.depth);
      else
        section["allow"].push_back(text_node(one.body));
    }
    return section;
  }

  [[nodiscard]] YAML::Node resolution() const {
    const Resolution& r = problem_.resolution;
    YAML::Node section;
    section["ds"] = number_node(r.ds);
    section["dphi"] = number_node(r.dphi);
    section["dalpha"] = number_node(r.dalpha);
    section["arcs"] = word_node(r.arcs);
    section["arc"] = number_node(r.arc);
    section["droll"] = number_node(r.droll);
    section["knot"] = number_node(r.knot);
    return section;
  }

  [[nodiscard]] YAML::Node limits() const {
    const Limits& l = problem_.limits;
    YAML::Node section;
    section["clearance"] = number_node(l.clearance);
    section["self_clearance"] = number_node(l.self_clearance);
    section["edges"] = l.edges == EdgeMode::kContinuous ? "continuous" : "nodes";
    section["edge_clearance"] = number_node(l.edge_clearance);
    section["edge_tolerance"] = number_node(l.edge_tolerance);
    add_limits_of_robot(section);
    section["joint_step"] = number_node(l.joint_step);
    section["arm_slope"] = number_node(l.arm_slope);
    section["roll_slope"] = number_node(l.roll_slope);
    section["manipulability"] = number_node(l.manipulability);
    section["tool_path_error"] = number_node(l.tool_path_error);
    section["tool_angle_error"] = number_node(l.tool_angle_error);
    section["step_error"] = number_node(l.step_error);
    section["tool_speed"] = number_node(l.tool_speed);
    section["tool_turn_speed"] = number_node(l.tool_turn_speed);
    section["joint_speed"] = of_joints_node(l.joint_speed, joints_);
    section["joint_acceleration"] = of_joints_node(l.joint_acceleration, joints_);
    section["joint_jerk"] = of_joints_node(l.joint_jerk, joints_);
    return section;
  }
  void add_limits_of_robot(YAML::Node& section) const {
    const ModelFiles& files = problem_.model->files;
    if (files.joint_margin.empty())
      section["joint_margin"] = number_node(problem_.limits.joint_margin);
    else if (problem_.limits.joint_margin == 0)
      section["joint_margin"] =
          map_node(files.joint_margin, [](double margin) { return number_node(margin); });
    else
      refuse("limits.joint_margin is given for all joints, and the robot has one for some of them",
             "one of the two");
    if (!files.limits.empty())
      section["joints"] = map_node(files.limits, [](const Joint::Range& range) {
        return numbers_node(std::array{range.lower, range.upper});
      });
    if (!files.joint_limits.empty()) section["file"] = file_node(files.joint_limits);
    section["soft_limits"] = word_node(files.soft_limits);
  }

  void add_start(YAML::Node& root) const {
    if (!problem_.start) return;
    root["start"] = joints_node(*problem_.start, joints_);
    if (problem_.start_at) root["start_at"] = number_node(*problem_.start_at);
    if (problem_.start_tolerance != Task().start_tolerance)
      root["start_tolerance"] = number_node(problem_.start_tolerance);
  }

  [[nodiscard]] YAML::Node cost() const {
    const Cost& cost = problem_.cost;
    YAML::Node section;
    section["metric"] = cost.metric == CostMetric::kL2    ? "l2"
                        : cost.metric == CostMetric::kL1  ? "l1"
                        : cost.metric == CostMetric::kMax ? "max"
                                                          : "time";
    if (cost.weights) section["weights"] = numbers_node(std::span(*cost.weights).first(joints_));
    section["roll"] = number_node(cost.roll);
    return section;
  }
  [[nodiscard]] YAML::Node refine() const {
    YAML::Node section;
    section["smoothing"] = number_node(problem_.refinement.smoothing);
    section["joint_margin"] = number_node(problem_.refinement.joint_margin);
    section["singular_margin"] = number_node(problem_.refinement.singular_margin);
    return section;
  }
  [[nodiscard]] YAML::Node vary() const {
    YAML::Node list;
    for (const Variation& variation : problem_.vary) {
      YAML::Node section;
      section["object"] = variation.object;
      section["xyz"] = vector_node(variation.xyz);
      section["rpy"] = vector_node(variation.rpy);
      list.push_back(section);
    }
    return list;
  }

  const PathProblem& problem_;
  const fs::path& folder_;
  const std::vector<std::string>& scene_names_;
  const std::string& file_;
  std::size_t joints_;  // coordinates of the arm
};

}  // namespace

fs::path canonical_folder(const fs::path& folder) {
  return fs::weakly_canonical(folder.empty() ? fs::current_path() : fs::absolute(folder));
}

std::string name_seen_from(const fs::path& folder, const fs::path& name) {
  // Links are followed, so that ".." means what it means to the system; a file keeps its own name.
  const fs::path full = fs::absolute(name).lexically_normal();
  const fs::path file = fs::weakly_canonical(full.parent_path()) / full.filename(),
                 from = canonical_folder(folder);
  const auto top = [](const fs::path& path) { return *std::next(path.begin()); };
  if (from.begin() == from.end() || std::next(from.begin()) == from.end() || top(file) != top(from))
    return file.string();
  return file.lexically_relative(from).string();
}

std::size_t coordinates_of(const Robot& robot) {
  if (robot.roll) return kDof;
  try {
    return build_arm(*robot.model, robot.base_link, robot.tip_link, robot.hold, robot.tool)
        .chain.coordinates();
  } catch (const InputError&) {
    return kDof;
  }
}

YAML::Node problem_values(const PathProblem& problem, const fs::path& folder,
                          const std::vector<std::string>& scene_names, const std::string& file) {
  return ProblemValues(problem, folder, scene_names, file).all();
}

namespace {

/// Returns the entries of a section that are none of `defaults`.
YAML::Node entries_beyond(const YAML::Node& section, const YAML::Node& defaults) {
  YAML::Node kept(YAML::NodeType::Map);
  for (const auto& entry : section) {
    const std::string key = entry.first.Scalar();
    const YAML::Node given = defaults[key];
    if (!given.IsDefined() || !same_values(given, entry.second)) kept[key] = entry.second;
  }
  return kept;
}

/// Returns the strokes of a job without what holds where they do not state it.
YAML::Node strokes_beyond(const YAML::Node& strokes, const YAML::Node& of_path) {
  YAML::Node of_stroke, kept;
  of_stroke["reversible"] = "false";
  for (const YAML::Node& stroke : strokes) {
    YAML::Node one = entries_beyond(stroke, of_stroke);
    one["path"] = entries_beyond(stroke["path"], of_path);
    kept.push_back(one);
  }
  return kept;
}

}  // namespace

YAML::Node without_defaults(const YAML::Node& values, const Robot& robot) {
  PathProblem plain;
  static_cast<Robot&>(plain) = robot;
  plain.roll.reset();
  plain.start = Config::Zero();
  auto model = std::make_shared<RobotModel>();
  model->files.urdf = robot.model->files.urdf;
  plain.model = model;
  YAML::Node defaults = problem_values(plain, ".", {}, "");
  for (const auto& [key, value] : {std::pair("order", "given"), std::pair("rapid", "1"),
                                   std::pair("approach", "0"), std::pair("retract", "0")})
    defaults[key] = value;
  const YAML::Node& all = defaults;
  YAML::Node kept;
  for (const auto& section : values) {
    const std::string name = section.first.Scalar();
    const YAML::Node of = all[name];
    if (name == "strokes") {
      kept[name] = strokes_beyond(section.second, all["path"]);
    } else if (name == "robot" || name == "start" || !of.IsDefined()) {
      kept[name] = section.second;
    } else if (section.second.IsMap() && of.IsMap()) {
      if (const YAML::Node rest = entries_beyond(section.second, of); rest.size() > 0)
        kept[name] = rest;
    } else if (!same_values(section.second, of)) {
      kept[name] = section.second;
    }
  }
  return kept;
}

}  // namespace swivel::io
