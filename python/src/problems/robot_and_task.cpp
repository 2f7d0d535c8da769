// SPDX-License-Identifier: BSD-3-Clause
// Bindings of robot, scene and task.
#include <algorithm>
#include <optional>
#include <variant>

#include "base/archive.hpp"
#include "base/bindings.hpp"
#include "base/interruptible.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/kinematics/srs/arm_guess.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/path_range.hpp"
#include "swivel/planner/robot/planning_arm.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel::python {

namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Packages = std::map<std::string, std::filesystem::path>;
using Ranges = std::map<std::string, std::array<double, 2>>;  // by joint: lower and upper, rad or m
using Scene = std::vector<SceneObject>;

Array to_array(py::handle source, const char* allowed) {
  Array array = Array::ensure(source);
  if (!array) {
    PyErr_Clear();
    throw py::value_error(std::string("not an array of numbers: allowed are ") + allowed);
  }
  return array;
}

std::string shape_text(const Array& array) {
  return py::str(array.attr("shape")).cast<std::string>();
}

using PythonShape = std::variant<Sphere, Box, Cylinder, Capsule, Mesh>;

Shape to_shape(const PythonShape& shape) {
  return std::visit(
      [](const auto& one) -> Shape {
        if constexpr (std::is_same_v<std::decay_t<decltype(one)>, Mesh>)
          return one.mesh;
        else
          return one;
      },
      shape);
}
PythonShape from_shape(const Shape& shape) {
  return std::visit(
      [](const auto& one) -> PythonShape {
        if constexpr (std::is_same_v<std::decay_t<decltype(one)>, MeshPtr>)
          return Mesh{one};
        else
          return one;
      },
      shape);
}

Mesh mesh_of_arrays(const ArrayLike& vertices, const ArrayLike& triangles,
                    const std::string& name) {
  const Array points = to_array(vertices, "vertices of shape (n, 3), m");
  const auto corners =
      py::array_t<int, py::array::c_style | py::array::forcecast>::ensure(triangles);
  if (!corners) throw py::error_already_set();
  if (points.ndim() != 2 || points.shape(1) != 3 || corners.ndim() != 2 || corners.shape(1) != 3)
    throw py::value_error(
        "Mesh: vertices of shape " + shape_text(points) + " and triangles of shape " +
        py::str(corners.attr("shape")).cast<std::string>() + ": allowed are (n, 3) and (m, 3)");
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->source = name;
  for (py::ssize_t k = 0; k < points.shape(0); ++k)
    mesh->vertices.emplace_back(points.at(k, 0), points.at(k, 1), points.at(k, 2));
  for (py::ssize_t k = 0; k < corners.shape(0); ++k) {
    std::array<int, 3> triangle{corners.at(k, 0), corners.at(k, 1), corners.at(k, 2)};
    for (const int corner : triangle)
      if (corner < 0 || corner >= points.shape(0))
        throw py::value_error("Mesh: triangle " + std::to_string(k) + " names vertex " +
                              std::to_string(corner) + ": allowed are 0 to " +
                              std::to_string(points.shape(0) - 1));
    mesh->triangles.push_back(triangle);
  }
  mesh->closed = is_closed(*mesh);
  return {std::move(mesh)};
}

Vector3d to_scale(py::handle scale) {
  const Array values = to_array(scale, "a scale, or one for each axis");
  if (values.size() == 1) return Vector3d::Constant(values.data()[0]);
  if (values.size() != 3)
    throw py::value_error("Mesh: scale of shape " + shape_text(values) +
                          ": allowed are a number or 3");
  return {values.data()[0], values.data()[1], values.data()[2]};
}

std::string shape_words(const Shape& shape) {
  return py::repr(py::cast(from_shape(shape))).cast<std::string>();
}

std::string number(double value) {
  return py::repr(py::float_(value)).cast<std::string>();
}

/// Returns axes whose z points along `axis`, of any length above 1e-6: those of the smallest turn
/// from the frame's own, for an axis that points down from these turned by 180 deg about x, so that
/// axes near straight up and straight down vary smoothly; or, with a tangent, those whose x is the
/// part of the tangent perpendicular to z. Throws ValueError for vectors without a direction, and a
/// tangent along the axis.
Matrix3d axes_along(const Vector3d& axis, const std::optional<Vector3d>& tangent) {
  if (!(axis.norm() > 1e-6) || !axis.allFinite())
    throw py::value_error("pose: axis of length 0, or not finite: allowed is any other");
  const Vector3d z = axis.normalized();
  if (!tangent) {
    const Vector3d from(1, z.z() < 0 ? -1 : 1, z.z() < 0 ? -1 : 1);  // diagonal of the frame before
    const Vector3d up = Vector3d::UnitZ() * from.z();
    return Quaterniond::FromTwoVectors(up, z).toRotationMatrix() * from.asDiagonal();
  }
  const Vector3d x = *tangent - tangent->dot(z) * z;
  if (!(x.norm() > 1e-3 * tangent->norm()) || !(tangent->norm() > 1e-6) || !tangent->allFinite())
    throw py::value_error("pose: tangent of length 0, or along the axis: allowed is any other");
  Matrix3d axes;
  axes << x.normalized(), z.cross(x.normalized()), z;
  return axes;
}

