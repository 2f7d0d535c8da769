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

/// A range of the roll: the angle, rad, by which the tool may be turned about its own z axis from
/// the waypoint's orientation, since turning a torch or a milling cutter about its axis changes
/// nothing for the work. A range of a turn or more is a circle: every angle.
struct Roll {
  double lower = -kPi, upper = kPi;
  /// Returns true if the range is a turn or more (to 1e-9 rad).
  [[nodiscard]] bool circle() const { return upper - lower >= kTwoPi - 1e-9; }
  bool operator==(const Roll&) const = default;
};

/// One pose of the tool path: the tool frame in Task::path_frame.
struct Waypoint {
  /// m.
  Vector3d position = Vector3d::Zero();
  /// Need not be exactly unit: | |q| - 1 | <= 1e-3.
  Quaterniond orientation = Quaterniond::Identity();
  /// The range in which the roll must lie here, inside Robot::roll, which must be given and be less
  /// than a turn. Either all waypoints have one or none. Between two waypoints its ends change
  /// linearly.
  std::optional<Roll> roll = {};
  bool operator==(const Waypoint&) const = default;
};

/// A robot link or an attached body that may touch a scene object. It converts from a name alone.
struct Allowed {
  Allowed() = default;
  Allowed(const char* name) : body(name) {}  // implicit, like the next one: most are names alone
  Allowed(std::string name, std::optional<double> most = {}) : body(std::move(name)), depth(most) {}
  /// Name of the link or attached body.
  std::string body;
  /// Most penetration depth of the two bodies, m (docs/model.md, "Contact"); unset: any depth.
  std::optional<double> depth;
  bool operator==(const Allowed&) const = default;
};

/// A body fixed in the base frame, of one shape.
struct SceneObject {
  std::string name;
  Shape shape;
  Pose pose = Pose::Identity();  ///< in base_link
  std::vector<Allowed> allow;    ///< what may touch it
};

/// A tool or held part, of one shape, fixed to the robot link `link`.
struct AttachedBody {
  std::string name;
  Shape shape;
  Pose pose = Pose::Identity();  ///< in the frame of `link`
  std::string link;
};

/// What clearance is asked of: the motions between layers as well as nodes, or nodes alone.
enum class EdgeMode { kContinuous, kNodes };
/// How a step's joint moves become a cost: their weighted Euclidean norm, the sum of their weighted
/// magnitudes, the largest weighted one, or the time that the slowest joint needs.
enum class CostMetric { kL2, kL1, kMax, kTime };

/// How far the curve that the tool follows may leave the polyline through the waypoints, so that
/// corners are rounded. Zero: corners stay sharp.
struct PathSmoothing {
  double position = 0.1e-3;  ///< m
  double angle = 1e-3;       ///< rad
  bool operator==(const PathSmoothing&) const = default;
};

/// What refinement keeps besides the limits, and how it weighs smoothness against cost.
struct Refinement {
  /// The length of path over which a change of joint direction costs as much as a move of its size,
  /// m; 0: cost alone.
  double smoothing = 0.01;
  double joint_margin = 0;  ///< rad, kept from joint limits in addition to Limits::joint_margin
  /// rad, kept from singular angles of shoulder, elbow and wrist, or as much as the path before
  /// refinement keeps, if that is less.
  double singular_margin = 0.02;
  bool operator==(const Refinement&) const = default;
};

