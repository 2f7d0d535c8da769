// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <vector>

#include "swivel/core/arm_class.hpp"
#include "swivel/core/budget.hpp"
#include "swivel/core/lattice.hpp"
#include "swivel/core/plan.hpp"

namespace swivel {

/// The lattice of a problem's path for an arm of this class: a grid of arm angles (SrsLattice), of rolls and arm angles where the
/// tool may turn (RollLattice), or arcs of self-motion (ArcLattice).
/// Throws as the lattices do; Stopped. The arguments but the problem and the budget must outlive it.
[[nodiscard]] std::unique_ptr<Lattice> make_lattice(const Chain& chain, const ArmClass& arm, const ToolPath& path,
                                                    const Problem& problem, const Budget& budget = {});

/// The joints of the rows of a path, one slot in each layer from the first on: continuous joints go on without jumps. Empty where
/// the lattice takes bounded joints of more than a turn as circles and their values leave the limits along this path.
[[nodiscard]] std::vector<Config> path_joints(const Lattice& lattice, const std::vector<int>& slots);

/// The same with what a trajectory says of each row; and with the rows at the layers of the tool's path that lie between those of
/// the lattice (Lattice::has_layers_between).
[[nodiscard]] std::vector<TrajectoryRow> path_rows(const Lattice& lattice, const std::vector<int>& slots);

/// Where path_joints() is empty: the same nodes with the values of those joints told apart, in which paths of such joints stay
/// within their limits.
[[nodiscard]] std::unique_ptr<Lattice> with_windings_for(const Lattice& lattice, const std::vector<int>& slots);

}  // namespace swivel