/// Returns a pose from a position, m, and rpy, rad, a quaternion [w x y z], or the direction of its
/// z axis.
Pose make_pose(const Vector3d& xyz, const std::optional<Vector3d>& rpy,
               const std::optional<Eigen::Vector4d>& quat, const std::optional<Vector3d>& axis,
               const std::optional<Vector3d>& tangent) {
  if (rpy.has_value() + quat.has_value() + axis.has_value() > 1)
    throw py::value_error("pose: more than one of rpy, quat and axis: allowed is one of them");
  if (tangent && !axis) throw py::value_error("pose: tangent: allowed is a tangent beside axis");
  Pose pose = Pose::Identity();
  if (axis) pose.linear() = axes_along(*axis, tangent);
  pose.translation() = xyz;
  if (rpy)
    pose.linear() = (Eigen::AngleAxisd((*rpy)[2], Vector3d::UnitZ()) *
                     Eigen::AngleAxisd((*rpy)[1], Vector3d::UnitY()) *
                     Eigen::AngleAxisd((*rpy)[0], Vector3d::UnitX()))
                        .toRotationMatrix();
  if (quat) {
    if (!(quat->norm() > 0) || !quat->allFinite())
      throw py::value_error("pose: quat of length 0, or not finite: allowed is any other");
    pose.linear() =
        Quaterniond((*quat)[0], (*quat)[1], (*quat)[2], (*quat)[3]).normalized().toRotationMatrix();
  }
  return pose;
}

// --- robot

void choose_links(Robot& robot, const std::optional<std::string>& base,
                  const std::optional<std::string>& tip, bool roll) {
  const RobotModel& model = *robot.model;
  robot.base_link = base.value_or(model.links[static_cast<std::size_t>(model.root_link)].name);
  if (tip) {
    robot.tip_link = *tip;
    return;
  }
  const std::vector<ArmGuess> arms = guess_arms(model).arms;
  // Chooses an arm of six joints if the tool may turn, else one of seven. An arm of six without a
  // roll is refused later with a message that says what to add.
  const auto fits = [&](const ArmGuess& arm) { return (arm.joints == 6) == roll; };
  const auto found = std::find_if(arms.begin(), arms.end(), fits);
  if (arms.empty() || (roll && found == arms.end()))
    throw InputError(model.source,
                     std::string("no arm of ") + (roll ? "six" : "seven or six") +
                         " joints in a row was found: allowed is one, or base and tip by name");
  const ArmGuess& arm = found == arms.end() ? arms.front() : *found;
  robot.tip_link = arm.tip;
  if (!base) robot.base_link = arm.base;
}

struct RobotKeywords {
  std::optional<std::string> base, tip;
  std::optional<Pose> tool;
  std::map<std::string, double> hold;
  std::optional<Roll> roll;
};
io::RobotOptions robot_options(std::vector<std::string> without, bool soft_limits,
                               const std::optional<std::filesystem::path>& joint_limits,
                               const Ranges& limits) {
  io::RobotOptions options{std::move(without), soft_limits, joint_limits.value_or("")};
  for (const auto& [joint, range] : limits) options.limits[joint] = {range[0], range[1]};
  return options;
}

Robot make_robot(std::shared_ptr<const RobotModel> model, const RobotKeywords& keywords) {
  Robot robot;
  robot.model = std::move(model);
  choose_links(robot, keywords.base, keywords.tip, keywords.roll.has_value());
  if (keywords.tool) robot.tool = *keywords.tool;
  robot.hold = keywords.hold;
  robot.roll = keywords.roll;
  static_cast<void>(planning_arm(robot));  // throws for an unsuitable arm
  return robot;
}

/// Returns the tool poses of joints, rad: (4, 4) for (7,), and (n, 4, 4) for (n, 7).
py::array_t<double> tool_poses(const Robot& robot, const ArrayLike& joints) {
  const Chain chain = arm_of(robot).chain;
  const std::vector<Config> states = to_joints(joints, "joints", chain.coordinates()).rows;
  const auto count = static_cast<py::ssize_t>(states.size());
  py::array_t<double> poses({count, py::ssize_t{4}, py::ssize_t{4}});
  for (py::ssize_t k = 0; k < count; ++k) {
    const Pose pose = chain.tool(states[static_cast<std::size_t>(k)]);
    Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(poses.mutable_data(k, 0, 0)) =
        pose.matrix();
  }
  if (to_array(joints, "joints").ndim() == 1) return poses.attr("reshape")(4, 4);
  return poses;
}

py::array_t<double> joint_limits(const Robot& robot) {
  const Chain chain = arm_of(robot).chain;
  const auto joints = static_cast<int>(chain.coordinates());
  py::array_t<double> limits({joints, 2});
  for (int j = 0; j < joints; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    const double infinity = std::numeric_limits<double>::infinity();
    limits.mutable_at(j, 0) = limit.continuous ? -infinity : limit.lower;
    limits.mutable_at(j, 1) = limit.continuous ? infinity : limit.upper;
  }
  return limits;
}

std::string robot_words(const Robot& robot) {
  const PlanningArm arm = planning_arm(robot);
  const char* const joints = robot.roll           ? "six joints and the roll"
                             : arm.kind.redundant ? "seven joints"
                                                  : "six joints";
  return "'" + robot.model->name + "', " + robot.base_link + " to " + robot.tip_link + ", " +
         joints + ", " + arm.kind.method();
}

// --- scene