/// What a path must keep (docs/model.md). An unset optional means "no such limit", unless a default
/// is stated.
struct Limits {
  double clearance = 0.005;  ///< d_safe: least distance between bodies at nodes, m
  /// Least distance between the robot's own bodies, m; unset: `clearance`.
  std::optional<double> self_clearance;
  double manipulability = 0.0;  ///< least Yoshikawa manipulability, sqrt(det(J J^T)), m^3
  /// rad, or m of a slide, kept from both limits of every bounded joint
  double joint_margin = 0.0;
  /// rad, largest move of any joint between neighbouring layers; a slide may move by kSlideForTurn
  /// as many m.
  double joint_step = 0.5;
  double arm_slope = 20.0;   ///< rad/m, largest change of the arm angle per metre of path
  double roll_slope = 20.0;  ///< rad/m, largest change of the roll per metre of travel
  /// Largest second-order estimate of the error of a joint-space step, rad (docs/model.md).
  std::optional<double> step_error;
  /// Largest distance of the tool from its path between layers, m.
  std::optional<double> tool_path_error = 0.001;
  /// Largest angle of the tool from its path between layers, rad.
  std::optional<double> tool_angle_error;
  /// Speed of the tool at which every step must be possible, m/s.
  std::optional<double> tool_speed;
  /// Speed at which the tool must be able to turn on every step, rad/s.
  std::optional<double> tool_turn_speed;
  EdgeMode edges = EdgeMode::kContinuous;
  /// d_edge: least distance on motions, m; unset: half of the nodes'.
  std::optional<double> edge_clearance;
  /// h: how finely clearance of motions is proved, m (docs/model.md).
  double edge_tolerance = 0.0005;
  // Joint rates that motions in time keep, instead of those of the robot model: rad/s, rad/s^2,
  // rad/s^3, with m for rad of a slide, base to tip.
  std::optional<std::array<double, kDof>> joint_speed, joint_acceleration, joint_jerk;
  /// Returns the least distance of the robot from the scene on motions, m.
  [[nodiscard]] double d_edge() const { return edge_clearance.value_or(clearance / 2); }
  /// Returns the least distance between the robot's own bodies at nodes, m.
  [[nodiscard]] double d_self() const { return self_clearance.value_or(clearance); }
  /// Returns the least distance between the robot's own bodies on motions, m.
  [[nodiscard]] double d_self_edge() const { return edge_clearance.value_or(d_self() / 2); }
  bool operator==(const Limits&) const = default;
};

/// What Resolution::knot is unless it is set, m: of arms without an arm angle, and of S-R-S arms.
inline constexpr double kKnotOfArcs = 0.06, kKnotOfGrids = 0.1;
/// What Resolution::arc is unless it is set, rad (m of a slide): with nodes at knots, and with
/// nodes at every layer.
inline constexpr double kArcOfKnots = 0.07, kArcOfLayers = 0.175;

/// How fine the lattice is.
struct Resolution {
  double ds = 0.005;    ///< largest distance between layers, m
  double dphi = 0.05;   ///< largest step of the arm angle, rad
  double dalpha = 0.1;  ///< largest tool rotation between layers, rad
  /// Self-motion between nodes, rad (m of a slide), of arms without an arm angle; unset:
  /// kArcOfKnots, kArcOfLayers.
  std::optional<double> arc;
  /// For S-R-S arms: adds nodes on the arcs of allowed arm angles that lie between grid angles.
  bool arcs = false;
  double droll = 0.1;  ///< largest step of the roll of seven-joint arms, rad
  /// Length of path between the layers that have nodes, m. 0: every layer has; unset: kKnotOfArcs,
  /// or kKnotOfGrids.
  std::optional<double> knot;
  /// Returns the length of path between knots of arms without an arm angle, m, as it is in effect.
  [[nodiscard]] double knot_of_arcs() const { return knot.value_or(kKnotOfArcs); }
  /// Returns that of S-R-S arms.
  [[nodiscard]] double knot_of_grids() const { return knot.value_or(kKnotOfGrids); }
  /// Returns the self-motion between nodes of arms without an arm angle, as it is in effect.
  [[nodiscard]] double arc_of_nodes() const {
    return arc.value_or(knot_of_arcs() > 0 ? kArcOfKnots : kArcOfLayers);
  }
  bool operator==(const Resolution&) const = default;
};

/// What a path costs.
struct Cost {
  CostMetric metric = CostMetric::kL2;
  /// Weights of the joints from base to tip: each 0, or 1e-6 to 1e6. If they are not set, each
  /// joint has 1, and the roll of a six-joint arm has 0 (joint_weights()).
  std::optional<std::array<double, kDof>> weights;
  double roll = 0;  ///< per metre of path and rad of roll: 0, or 1e-6 to 1e6
  bool operator==(const Cost&) const = default;
};

