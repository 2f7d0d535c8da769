// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <set>
#include <vector>

#include "swivel/core/base/config.hpp"

namespace swivel {

class ToolPath;

/// Returns the knots of a path: the layers that have nodes, of a lattice that has layers between
/// (Lattice::has_layers_between()). They are at most `length`, m of the path, and 0.2 rad of
/// rotation apart, spread evenly over each stretch between two that must be knots: the first and
/// the last layer, and those at which the path bends. With a length of 0 every layer is a knot.
[[nodiscard]] std::vector<int> knots_along(const ToolPath& path, double length);

/// Returns the layer of a path, between two others, that is nearest to the middle of the way
/// between them.
[[nodiscard]] int middle_layer(const ToolPath& path, int first, int last);
/// Returns knots with one more in the middle of each of some steps, given by the number of the knot
/// at which they begin; steps without layers between are left out.
[[nodiscard]] std::vector<int> halved(const ToolPath& path, const std::vector<int>& knots,
                                      const std::set<int>& steps);

/// Returns the largest move of each joint from knot to knot, rad: the sums of those of the path's
/// steps, which are one for all steps or one for each.
[[nodiscard]] std::vector<Config> bounds_between_knots(const std::vector<int>& knots,
                                                       const std::vector<Config>& of_steps);

}  // namespace swivel