std::size_t find_object(const Scene& scene, const std::string& name) {
  const auto found = std::find_if(scene.begin(), scene.end(),
                                  [&](const SceneObject& object) { return object.name == name; });
  if (found != scene.end()) return static_cast<std::size_t>(found - scene.begin());
  std::vector<std::string> known;
  for (const SceneObject& object : scene) known.push_back(object.name);
  throw py::key_error("no object '" + name + "'" +
                      (known.empty() ? "" : ", nearest is '" + nearest_name(name, known) + "'"));
}

Scene to_scene(const SceneObjects& objects) {
  Scene scene;
  for (const py::handle object : objects) scene.push_back(object.cast<const SceneObject&>());
  return scene;
}

void bind_shapes(py::module_& m) {
  py::class_<Sphere>(m, "Sphere", "A ball about its frame's origin.")
      .def(pickling<Sphere>())
      .def(py::init([](double radius) { return Sphere{radius}; }), py::arg("radius"), "radius: m.")
      .def_readonly("radius", &Sphere::radius, "m.")
      .def("__repr__", [](const Sphere& s) { return "Sphere(" + number(s.radius) + ")"; });
  py::class_<Box>(m, "Box", "A box centred on its frame.")
      .def(pickling<Box>())
      .def(py::init([](const Vector3d& size) { return Box{size}; }), py::arg("size"),
           "size: full edge lengths along x, y, z, m.")
      .def_readonly("size", &Box::size, "Full edge lengths, (3,), m.")
      .def("__repr__", [](const Box& b) {
        return "Box([" + number(b.size[0]) + ", " + number(b.size[1]) + ", " + number(b.size[2]) +
               "])";
      });
  const auto round = [&](auto shape, const char* name, const char* doc, const char* length) {
    using Round = decltype(shape);
    py::class_<Round>(m, name, doc)
        .def(pickling<Round>())
        .def(py::init([](double radius, double along) {
               return Round{radius, along};
             }),
             py::arg("radius"), py::arg("length"))
        .def_readonly("radius", &Round::radius, "m.")
        .def_readonly("length", &Round::length, length)
        .def("__repr__", [type = std::string(name)](const Round& r) {
          return type + "(" + number(r.radius) + ", " + number(r.length) + ")";
        });
  };
  round(Cylinder{}, "Cylinder", "A cylinder along z, centred on its frame.", "m.");
  round(Capsule{}, "Capsule", "A capsule along z, centred on its frame.",
        "Of the part between the two caps, m.");
  py::class_<Mesh>(m, "Mesh", "Triangles. A closed surface is a solid, an open one has no inside.")
      .def(pickling<Mesh>())
      .def(py::init([](const std::filesystem::path& file, const Typed<"float | ArrayLike">& scale) {
             io::MeshCache cache;
             return Mesh{io::load_mesh(file, to_scale(scale), cache)};
           }),
           py::arg("file"), py::arg("scale") = 1.0,
           "file: STL, OBJ, DAE or PLY. scale: a number, or one for each axis; a negative one "
           "mirrors. Raises InputError.")
      .def_static("from_arrays", &mesh_of_arrays, py::arg("vertices"), py::arg("triangles"),
                  py::arg("name") = "mesh",
                  "vertices: (n, 3), m. triangles: (m, 3) indices of vertices, counter-clockwise "
                  "as seen from outside.")
      .def_property_readonly(
          "vertices",
          [](const Mesh& mesh) {
            const std::shared_ptr<const std::vector<Vector3d>> all(mesh.mesh, &mesh.mesh->vertices);
            return column(
                all, all->empty() ? static_cast<const double*>(nullptr) : all->front().data(), 3);
          },
          "(n, 3) float64, m; read-only.")
      .def_property_readonly(
          "closed", [](const Mesh& mesh) { return mesh.mesh->closed; }, "Whether it is a solid.")
      .def("__repr__", [](const Mesh& mesh) {
        return "<Mesh '" + mesh.mesh->source + "': " + std::to_string(mesh.mesh->triangles.size()) +
               " triangles, " + (mesh.mesh->closed ? "closed>" : "open>");
      });
}