/// Random offsets of one scene object in the episodes of a campaign: each is uniform within plus or
/// minus these half-widths, m and rad. docs/formats.md.
struct Variation {
  std::string object;
  Vector3d xyz = Vector3d::Zero();
  Vector3d rpy = Vector3d::Zero();
};

/// The arm that is planned for: a chain of a robot model, and what it carries.
struct Robot {
  std::shared_ptr<const RobotModel> model;  // shared: every episode and planner reads it
  std::string base_link, tip_link;
  Pose tool = Pose::Identity();  ///< tool frame in tip_link
  /// By name: positions, rad or m, of joints of the model outside the chain.
  std::map<std::string, double> hold;
  std::vector<AttachedBody> attached;
  /// The allowed range of the roll, where the tool may turn about its z axis. To an arm of six
  /// joints the roll is the seventh joint, last in every list of joints, without a speed of its
  /// own, and by default without a weight: turning the tool costs nothing. For an S-R-S
  /// arm of seven joints the roll is chosen besides the arm angle (knot_grid.hpp).
  std::optional<Roll> roll;
};

/// What the tool must do, and within which limits.
struct Task {
  /// Frame of the waypoints: base_link (or empty) or a scene object's name.
  std::string path_frame;
  std::vector<Waypoint> waypoints;      ///< in path_frame
  std::optional<PathSmoothing> smooth;  ///< unset: the tool follows the polyline
  Resolution resolution;
  Limits limits;
  /// For a seven-joint arm with a roll: the roll at each layer, rad, once it has been chosen;
  /// empty: it has yet to be chosen.
  std::vector<double> rolls;
  std::optional<Config> start;  ///< joint positions at which the path must begin, rad
  /// Arc length, m from the first waypoint, at which `start` stands: layers begin there. Only with
  /// `start`; unset: the begin of the path.
  std::optional<double> start_at;
  /// How far the tool at `start` may be from the path, m and rad. A start within 1e-6 of the path
  /// counts as on it; else the first layer takes the tool pose of the start, and the first step
  /// leads from there to the path's next layer.
  double start_tolerance = 1e-6;
  /// Joint positions in which the path must end, rad: the tool is then at the last waypoint. A
  /// joint without limits, or of over 64 turns, may end whole turns away if `start` is given too.
  std::optional<Config> end;
  /// Whether the path must end in the joints in which it begins, so that it can be repeated: the
  /// last waypoint must then be the pose of the first, to 1e-6 m and rad. A joint without limits
  /// may end whole turns away. `start` and `end` must be unset, or both given and equal.
  bool closed = false;
  Cost cost;
  Refinement refinement;
  /// Into how many steps the way from each waypoint to the next is cut, instead of what the
  /// resolution says: every waypoint is a layer then. Empty: as the resolution says.
  std::vector<int> steps;
  bool operator==(const Task&) const = default;
};

/// Everything that a problem file says, with the files it names loaded. Poses are in base_link
/// unless said otherwise. Source: io::load_path_problem.
struct PathProblem : Robot, Task {
  std::string source;  ///< problem file, for messages
  std::vector<SceneObject> scene;
  std::vector<Variation> vary;
};

/// Returns true if a path is the tool's position and z axis alone: the tool may be turned about its
/// z axis by any angle, at no cost.
[[nodiscard]] bool axis_alone(const PathProblem& problem);

/// Returns the waypoints in base_link: path_frame applied, quaternions normalised. If axis_alone(),
/// only the z axes of the orientations are those given: the others are carried along them
/// (axis_frames.hpp). The last pose of a closed path is the first one, bit for bit, but for the
/// turn about its z axis if axis_alone(). Throws InputError for an unknown path_frame,
/// fewer than two waypoints, a number that is not finite, a quaternion whose length is off 1 by
/// more than 1e-3, or the ends of a closed path that are not one pose with one range of the roll.
[[nodiscard]] std::vector<Waypoint> waypoints_in_base(const PathProblem& problem);
/// Returns waypoints_in_base() with the orientations as the problem gives them. Throws as that
/// does.
[[nodiscard]] std::vector<Waypoint> given_waypoints_in_base(const PathProblem& problem);

}  // namespace swivel
