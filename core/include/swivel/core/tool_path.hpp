// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/budget.hpp"
#include "swivel/core/problem.hpp"
#include "swivel/core/types.hpp"

namespace swivel {

struct Chain;

/// One layer of the lattice: a tool pose on the path, and the straight step from it to the next layer.
struct PathLayer {
  double s = 0;                               ///< arc length from the first waypoint, m; may repeat where the path only turns
  Pose tool = Pose::Identity();               ///< tool in base
  int waypoint = -1;                          ///< 0-based row of the path where this layer is one, else -1
  double step_length = 0;                     ///< m to the next layer
  double step_angle = 0;                      ///< rad to the next layer
  Vector3d step_rotation = Vector3d::Zero();  ///< axis * angle of that step, in the tool frame of this layer
};

/// Waypoints cut into layers: position linear, orientation slerp on the short arc; every waypoint is a layer, so corners are never
/// cut. docs/model.md "Tool path"; paper Eq. (1)-(4).
class ToolPath {
 public:
  /// Throws InputError: fewer than two distinct waypoints, a turn of 180 deg between neighbours, more layers than fit in memory.
  /// Throws Stopped.
  ToolPath(const std::vector<Waypoint>& waypoints, const Resolution& resolution, const std::string& source,
           const Budget& budget = {});

  [[nodiscard]] int size() const { return static_cast<int>(layers_.size()); }
  [[nodiscard]] const PathLayer& layer(int i) const { return layers_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] int merged_waypoints() const { return merged_; }
  /// Tool pose at step parameter t of the step that starts at layer i; t in [0, 1] lies on the path, beyond that the step's own
  /// motion continued (what a one-sided derivative at a corner needs).
  [[nodiscard]] Pose at(int i, double t) const;

  /// Leaves the path from s = `start_at` on, m; where it only turns there, from where it first comes nearest to `tool`. That place
  /// is layer 0: the whole path's own layer where one lies within 1e-6 of it, m and rad. A tool that is further than that from its
  /// pose, but at most `tolerance`, takes its place. Without `start_at` layer 0 is the path's first. Throws InputError where
  /// nothing is left.
  void begin_at(std::optional<double> start_at, const Pose& tool, double tolerance, const std::string& source);
  /// Poses of the layers that begin_at() has cut off: arm angles are carried along the whole path.
  [[nodiscard]] const std::vector<Pose>& before() const { return before_; }
  /// False where layer 0 is none of the whole path's.
  [[nodiscard]] bool begins_on_layer() const { return begins_on_layer_; }

 private:
  std::vector<PathLayer> layers_;
  std::vector<Pose> before_;
  bool begins_on_layer_ = true;
  int merged_ = 0;
};

/// The layers of a problem: of its whole path, or from its start on. Throws InputError as ToolPath does, and for a start_at beyond
/// the path. Throws Stopped.
[[nodiscard]] ToolPath problem_path(const Problem& problem, const Chain& chain, const Budget& budget = {});

}  // namespace swivel
