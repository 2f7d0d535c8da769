// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

class CubicSpline;

/// One layer of the lattice: a tool pose on the path, and the straight step from it to the next
/// layer.
struct PathLayer {
  /// Arc length from the first waypoint, m; may repeat where the path only turns.
  double s = 0;
  Pose tool = Pose::Identity();  ///< tool in base
  /// Index of the waypoint where this layer is a corner or an end of the path, else -1.
  int waypoint = -1;
  double step_length = 0;  ///< distance to the next layer, m
  double step_angle = 0;   ///< rotation to the next layer, rad
  /// Axis * angle (rad) of that rotation, in the tool frame of this layer.
  Vector3d step_rotation = Vector3d::Zero();
  /// Travel, m: like s, but it goes on where the path only turns: a segment counts max(length,
  /// angle ds / dalpha).
  double travel = 0;
  /// The range in which the roll must lie here (Waypoint::roll), rad; between layers its ends are
  /// linear in travel.
  Roll window{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

  /// Returns true if a roll, rad, is in the window, to a tolerance.
  [[nodiscard]] bool in_window(double roll, double tolerance = 1e-9) const {
    return roll >= window.lower - tolerance && roll <= window.upper + tolerance;
  }
};

/// A tool path cut into layers: linear in position, slerp on the short arc in orientation. Every
/// waypoint at which the path bends is a layer, so that corners are never cut. A waypoint within
/// 5e-7 (m and rad) of the straight segment through its neighbours is merged into it: one line has
/// the same layers, whatever number of waypoints it is written with. Waypoints with windows of the
/// roll are all layers. docs/model.md "Tool path"; paper Eq. (1)-(4).
///
/// With smoothing the tool follows a curve instead that is twice continuously differentiable in
/// `travel`: about each corner the velocity (of position and of rotation, per metre of travel) goes
/// from one, a, to the other, b, by a + (b - a) (3 z^2 - 2 z^3), z from 0 to 1 over `reach` on both
/// sides. The curve leaves the polyline by at most 3/16 reach |b - a|. s, layers and steps are
/// those of the polyline; only the poses differ.
class ToolPath {
 public:
  /// Cuts waypoints, in the base frame, into layers. `source` is the file for messages; `smooth`
  /// rounds corners. With `turns_freely` the tool may be turned about its z axis without bounds, so
  /// that a half turn about that axis is the right-handed one. `steps`, unless it is empty, has for
  /// each waypoint but the last the number of steps to the next, whatever the resolution; no
  /// waypoint is merged then. Throws InputError for fewer than two distinct waypoints, for
  /// neighbours that are one pose where `steps` are given, another turn of 180 deg between
  /// neighbours, or more layers than fit in memory. Throws Stopped.
  ToolPath(const std::vector<Waypoint>& waypoints, const Resolution& resolution,
           const std::string& source, const Budget& budget = {},
           const std::optional<PathSmoothing>& smooth = {}, bool turns_freely = false,
           const std::vector<int>& steps = {});

  /// Returns the number of layers.
  [[nodiscard]] int size() const { return static_cast<int>(layers_.size()); }
  /// Returns layer i, from 0.
  [[nodiscard]] const PathLayer& layer(int i) const { return layers_[static_cast<std::size_t>(i)]; }
  /// Returns how many waypoints were merged into straight segments.
  [[nodiscard]] int merged_waypoints() const { return merged_; }
  /// Returns the indices of the first and the last waypoint, layers or not, whose travel lies
  /// within from ... to (m); -1 both where there is none.
  [[nodiscard]] std::array<int, 2> waypoints_along(double from, double to) const;
  /// Returns the tool pose at parameter t of the step that starts at layer i. For t in [0, 1] it
  /// lies on the path; beyond, the step's own motion is continued, as a one-sided derivative at a
  /// corner needs.
  [[nodiscard]] Pose at(int i, double t) const;