void bind_robot(py::module_& m) {
  PlainStruct<Roll>(m, "Roll",
                    "How far the tool may stand turned about its own z axis, rad. A turn or more, "
                    "the default, is a circle.")
      .member("lower", &Roll::lower, "rad.")
      .member("upper", &Roll::upper, "rad.")
      .finish();

  py::class_<AttachedBody>(
      m, "AttachedBody",
      "A tool or a part that the arm carries. It does not change; attach another.")
      .def(pickling<AttachedBody>())
      .def(py::init(
               [](std::string name, const PythonShape& shape, std::string link, const Pose& pose) {
                 return AttachedBody{std::move(name), to_shape(shape), pose, std::move(link)};
               }),
           py::arg("name"), py::arg("shape"), py::arg("link"),
           py::arg("pose") = py::make_tuple(0, 0, 0), "pose: of the shape in the frame of `link`.")
      .def_readonly("name", &AttachedBody::name)
      .def_property_readonly("shape",
                             [](const AttachedBody& body) { return from_shape(body.shape); })
      .def_readonly("link", &AttachedBody::link)
      .def_property_readonly(
          "pose", [](const AttachedBody& body) { return body.pose; },
          "(4, 4), in the frame of `link`.")
      .def("__repr__", [](const AttachedBody& body) {
        return "<AttachedBody '" + body.name + "' on " + body.link + ": " +
               shape_words(body.shape) + ">";
      });

  const char* const keywords =
      "base, tip: links that the arm reaches from and to; without them the first arm of seven "
      "joints that is found,\n"
      "with roll of six, as `swivel info` does. tool: pose of the tool in the tip link. hold: "
      "positions of other joints by\n"
      "name, rad or m. packages: name -> folder, for package:// names of meshes. roll: of arms of "
      "six joints whose tool may turn "
      "about its own z axis. without: links left out, with all that they carry. soft_limits: "
      "whether joints keep the soft limits\n"
      "of the URDF's <safety_controller>. joint_limits: MoveIt's joint_limits.yaml. limits: joint "
      "-> "
      "(lower, upper), rad or m, within the URDF's.\n"
      "Raises InputError.";
  py::class_<Robot> type(m, "Robot",
                         "The arm that plans: a chain of a robot model, and what it carries.");
  make_copyable(type);
  type.def(pickling<Robot>());
  type.def(py::init([](const std::filesystem::path& urdf,
                       const std::optional<std::filesystem::path>& srdf,
                       std::optional<std::string> base, std::optional<std::string> tip,
                       const std::optional<Pose>& tool, std::map<std::string, double> hold,
                       const Packages& packages, const std::optional<Roll>& roll,
                       std::vector<std::string> without, bool soft_limits,
                       const std::optional<std::filesystem::path>& joint_limits,
                       const Ranges& limits) {
             return make_robot(io::load_robot(urdf, srdf.value_or(""), packages,
                                              robot_options(std::move(without), soft_limits,
                                                            joint_limits, limits)),
                               {std::move(base), std::move(tip), tool, std::move(hold), roll});
           }),
           py::arg("urdf"), py::arg("srdf") = py::none(), py::kw_only(),
           py::arg("base") = py::none(), py::arg("tip") = py::none(), py::arg("tool") = py::none(),
           py::arg("hold") = std::map<std::string, double>{}, py::arg("packages") = Packages{},
           py::arg("roll") = py::none(), py::arg("without") = std::vector<std::string>{},
           py::arg("soft_limits") = true, py::arg("joint_limits") = py::none(),
           py::arg("limits") = Ranges{}, keywords)
      .def_static(
          "from_string",
          [](const std::string& urdf, const std::optional<std::string>& srdf,
             std::optional<std::string> base, std::optional<std::string> tip,
             const std::optional<Pose>& tool, std::map<std::string, double> hold,
             const Packages& packages, const std::optional<Roll>& roll,
             std::vector<std::string> without, bool soft_limits,
             const std::optional<std::filesystem::path>& joint_limits, const Ranges& limits) {
            return make_robot(io::parse_robot(urdf, srdf.value_or(""), packages,
                                              robot_options(std::move(without), soft_limits,
                                                            joint_limits, limits)),
                              {std::move(base), std::move(tip), tool, std::move(hold), roll});
          },
          py::arg("urdf"), py::arg("srdf") = py::none(), py::kw_only(),
          py::arg("base") = py::none(), py::arg("tip") = py::none(), py::arg("tool") = py::none(),
          py::arg("hold") = std::map<std::string, double>{}, py::arg("packages") = Packages{},
          py::arg("roll") = py::none(), py::arg("without") = std::vector<std::string>{},
          py::arg("soft_limits") = true, py::arg("joint_limits") = py::none(),
          py::arg("limits") = Ranges{},
          (std::string("The same of the texts of a URDF and an SRDF, as ROS 2's robot_description "
                       "has them.\n") +
           keywords)
              .c_str())
      .def_property_readonly(
          "name", [](const Robot& robot) { return robot.model->name; }, "Of the URDF.")
      .def_readonly("base", &Robot::base_link, "Name of the base link: the frame of everything.")
      .def_readonly("tip", &Robot::tip_link, "Name of the link that carries the tool.")
      .def_property(
          "tool", [](const Robot& robot) { return robot.tool; },
          [](Robot& robot, const Pose& tool) { robot.tool = tool; },
          "(4, 4): tool frame in the tip link.")
      .def_readonly("hold", &Robot::hold,
                    "Positions of joints that the arm leaves out, rad or m (a copy).")
      .def_property_readonly(
          "held",
          [](const Robot& robot) {
            std::map<std::string, double> held;
            for (const HeldJoint& joint : arm_of(robot).held) held[joint.name] = joint.position;
            return held;
          },
          "Joints between base and tip that are not planned -> where they stand, rad or m: where "
          "`hold` says, else at 0 or at the "
          "limit nearest to it.")
      .def_readonly("roll", &Robot::roll, "None where the tool stands as the waypoints have it.")
      .def_property_readonly(
          "links",
          [](const Robot& robot) {
            std::vector<std::string> names;
            for (const Link& link : robot.model->links) names.push_back(link.name);
            return names;
          },
          "Names of all links.")
      .def_property_readonly(
          "attached", [](const Robot& robot) { return robot.attached; },
          "What it carries (a copy).")
      .def(
          "attach",
          [](Robot& robot, AttachedBody body) { robot.attached.push_back(std::move(body)); },
          py::arg("body"))
      .def(
          "detach",
          [](Robot& robot, const std::string& name) {
            if (std::erase_if(robot.attached,
                              [&](const AttachedBody& body) { return body.name == name; }) == 0)
              throw py::key_error("no attached body '" + name + "'");
          },
          py::arg("name"))
      .def_property_readonly(
          "joint_names",
          [](const Robot& robot) { return names_in(arm_of(robot).chain.joint_names); },
          "Base to tip, seven; of six joints with `roll` the last one is the roll, without they "
          "are "
          "six.")
      .def_property_readonly(
          "joint_limits", &joint_limits,
          "(7, 2), or (6, 2): lower and upper, rad; infinite for continuous joints.")
      .def_property_readonly(
          "method", [](const Robot& robot) { return planning_arm(robot).kind.method(); },
          "How solutions of a pose are found, in a line.")
      .def("tool_pose", &tool_poses, py::arg("joints"),
           "Pose of the tool in the base frame. joints: (7,) or (n, 7), rad. Returns (4, 4) or (n, "
           "4, 4).")
      .def("__repr__", [](const Robot& robot) { return "<Robot " + robot_words(robot) + ">"; });
}

