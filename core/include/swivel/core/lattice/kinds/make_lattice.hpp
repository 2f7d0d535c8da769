// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/lattice.hpp"

namespace swivel {

/// The lattice of a problem's path for an arm of this class: a grid of arm angles (SrsLattice), of rolls and arm angles where the
/// tool may turn (RollLattice), or arcs of self-motion (ArcLattice).
/// Throws as the lattices do; Stopped. The arguments but the problem and the budget must outlive it.
[[nodiscard]] std::unique_ptr<Lattice> make_lattice(const Chain& chain, const ArmClass& arm, const ToolPath& path,
                                                    const Problem& problem, const Budget& budget = {});

/// Where joint 7 stays, rad, of an S-R-S arm whose tool may turn by any roll about that joint's own axis, without a start: as far
/// from its limits as it can. The other six joints alone put the tool where it has to be, so that a path along which joint 7 moves
/// costs no less than the same with joint 7 at rest.
[[nodiscard]] std::optional<double> last_joint_at_rest(const Chain& chain, const ArmClass& arm, const Problem& problem);

/// The lattice of such an arm with joint 7 at rest, of arm angles alone; else null. No path of make_lattice() is cheaper than its
/// cheapest one by the joints; but what the tool's bodies meet hangs on where joint 7 rests: where there is no path here, there may
/// be one there. Arguments and what is thrown as there.
[[nodiscard]] std::unique_ptr<Lattice> make_coaxial_lattice(const Chain& chain, const ArmClass& arm, const ToolPath& path,
                                                            const Problem& problem, const Budget& budget = {});

/// The joints of the rows of a path, one slot in each layer from the first on: continuous joints go on without jumps. Empty where
/// the lattice takes bounded joints of more than a turn as circles and their values leave the limits along this path.
[[nodiscard]] std::vector<Config> path_joints(const Lattice& lattice, const std::vector<int>& slots);

/// Whether the joints of a path keep their limits where each joint that the lattice takes as a circle begins in the turn nearest to
/// the middle of its range. Such a path, where it is the best of the lattice, is the answer.
[[nodiscard]] bool keeps_nearest_turns(const Lattice& lattice, const std::vector<int>& slots);

/// What path_joints() returns, with what a trajectory says of each row; and with the rows at the layers of the tool's path that lie
/// between those of the lattice (Lattice::has_layers_between).
[[nodiscard]] std::vector<TrajectoryRow> path_rows(const Lattice& lattice, const std::vector<int>& slots);

/// By how much the tool stands turned at a row, rad.
[[nodiscard]] inline double roll_of(const Chain& chain, const TrajectoryRow& row) {
  return chain.roll ? row.q[kDof - 1] : row.roll;
}

/// Where not keeps_nearest_turns(): the same nodes with the values of those joints told apart, so that each value is a node within
/// the limits.
[[nodiscard]] std::unique_ptr<Lattice> with_windings_for(const Lattice& lattice, const std::vector<int>& slots);

}  // namespace swivel
