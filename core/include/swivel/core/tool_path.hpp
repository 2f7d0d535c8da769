// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "swivel/core/budget.hpp"
#include "swivel/core/problem.hpp"
#include "swivel/core/types.hpp"

namespace swivel {

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

 private:
  std::vector<PathLayer> layers_;
  int merged_ = 0;
};

}  // namespace swivel