/// Names of bodies that may touch, or a dict from name to the depth to which each may, m.
using AllowedBodies =
    std::variant<std::vector<std::string>, std::map<std::string, std::optional<double>>>;
std::vector<Allowed> to_allowed(const AllowedBodies& bodies) {
  if (const auto* names = std::get_if<0>(&bodies)) return {names->begin(), names->end()};
  std::vector<Allowed> allowed;
  for (const auto& [name, depth] : std::get<1>(bodies)) allowed.emplace_back(name, depth);
  return allowed;
}

void bind_scene(py::module_& m) {
  py::class_<SceneObject>(
      m, "SceneObject",
      "A body fixed in the base frame. It does not change: scenes and planners have move().")
      .def(pickling<SceneObject>())
      .def(py::init([](std::string name, const PythonShape& shape, const Pose& pose,
                       const AllowedBodies& allow) {
             return SceneObject{std::move(name), to_shape(shape), pose, to_allowed(allow)};
           }),
           py::arg("name"), py::arg("shape"), py::arg("pose") = py::make_tuple(0, 0, 0),
           py::arg("allow") = AllowedBodies{},
           "pose: in the base frame. allow: links and attached bodies that may touch it, or {name: "
           "how deep, m}; None: however "
           "deep.")
      .def_readonly("name", &SceneObject::name)
      .def_property_readonly("shape",
                             [](const SceneObject& object) { return from_shape(object.shape); })
      .def_property_readonly(
          "pose", [](const SceneObject& object) { return object.pose; },
          "(4, 4), in the base frame.")
      .def_property_readonly(
          "allow",
          [](const SceneObject& object) {
            std::vector<std::string> names;
            for (const Allowed& allowed : object.allow) names.push_back(allowed.body);
            return names;
          },
          "Links and attached bodies that may touch it.")
      .def_property_readonly(
          "allow_depth",
          [](const SceneObject& object) {
            std::map<std::string, double> depths;
            for (const Allowed& allowed : object.allow)
              if (allowed.depth) depths[allowed.body] = *allowed.depth;
            return depths;
          },
          "How deep bodies may be in it, m, by name; those of `allow` that are not here may be "
          "however deep.")
      .def("__repr__", [](const SceneObject& object) {
        const Vector3d at = object.pose.translation();
        const std::string text = formatted(" at %.4g %.4g %.4g>", at.x(), at.y(), at.z());
        return "<SceneObject '" + object.name + "': " + shape_words(object.shape) + text;
      });

  py::class_<Scene> type(
      m, "Scene", "Bodies in the base frame, by name, in the order in which they were added.");
  make_copyable(type);
  type.def(pickling<Scene>());
  type.def(py::init(&to_scene), py::arg("objects") = py::tuple(),
           "objects: SceneObjects, as a scene or in any sequence.")
      .def(
          "add",
          [](Scene& scene, std::string name, const PythonShape& shape, const Pose& pose,
             const AllowedBodies& allow) {
            if (std::any_of(scene.begin(), scene.end(),
                            [&](const SceneObject& object) { return object.name == name; }))
              throw InvalidArgument("'" + name +
                                    "' is in the scene already: allowed is a name of its own");
            scene.push_back({std::move(name), to_shape(shape), pose, to_allowed(allow)});
          },
          py::arg("name"), py::arg("shape"), py::arg("pose") = py::make_tuple(0, 0, 0),
          py::arg("allow") = AllowedBodies{},
          "pose: in the base frame. allow: links and attached bodies that may touch it, or {name: "
          "how deep, m}; None: however "
          "deep.")
      .def(
          "move",
          [](Scene& scene, const std::string& name, const Pose& pose) {
            scene[find_object(scene, name)].pose = pose;
          },
          py::arg("name"), py::arg("pose"),
          "pose: in the base frame. Raises KeyError for an unknown name.")
      .def(
          "remove",
          [](Scene& scene, const std::string& name) {
            scene.erase(scene.begin() + static_cast<std::ptrdiff_t>(find_object(scene, name)));
          },
          py::arg("name"), "Raises KeyError for an unknown name.")
      .def(
          "__getitem__",
          [](const Scene& scene, const std::string& name) {
            return scene[find_object(scene, name)];
          },
          py::arg("name"))
      .def(
          "__contains__",
          [](const Scene& scene, const std::string& name) {
            return std::any_of(scene.begin(), scene.end(),
                               [&](const SceneObject& object) { return object.name == name; });
          },
          py::arg("name"))
      .def("__len__", [](const Scene& scene) { return scene.size(); })
      .def(
          "__iter__", [](const Scene& scene) -> Typed<"Iterator[SceneObject]"> {
            py::list objects;  // copies, as the scene may change meanwhile
            for (const SceneObject& object : scene) objects.append(py::cast(object));
            return py::iter(objects);
          })
      .def("__repr__", [](const Scene& scene) {
        std::string text;
        for (const SceneObject& object : scene)
          text += (text.empty() ? ": '" : ", '") + object.name + "'";
        return "<Scene of " + std::to_string(scene.size()) + " objects" + text + ">";
      });
}