  /// Keeps the path from s = `start_at` (m) on; where the path only turns there, from where it
  /// first comes nearest to the pose `tool`. That place becomes layer 0, or the path's own layer if
  /// one is within 1e-6 (m and rad). A tool that is further than that from its pose, but at most
  /// `tolerance` (m and rad), takes its place. Without `start_at` layer 0 stays the path's first.
  /// Throws InputError where nothing is left.
  void begin_at(std::optional<double> start_at, const Pose& tool, double tolerance,
                const std::string& source);
  /// Cuts off the layers after `layer`, which must not be layer 0.
  void end_at(int layer) {
    ends_early_ = ends_early_ || layer + 1 < size();
    layers_.resize(static_cast<std::size_t>(layer) + 1);
  }
  /// Returns true if end_at() has cut off layers, so that the last layer is not the path's end.
  [[nodiscard]] bool ends_early() const { return ends_early_; }
  /// Notes that the motion along the path must end in the joints in which it begins (Task::closed).
  /// The last layer's position and z axis must be those of layer 0. Where it stands turned about
  /// its z axis from there, as frames that are carried along an axis do (axis_frames.hpp), the
  /// layers are turned back about theirs, each by the share of the travel up to it, so that the
  /// last pose is the first, bit for bit.
  void close();
  /// Notes by which angle about its z axis (rad, by index) each waypoint as the problem gives it
  /// stands turned from the frame that the path was made with (carry_frames()).
  void set_waypoint_turns(const std::vector<double>& angles);
  /// Returns the angle, rad, about the tool's z axis from the path's pose at a travel (m) to the
  /// waypoints' own, from which rows count the roll: linear in travel from waypoint to waypoint,
  /// the short way (a half turn right-handed). 0 without set_waypoint_turns().
  [[nodiscard]] double waypoint_turn(double travel) const;
  /// Returns true if waypoint_turn() is not 0 everywhere.
  [[nodiscard]] bool has_waypoint_turns() const { return turned_waypoints_; }
  /// Returns true if close() has been called, and the last layer is the path's end.
  [[nodiscard]] bool closed() const { return closed_ && !ends_early_; }
  /// Returns the poses of the layers that begin_at() has cut off: arm angles are carried along the
  /// whole path.
  [[nodiscard]] const std::vector<Pose>& before() const { return before_; }
  /// Returns false if layer 0 is not a layer of the whole path.
  [[nodiscard]] bool begins_on_layer() const { return begins_on_layer_; }
  /// A corner, where velocities jump: the tool must stop there unless the curve rounds it.
  struct Corner {
    int layer = 0;
    /// Travel on both sides over which it is rounded, m; 0: it is not.
    double reach = 0;
    double position = 0, angle = 0;  ///< how far the curve leaves the polyline, m and rad
  };
  /// Returns a path of some of the layers, in order, each step as long as those that it replaces
  /// together. Poses between layers are not this path's.
  [[nodiscard]] ToolPath with_layers(const std::vector<int>& kept) const;
  /// Returns this path for a tool that is turned about its own z axis: by a roll at each layer,
  /// rad, and between layers by the natural cubic spline through these over the travel.
  [[nodiscard]] ToolPath with_rolls(const std::vector<double>& rolls) const;
  /// Returns the path that with_rolls() was called on; null for a path that it did not make.
  [[nodiscard]] const ToolPath* unturned() const { return unturned_.get(); }
  /// Returns by how much the tool may be turned from the polyline where corners are rounded, rad.
  /// Rolls may leave their windows by as much, since windows have corners at waypoints as well.
  [[nodiscard]] double rounding() const { return rounding_; }
  /// Returns the length of path that belongs to each layer, m: half of the steps on both sides.
  [[nodiscard]] std::vector<double> shares() const;
  /// Returns the range of the roll at a travel (m), rad, as PathLayer::window.
  [[nodiscard]] Roll window_at(double travel) const;
  /// Returns the roll by which the tool is turned at a travel (m), rad.
  [[nodiscard]] double roll_at(double travel) const;
  /// Returns the corners, in the order of the path.
  [[nodiscard]] const std::vector<Corner>& corners() const { return corners_; }
  /// Returns the layer at which the step begins on which a travel (m) lies; the first or last step
  /// for what is beyond the ends.
  [[nodiscard]] int step_at(double travel) const;
  /// Returns the tool pose at a travel, m.
  [[nodiscard]] Pose at_travel(double travel) const;

 private:
  /// A segment of the path, from a waypoint to the next.
  struct Segment {
    int layer = 0;  // the first
    double travel = 0;
    Pose start = Pose::Identity();
    // per metre of travel; rotation in the tool's frame
    Vector3d velocity = Vector3d::Zero(), rotation = Vector3d::Zero();
    // of the corner at its start
    double reach = 0;
    // of several, within the tolerances of smoothing
    bool merged = false;
  };
  /// Where a waypoint lies on the path.
  struct Place {
    double travel = 0;
    int row = 0;
    double turn = 0;  // waypoint_turn()
  };
  void find_corners(const PathSmoothing& smooth);
  void spread_windows();
  [[nodiscard]] Pose on_curve(std::size_t segment, double travel) const;
  /// Returns a pose of the path before close() as it is after.
  [[nodiscard]] Pose twisted(const Pose& pose, double travel) const;
  [[nodiscard]] std::size_t segment_of(int step) const;

  std::vector<PathLayer> layers_;
  std::shared_ptr<const ToolPath> unturned_;  // for a tool that is turned
  std::shared_ptr<const CubicSpline> roll_;
  std::vector<Pose> before_;
  bool begins_on_layer_ = true;
  bool begins_aside_ = false;  // layer 0 is off the curve
  bool ends_early_ = false;
  bool closed_ = false;
  bool turned_waypoints_ = false;
  double twist_ = 0;  // by how much close() turned the tool about its z axis, rad per m of travel
  std::vector<Segment> segments_;
  std::vector<Place> waypoints_;  // without repeated ones
  std::vector<Corner> corners_;
  bool rounded_ = false;
  double rounding_ = 0;
  int merged_ = 0;
};

/// Returns into how many steps a resolution cuts the way from each waypoint, in the base frame, to
/// the next: at least one. Throws InputError for another turn of 180 deg between neighbours than
/// `turns_freely` allows (ToolPath), or for more layers than fit in memory.
[[nodiscard]] std::vector<int> steps_between(const std::vector<Waypoint>& waypoints,
                                             const Resolution& resolution,
                                             const std::string& source, bool turns_freely = false);

/// Returns a pose turned about its own z axis by a roll, rad.
[[nodiscard]] Pose rolled(const Pose& pose, double roll);
/// Returns the roll, rad, that turns `pose` about its own z axis as near to `tool` as such a turn
/// can.
[[nodiscard]] double roll_between(const Pose& pose, const Pose& tool);

}  // namespace swivel
