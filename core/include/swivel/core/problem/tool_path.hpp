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
#include "swivel/core/problem/problem.hpp"

namespace swivel {

class CubicSpline;

/// One layer of the lattice: a tool pose on the path, and the straight step from it to the next layer.
struct PathLayer {
  double s = 0;                               ///< arc length from the first waypoint, m; may repeat where the path only turns
  Pose tool = Pose::Identity();               ///< tool in base
  int waypoint = -1;                          ///< 0-based row of the path where this layer is a corner or an end, else -1
  double step_length = 0;                     ///< m to the next layer
  double step_angle = 0;                      ///< rad to the next layer
  Vector3d step_rotation = Vector3d::Zero();  ///< axis * angle of that step, in the tool frame of this layer
  double travel = 0;  ///< m, like s, but going on where the path turns: a segment counts max(length, angle ds / dalpha)
  /// Within which the roll must lie here (Waypoint::roll), rad; between layers its ends are linear in travel.
  Roll window{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

  [[nodiscard]] bool in_window(double roll, double tolerance = 1e-9) const {
    return roll >= window.lower - tolerance && roll <= window.upper + tolerance;
  }
};

/// Waypoints cut into layers: position linear, orientation slerp on the short arc; every waypoint at which the path bends is a
/// layer, so corners are never cut. A waypoint within 5e-7 (m and rad) of the straight segment through its neighbours is none: the
/// same line has the same layers, whatever number of waypoints it is written with. Waypoints with windows of the roll all are
/// layers. docs/model.md "Tool path"; paper Eq. (1)-(4).
///
/// With smoothing the tool follows a curve instead, twice continuously differentiable in `travel`: about each corner the velocity
/// (of position and of rotation, per metre of travel) goes from the one, a, to the other, b, by a + (b - a) (3 z^2 - 2 z^3), z from
/// 0 to 1 over `reach` on both sides. That leaves the polyline by at most 3/16 reach |b - a|. s, layers and steps are those of the
/// polyline; only the poses differ.
class ToolPath {
 public:
  /// `turns_freely`: the tool may stand turned about its z axis as it likes, so that a half turn about that axis is the
  /// right-handed one. Throws InputError: fewer than two distinct waypoints, another turn of 180 deg between neighbours, more
  /// layers than fit in memory. Throws Stopped.
  ToolPath(const std::vector<Waypoint>& waypoints, const Resolution& resolution, const std::string& source,
           const Budget& budget = {}, const std::optional<PathSmoothing>& smooth = {}, bool turns_freely = false);

  [[nodiscard]] int size() const { return static_cast<int>(layers_.size()); }
  [[nodiscard]] const PathLayer& layer(int i) const { return layers_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] int merged_waypoints() const { return merged_; }
  /// Rows of the first and the last waypoint whose travel lies within from ... to, layers or not; -1 both where there is none.
  [[nodiscard]] std::array<int, 2> waypoints_along(double from, double to) const;
  /// Tool pose at step parameter t of the step that starts at layer i; t in [0, 1] lies on the path, beyond that the step's own
  /// motion continued (what a one-sided derivative at a corner needs).
  [[nodiscard]] Pose at(int i, double t) const;

  /// Leaves the path from s = `start_at` on, m; where it only turns there, from where it first comes nearest to `tool`. That place
  /// is layer 0: the whole path's own layer where one lies within 1e-6 of it, m and rad. A tool that is further than that from its
  /// pose, but at most `tolerance`, takes its place. Without `start_at` layer 0 is the path's first. Throws InputError where
  /// nothing is left.
  void begin_at(std::optional<double> start_at, const Pose& tool, double tolerance, const std::string& source);
  /// Cuts off the layers after this one, which is not layer 0.
  void end_at(int layer) { layers_.resize(static_cast<std::size_t>(layer) + 1); }
  /// Poses of the layers that begin_at() has cut off: arm angles are carried along the whole path.
  [[nodiscard]] const std::vector<Pose>& before() const { return before_; }
  /// False where layer 0 is none of the whole path's.
  [[nodiscard]] bool begins_on_layer() const { return begins_on_layer_; }
  /// Where velocities jump: the tool must stop there unless the curve rounds the corner.
  struct Corner {
    int layer = 0;
    double reach = 0;                ///< m of travel on both sides over which it is rounded; 0: it is not
    double position = 0, angle = 0;  ///< m and rad, how far the curve leaves the polyline
  };
  /// Some of its layers, in order, and steps from each to the next that are as long as those between them together. Poses between
  /// layers are not this path's.
  [[nodiscard]] ToolPath with_layers(const std::vector<int>& kept) const;
  /// The same path for a tool that stands turned about its own z axis: by so much at each layer, rad, and between layers by the
  /// natural cubic spline through that over the travel.
  [[nodiscard]] ToolPath with_rolls(const std::vector<double>& rolls) const;
  /// Of such a path: the one that it is made of; else null.
  [[nodiscard]] const ToolPath* unturned() const { return unturned_.get(); }
  /// By how much the tool may be turned from the polyline where corners are rounded, rad: so may rolls leave windows, which have
  /// corners at waypoints as well.
  [[nodiscard]] double rounding() const { return rounding_; }
  /// The length of path that belongs to each layer, m: half of the steps on both sides.
  [[nodiscard]] std::vector<double> shares() const;
  /// PathLayer::window at a travel.
  [[nodiscard]] Roll window_at(double travel) const;
  /// By how much the tool stands turned, rad.
  [[nodiscard]] double roll_at(double travel) const;
  /// In the order of the path.
  [[nodiscard]] const std::vector<Corner>& corners() const { return corners_; }
  /// The step on which a travel lies: its layer; the first or last one for what is beyond the ends.
  [[nodiscard]] int step_at(double travel) const;
  /// Tool pose at a travel.
  [[nodiscard]] Pose at_travel(double travel) const;

 private:
  /// From a waypoint to the next.
  struct Segment {
    int layer = 0;  // the first
    double travel = 0;
    Pose start = Pose::Identity();
    Vector3d velocity = Vector3d::Zero(), rotation = Vector3d::Zero();  // per metre of travel; rotation in the tool's frame
    double reach = 0;                                                   // of the corner at its start
    bool merged = false;                                                // of several, within the tolerances of smoothing
  };
  /// Where a waypoint lies on the path.
  struct Place {
    double travel = 0;
    int row = 0;
  };
  void find_corners(const PathSmoothing& smooth);
  void spread_windows();
  [[nodiscard]] Pose on_curve(std::size_t segment, double travel) const;
  [[nodiscard]] std::size_t segment_of(int step) const;

  std::vector<PathLayer> layers_;
  std::shared_ptr<const ToolPath> unturned_;  // of a path for a tool that is turned
  std::shared_ptr<const CubicSpline> roll_;
  std::vector<Pose> before_;
  bool begins_on_layer_ = true;
  bool begins_aside_ = false;  // layer 0 is off the curve
  std::vector<Segment> segments_;
  std::vector<Place> waypoints_;  // but for repeated ones
  std::vector<Corner> corners_;
  bool rounded_ = false;
  double rounding_ = 0;
  int merged_ = 0;
};

/// A pose turned about its own z axis, rad.
[[nodiscard]] Pose rolled(const Pose& pose, double roll);
/// The turn about the z axis of a pose that comes nearest to another, rad.
[[nodiscard]] double roll_between(const Pose& pose, const Pose& tool);

}  // namespace swivel