void bind_task(py::module_& m) {
  bind_enum<EdgeMode>(m, "EdgeMode", "What is proved of motions between layers.",
                      {{"continuous", EdgeMode::kContinuous}, {"nodes", EdgeMode::kNodes}});
  bind_enum<CostMetric>(m, "CostMetric", "What a step costs: docs/formats.md, `cost`.",
                        {{"l2", CostMetric::kL2},
                         {"l1", CostMetric::kL1},
                         {"max", CostMetric::kMax},
                         {"time", CostMetric::kTime}});
  PlainStruct<Resolution>(m, "Resolution", "Steps of the lattice, as keywords.")
      .member("ds", &Resolution::ds, "Along the path, m.")
      .member("dphi", &Resolution::dphi, "Of the arm angle, rad.")
      .member("dalpha", &Resolution::dalpha, "Of tool rotation, rad.")
      .member("arc", &Resolution::arc,
              "Self-motion between nodes, of arms that have no arm angle, rad; None: the default.")
      .member("arcs", &Resolution::arcs, "Nodes on arcs of arm angles that the grid misses.")
      .member("droll", &Resolution::droll, "Of the roll, of arms of seven joints, rad.")
      .member("knot", &Resolution::knot,
              "m, between layers at which arms with a free roll, and those that have no arm angle, "
              "choose their redundancy anew; 0: at every layer; None: the default.")
      .finish();
  PlainStruct<Limits>(m, "Limits",
                      "What is to be kept, as keywords: docs/formats.md. None: no such limit, or "
                      "the default named there.")
      .member("clearance", &Limits::clearance, "m, between bodies at layers.")
      .member("self_clearance", &Limits::self_clearance, "m, between bodies of the robot.")
      .member("manipulability", &Limits::manipulability, "Least sqrt(det(J J^T)).")
      .member("joint_margin", &Limits::joint_margin, "rad, kept from both limits of each joint.")
      .member("joint_step", &Limits::joint_step, "rad, largest move of a joint between layers.")
      .member("arm_slope", &Limits::arm_slope, "rad/m, largest change of the arm angle.")
      .member("roll_slope", &Limits::roll_slope, "rad/m, of the roll.")
      .member("step_error", &Limits::step_error, "rad, second-order estimate of a step.")
      .member("tool_path_error", &Limits::tool_path_error, "m, tool off its path between layers.")
      .member("tool_angle_error", &Limits::tool_angle_error, "rad, the same of its orientation.")
      .member("tool_speed", &Limits::tool_speed, "m/s that the joints must follow.")
      .member("tool_turn_speed", &Limits::tool_turn_speed, "rad/s that the joints must follow.")
      .choice("edges", &Limits::edges, "EdgeMode, or its name.")
      .member("edge_clearance", &Limits::edge_clearance, "m, kept between layers.")
      .member("edge_tolerance", &Limits::edge_tolerance, "m, how finely that is proved.")
      .of_joints("joint_speed", &Limits::joint_speed,
                 "rad/s, one for each joint, instead of the URDF's.")
      .of_joints("joint_acceleration", &Limits::joint_acceleration,
                 "rad/s^2, one for each joint, of motions.")
      .of_joints("joint_jerk", &Limits::joint_jerk, "rad/s^3, one for each joint, of motions.")
      .finish();
  PlainStruct<Cost>(m, "Cost", "What is summed over the steps of a path, as keywords.")
      .choice("metric", &Cost::metric, "CostMetric, or its name.")
      .of_joints("weights", &Cost::weights,
                 "One for each joint, 0 or 1e-6 to 1e6; None: 1 each, that of the roll of "
                 "six-joint arms 0.")
      .member("roll", &Cost::roll,
              "Per metre and rad that the tool stands turned from the waypoints' own; 0 or 1e-6 to "
              "1e6.")
      .finish();
  PlainStruct<PathSmoothing>(
      m, "PathSmoothing", "How far the tool may leave the polyline of its waypoints, as keywords.")
      .member("position", &PathSmoothing::position, "m.")
      .member("angle", &PathSmoothing::angle, "rad.")
      .finish();
  PlainStruct<Refinement>(m, "Refinement", "What refining keeps, as keywords.")
      .member("smoothing", &Refinement::smoothing,
              "m, the length over which a bend costs as much as a way of its size.")
      .member("joint_margin", &Refinement::joint_margin, "rad, kept from limits besides.")
      .member("singular_margin", &Refinement::singular_margin, "rad, kept from singular angles.")
      .finish();

  py::class_<Task> type(m, "Task", "What the tool is to do, and within which limits.");
  make_copyable(type);
  type.def(pickling<Task>());
  type.def(py::init([](std::vector<Waypoint> waypoints, std::string frame, const Limits& limits,
                       const Resolution& resolution, const ArrayLike& start,
                       std::optional<double> start_at, double start_tolerance, const ArrayLike& end,
                       const Cost& cost, const std::optional<PathSmoothing>& smooth,
                       const Refinement& refinement, bool closed) {
             Task task;
             task.waypoints = std::move(waypoints);
             task.path_frame = std::move(frame);
             task.limits = limits, task.resolution = resolution, task.cost = cost;
             task.start = to_posture(start, "start"), task.start_at = start_at,
             task.start_tolerance = start_tolerance, task.end = to_posture(end, "end");
             task.smooth = smooth, task.refinement = refinement, task.closed = closed;
             return task;
           }),
           py::arg("waypoints"), py::kw_only(), py::arg("frame") = "",
           py::arg_v("limits", Limits(), "Limits()"),
           py::arg_v("resolution", Resolution(), "Resolution()"), py::arg("start") = py::none(),
           py::arg("start_at") = py::none(), py::arg("start_tolerance") = Task().start_tolerance,
           py::arg("end") = py::none(), py::arg_v("cost", Cost(), "Cost()"),
           py::arg("smooth") = py::none(), py::arg_v("refinement", Refinement(), "Refinement()"),
           py::arg("closed") = false,
           "waypoints: poses of the tool in `frame`: (n, 7) rows x y z qw qx qy qz, (n, 4, 4), or "
           "a list of either; or (n, 9) rows, "
           "with the least and the most roll there, rad. frame: the "
           "base\n"
           "link (also empty) or the name of a scene object. start: (7,) joints to begin with, "
           "rad. start_at: m along the path "
           "where\n"
           "the start stands. end: (7,) joints to end in at the last waypoint, rad. closed: the "
           "path must end in the joints in which it begins; its last waypoint is its first.")
      .def_readwrite("frame", &Task::path_frame,
                     "Base link (also empty) or the name of a scene object.")
      .def_readwrite("waypoints", &Task::waypoints,
                     "(n, 7): x y z (m) qw qx qy qz, in `frame`; with roll_min and roll_max (rad) "
                     "(n, 9). A copy; assign to change it.")
      .def_readwrite("smooth", &Task::smooth, "None: the polyline as it is.")
      .def_readwrite("resolution", &Task::resolution)
      .def_readwrite("limits", &Task::limits)
      .def_property(
          "start", [](const Task& task) { return task.start; },
          [](Task& task, const OptionalArray& start) { task.start = to_posture(start, "start"); },
          "(7,) joints to begin with, rad, or None. A copy; assign to change it.")
      .def_readwrite("start_at", &Task::start_at, "m along the path, or None.")
      .def_readwrite("start_tolerance", &Task::start_tolerance, "m and rad.")
      .def_property(
          "end", [](const Task& task) { return task.end; },
          [](Task& task, const OptionalArray& end) { task.end = to_posture(end, "end"); },
          "(7,) joints to end in, rad, or None. A copy; assign to change it.")
      .def_readwrite("closed", &Task::closed,
                     "Whether the path must end in the joints in which it begins.")
      .def_readwrite("cost", &Task::cost)
      .def_readwrite("refinement", &Task::refinement)
      .def(
          "__eq__", [](const Task& a, const Task& b) { return a == b; }, py::is_operator())
      .def("__repr__",
           [](const Task& task) {
             return "<Task of " + std::to_string(task.waypoints.size()) + " waypoints" +
                    (task.closed ? ", closed>" : ">");
           })
      .attr("__hash__") = py::none();
}

}  // namespace

