// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/motion/redundancy.hpp"
#include "swivel/core/motion/smooth_path.hpp"

namespace swivel {

/// Returns paths through the basins of the cost of an S-R-S arm, each with a row at each layer: the
/// optima, by Newton's method over every few layers (about 30 mm apart), to which locally cheapest
/// paths of a lattice over these layers lead, in each IK solution by itself. Between these layers
/// the arm angle changes straight. Limits of joints are kept at these layers; obstacles are not
/// looked at. Only paths that cost less than `to_beat` are returned, by what they cost over these
/// layers, the cheapest first. None where there are more than 64 IK solutions. `lattice` is that of
/// the redundancy. Deterministic. Throws Stopped.
[[nodiscard]] std::vector<std::vector<TrajectoryRow>> basin_seeds(const SrsLattice& lattice,
                                                                  const Redundancy& redundancy,
                                                                  const SmoothObjective& objective,
                                                                  double to_beat,
                                                                  const Budget& budget);

}  // namespace swivel
