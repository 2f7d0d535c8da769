// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/robot_model.hpp"

namespace swivel {

/// How far the tool may stand turned about its own z axis from where the waypoints have it, rad: rotations about the axis of a
/// torch or a milling cutter change nothing for the work. A range of a turn or more is a circle.
struct Roll {
  double lower = -kPi, upper = kPi;
  [[nodiscard]] bool circle() const { return upper - lower >= kTwoPi - 1e-9; }
  bool operator==(const Roll&) const = default;
};

/// One pose of the tool path: tool frame in the path's frame.
struct Waypoint {
  Vector3d position = Vector3d::Zero();
  Quaterniond orientation = Quaterniond::Identity();  ///< need not be exactly unit: | |q| - 1 | <= 1e-3
  /// Of paths with Robot::roll, within which it must lie: at all waypoints or at none. Between two waypoints its ends are linear.
  std::optional<Roll> roll = {};
  bool operator==(const Waypoint&) const = default;
};

/// A robot link or an attached body that may touch a scene object.
struct Allowed {
  Allowed() = default;
  Allowed(const char* name) : body(name) {}  // implicit, like the next: most are names alone
  Allowed(std::string name, std::optional<double> most = {}) : body(std::move(name)), depth(most) {}
  std::string body;
  std::optional<double> depth;  ///< how deep the two may be in each other, m (docs/model.md, "Contact"); unset: however deep
  bool operator==(const Allowed&) const = default;
};

/// A body fixed in the base frame. One shape each.
struct SceneObject {
  std::string name;
  Shape shape;
  Pose pose = Pose::Identity();  ///< in base_link
  std::vector<Allowed> allow;    ///< what may touch it
};

/// A tool or held part, rigid in `link`.
struct AttachedBody {
  std::string name;
  Shape shape;
  Pose pose = Pose::Identity();  ///< in the frame of `link`
  std::string link;
};

enum class EdgeMode { kContinuous, kNodes };
enum class CostMetric { kL2, kMax, kTime };

/// How far the curve that the tool follows may leave the polyline of the waypoints, so that corners are rounded. Zero: not at all.
struct PathSmoothing {
  double position = 0.1e-3;  ///< m
  double angle = 1e-3;       ///< rad
  bool operator==(const PathSmoothing&) const = default;
};

/// What refinement keeps besides the limits, and how it weighs smoothness against cost.
struct Refinement {
  double smoothing = 0.01;  ///< m: the length over which a change of direction of the joints costs as much as a way of its size
  double joint_margin = 0;  ///< rad, kept from the limits in addition to Limits::joint_margin
  double singular_margin = 0.02;  ///< rad, kept from singular angles of shoulder, elbow and wrist, as far as the path refined does
  bool operator==(const Refinement&) const = default;
};

/// docs/model.md. Unset optionals mean "no such limit".
struct Limits {
  double clearance = 0.005;                       ///< d_safe, m
  std::optional<double> self_clearance;           ///< the same between the robot's own bodies, m; default clearance
  double manipulability = 0.0;                    ///< least sqrt(det(J J^T))
  double joint_margin = 0.0;                      ///< rad, kept from both ends of every bounded joint
  double joint_step = 0.5;                        ///< rad, largest move of any joint between neighbouring layers
  double arm_slope = 20.0;                        ///< rad/m, arm-angle change allowed per metre of path
  double roll_slope = 20.0;                       ///< rad/m, the same of the roll
  std::optional<double> step_error;               ///< rad, second-order estimate
  std::optional<double> tool_path_error = 0.001;  ///< m
  std::optional<double> tool_angle_error;         ///< rad
  std::optional<double> tool_speed;               ///< m/s
  std::optional<double> tool_turn_speed;          ///< rad/s
  EdgeMode edges = EdgeMode::kContinuous;
  std::optional<double> edge_clearance;  ///< d_edge, m; default clearance / 2
  double edge_tolerance = 0.0005;        ///< h, m
  // What motions in time keep, instead of what the robot model states: rad/s, rad/s^2, rad/s^3, base to tip.
  std::optional<std::array<double, kDof>> joint_speed, joint_acceleration, joint_jerk;
  [[nodiscard]] double d_edge() const { return edge_clearance.value_or(clearance / 2); }
  [[nodiscard]] double d_self() const { return self_clearance.value_or(clearance); }
  [[nodiscard]] double d_self_edge() const { return edge_clearance.value_or(d_self() / 2); }
  bool operator==(const Limits&) const = default;
};

struct Resolution {
  double ds = 0.005;    ///< m
  double dphi = 0.05;   ///< rad
  double dalpha = 0.1;  ///< rad of tool rotation
  double arc = 0.175;   ///< rad of self-motion between nodes, of arms that have no arm angle
  bool arcs = false;    ///< of S-R-S arms: nodes on arcs of arm angles that lie between those of the grid
  double droll = 0.1;   ///< rad, of the roll, of seven-joint arms
  double knot = 0.025;  ///< m between layers at which the roll and the arm angle of seven-joint arms are chosen together
  bool operator==(const Resolution&) const = default;
};

struct Cost {
  CostMetric metric = CostMetric::kL2;
  std::array<double, kDof> weights{1, 1, 1, 1, 1, 1, 1};  ///< 0, or 1e-6 to 1e6
  double roll = 0;  ///< per metre of path and rad that the roll is off the waypoints' own; 0, or 1e-6 to 1e6
  bool operator==(const Cost&) const = default;
};

/// Uniform offsets of one scene object for campaign episodes, half-widths. docs/formats.md.
struct Variation {
  std::string object;
  Vector3d xyz = Vector3d::Zero();
  Vector3d rpy = Vector3d::Zero();
};

/// The arm that plans: a chain of a model, and what it carries.
struct Robot {
  std::shared_ptr<const RobotModel> model;  // shared: every episode and planner reads the same one
  std::string base_link, tip_link;
  Pose tool = Pose::Identity();        ///< tool frame in tip_link
  std::map<std::string, double> hold;  ///< joint name -> position of joints of the model that the chain leaves out
  std::vector<AttachedBody> attached;
  /// Of arms of six joints, which need one more to choose: the roll is the seventh, last in every list of joints, without a speed
  /// of its own. `Cost::weights` has its weight too; 0 where turning the tool costs nothing. Of S-R-S arms of seven joints the roll
  /// is chosen besides the arm angle (roll_lattice.hpp).
  std::optional<Roll> roll;
};

/// What the tool is to do, and within which limits.
struct Task {
  std::string path_frame;               ///< base_link (also empty) or the name of a scene object
  std::vector<Waypoint> waypoints;      ///< in path_frame
  std::optional<PathSmoothing> smooth;  ///< unset: the polyline as it is
  Resolution resolution;
  Limits limits;
  /// Of seven joints whose tool may stand turned: by how much it does at each layer, rad, once that has been chosen; empty: it is
  /// still to be.
  std::vector<double> rolls;
  std::optional<Config> start;  ///< joints to begin with, rad
  /// Where on the path the start stands, m along the whole of it: layers begin there. Only with `start`; default: its beginning.
  std::optional<double> start_at;
  /// How far the tool may stand from the path at the start, m and rad. A start further than 1e-6 from it is taken as it is: the
  /// first layer has the pose that it has, and the first step leads from there to the path's next layer.
  double start_tolerance = 1e-6;
  Cost cost;
  Refinement refinement;
  bool operator==(const Task&) const = default;
};

/// Everything that a problem file says, files loaded. Poses in base_link unless said. Source: io::load_problem.
struct Problem : Robot, Task {
  std::string source;  ///< problem file, for messages
  std::vector<SceneObject> scene;
  std::vector<Variation> vary;
};

/// Waypoints in base_link (path_frame applied, quaternions normalised).
/// Throws InputError for fewer than two distinct waypoints, NaN, or a quaternion off unit by more than 1e-3.
[[nodiscard]] std::vector<Waypoint> waypoints_in_base(const Problem& problem);

}  // namespace swivel
