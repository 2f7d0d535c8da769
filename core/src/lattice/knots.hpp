// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/base/config.hpp"

namespace swivel {

class ToolPath;

/// How far knots are apart at most. Knots are the layers of a path that have nodes, of a lattice
/// that has layers between (Lattice::has_layers_between()).
struct KnotSpacing {
  double length = 0;      ///< m of the path; 0: every layer is a knot
  double angle = 0;       ///< rad that the tool turns
  bool at_bends = false;  ///< whether every layer at which the path bends is a knot
};

/// Returns the knots of a path, the first and the last layer among them, spread evenly over each
/// stretch between two that must be knots.
[[nodiscard]] std::vector<int> knots_along(const ToolPath& path, const KnotSpacing& most);

/// Returns the largest move of each joint from knot to knot, rad: the sums of those of the path's
/// steps, which are one for all steps or one for each.
[[nodiscard]] std::vector<Config> bounds_between_knots(const std::vector<int>& knots,
                                                       const std::vector<Config>& of_steps);

}  // namespace swivel