ArmModel arm_of(const Robot& robot) {
  return build_arm(*robot.model, robot.base_link, robot.tip_link, robot.hold, robot.tool,
                   robot.roll);
}

std::optional<Config> to_posture(py::handle joints, const char* name) {
  if (joints.is_none()) return {};
  const Array array = to_array(joints, "joints: (7,), rad");
  if (array.ndim() != 1 || (array.shape(0) != kDof && array.shape(0) != kDof - 1))
    throw py::value_error(std::string(name) + " of shape " + shape_text(array) +
                          ": allowed is (7,), or (6,) of six joints without a roll, rad");
  Config q;
  std::copy_n(array.data(), array.shape(0), q.data());
  if (array.shape(0) < kDof) q[kDof - 1] = kNoSeventh;
  return q;
}

Waypoint to_waypoint(py::handle source, bool position_alone) {
  const char* const allowed =
      position_alone
          ? "a pose: (4, 4), [x y z qw qx qy qz] or [x y z]"
          : "poses: (4, 4), [x y z qw qx qy qz] or [x y z qw qx qy qz roll_min roll_max]";
  const Array values = to_array(source, allowed);
  const double* const v = values.data();
  if (values.ndim() == 1 && values.shape(0) == 7)
    return {{v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}};
  if (values.ndim() == 1 && values.shape(0) == 9 && !position_alone)
    return {{v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}, Roll{v[7], v[8]}};
  if (values.ndim() == 1 && values.shape(0) == 3 && position_alone) return {{v[0], v[1], v[2]}};
  if (values.ndim() != 2 || values.shape(0) != 4 || values.shape(1) != 4)
    throw py::value_error("pose of shape " + shape_text(values) + ": allowed are " + allowed);
  const Pose pose = to_rigid(v);
  return {pose.translation(), Quaterniond(pose.linear())};
}

Pose to_rigid(const double* numbers) {
  const Eigen::Matrix4d X = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers);
  const Matrix3d R = X.topLeftCorner<3, 3>();
  if (!X.allFinite() ||
      !((R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff() <= 1e-6) ||
      R.determinant() <= 0 || X.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
    throw py::value_error(
        "pose is no rigid transform: allowed are a rotation within 1e-6, a finite translation, 0 0 "
        "0 1 below");
  Pose pose = Pose::Identity();
  pose.translation() = X.topRightCorner<3, 1>();
  pose.linear() = R;
  return pose;
}

void require_unit(const Quaterniond& quaternion) {
  const double norm = quaternion.norm();
  if (std::abs(norm - 1) <= 1e-3) return;
  const std::string text =
      formatted("pose: quaternion of length %g: allowed is 1 within 1e-3", norm);
  throw py::value_error(text);
}

Pose to_pose(py::handle source) {
  const Waypoint waypoint = to_waypoint(source, true);
  require_unit(waypoint.orientation);
  Pose pose = Pose::Identity();
  pose.translation() = waypoint.position;
  const Array values = Array::ensure(source);
  if (values.ndim() == 2)
    pose.linear() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data())
                        .topLeftCorner<3, 3>();
  else
    pose.linear() = waypoint.orientation.normalized().toRotationMatrix();
  return pose;
}

std::vector<Waypoint> to_waypoints(py::handle source) {
  if (!py::isinstance<py::iterable>(source))
    throw py::value_error("waypoints: allowed are (n, 7), (n, 4, 4) or a list of poses");
  std::vector<Waypoint> waypoints;
  for (const py::handle item : source) {
    try {
      waypoints.push_back(to_waypoint(item, false));
    } catch (const py::value_error& error) {
      throw py::value_error("waypoints[" + std::to_string(waypoints.size()) + "]: " + error.what());
    }
    if (waypoints.back().roll.has_value() != waypoints.front().roll.has_value())
      throw py::value_error("waypoints[" + std::to_string(waypoints.size() - 1) +
                            "]: roll_min and roll_max are not given at all waypoints: allowed are "
                            "rows that all have them, or none");
  }
  return waypoints;
}

void pass_half_turns(const Robot& robot, std::vector<Waypoint>& waypoints) {
  if (robot.roll && robot.roll->circle()) io::choose_sides(waypoints);
}

py::array_t<double> from_waypoints(const std::vector<Waypoint>& waypoints) {
  const bool rolls = !waypoints.empty() && waypoints.front().roll;
  py::array_t<double> array(
      {static_cast<py::ssize_t>(waypoints.size()), py::ssize_t{rolls ? 9 : 7}});
  double* out = array.mutable_data();
  for (const auto& [position, q, roll] : waypoints) {
    for (const double value :
         {position.x(), position.y(), position.z(), q.w(), q.x(), q.y(), q.z()})
      *out++ = value;
    if (rolls) *out++ = roll->lower, *out++ = roll->upper;
  }
  return array;
}

Postures to_joints(py::handle source, const char* what, std::size_t width) {
  const std::string one = width == 0 ? "7" : std::to_string(width);
  const std::string allowed = "(" + one + ",) and (n, " + one + ")";
  Array array = to_array(source, ("joints: " + allowed + ", rad").c_str());
  const std::string shape = shape_text(array);
  if (array.ndim() == 1) array = array.reshape({1, static_cast<int>(array.shape(0))});
  const auto columns = array.ndim() == 2 ? static_cast<std::size_t>(array.shape(1)) : 0;
  if (columns == 0 || (width != 0 ? columns != width : columns != kDof && columns != kDof - 1))
    throw py::value_error(std::string(what) + " of shape " + shape + ": allowed are " + allowed +
                          (width == 0 ? ", or 6 of six joints without a roll" : ""));
  Postures postures{std::vector<Config>(static_cast<std::size_t>(array.shape(0))), columns};
  for (std::size_t k = 0; k < postures.rows.size(); ++k)
    std::copy_n(array.data(static_cast<py::ssize_t>(k), 0), columns, postures.rows[k].data());
  return postures;
}

std::vector<std::string> names_in(const JointNames& names) {
  return {names.begin(), names.begin() + static_cast<std::ptrdiff_t>(named_joints(names))};
}

void bind_problem(py::module_& m) {
  m.def("pose", &make_pose, py::arg("xyz") = py::make_tuple(0, 0, 0), py::arg("rpy") = py::none(),
        py::arg("quat") = py::none(), py::arg("axis") = py::none(), py::arg("tangent") = py::none(),
        "A pose as a (4, 4) array. xyz: m. rpy: roll, pitch, yaw about the fixed axes x, y, z, "
        "rad, as in a URDF. quat: w x y z, of\n"
        "any length but 0. axis: direction of the z axis, against a surface's outward normal; x "
        "points along the part of\n"
        "`tangent` that is perpendicular to it, or is the x axis turned as little as can be.");
  bind_shapes(m);
  bind_robot(m);
  bind_scene(m);
  bind_task(m);
}

}  // namespace swivel::python
