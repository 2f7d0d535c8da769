// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"

namespace swivel {

struct ArmClass;

/// Returns the lattice of a problem's path for an arm of class `arm`: of an S-R-S arm a grid of arm
/// angles, and of rolls if the tool may turn, at knots (KnotGrid), or of arm angles at every layer
/// (SrsLattice) with a `resolution.knot` of 0 or `limits.step_error`, whose estimate is of moves
/// between neighbouring layers; of others arcs of self-motion (ArcLattice). Throws InputError where
/// the lattice does, also for limits.arm_slope with an arm that has no arm angle; Stopped. `chain`,
/// `arm` and `path` must outlive the lattice.
[[nodiscard]] std::unique_ptr<Lattice> make_lattice(const Chain& chain, const ArmClass& arm,
                                                    const ToolPath& path,
                                                    const PathProblem& problem,
                                                    const Budget& budget = {});

/// Returns a problem whose lattice has nodes at every layer, unless the arm is S-R-S and its roll
/// free: that of a stroke in several runs or of an arm of two, whose search cannot halve steps
/// between knots, or of a path whose states cost something by the caller's hook (StateCost).
[[nodiscard]] PathProblem on_all_layers(PathProblem problem, const ArmClass& arm);
/// Returns a resolution of the lattice of a path for a record: `knot` and `arc` as they are in
/// effect, and no `arc` with an arm angle. `of`: says what else the lattice is of.
[[nodiscard]] Resolution resolution_in_effect(Resolution resolution, const PathProblem& of,
                                              const ArmClass& arm);

/// Returns where joint 7 may rest, rad, if the tool of an S-R-S arm may turn freely about the axis
/// of that joint: as far from its limits as possible. The other six joints alone then put the tool
/// where it has to be, so that a path along which joint 7 moves costs no less than the same path
/// with joint 7 at rest. Returns nothing for other arms and tools, and for a problem with a start,
/// an end, given rolls or a cost of the roll.
[[nodiscard]] std::optional<double> last_joint_at_rest(const Chain& chain, const ArmClass& arm,
                                                       const PathProblem& problem);

/// Returns a lattice of arm angles alone with joint 7 at last_joint_at_rest(); null if that returns
/// nothing. No path of make_lattice() costs less, by its joints, than the cheapest path of this
/// lattice. But what the bodies of the tool collide with depends on where joint 7 rests: if there
/// is no path here, make_lattice() may still have one. Arguments and exceptions as for
/// make_lattice().
[[nodiscard]] std::unique_ptr<Lattice> make_coaxial_lattice(const Chain& chain, const ArmClass& arm,
                                                            const ToolPath& path,
                                                            const PathProblem& problem,
                                                            const Budget& budget = {});

/// Returns by how much the tool stands turned about its own z axis at a row, rad.
[[nodiscard]] inline double roll_of(const Chain& chain, const TrajectoryRow& row) {
  return chain.roll ? row.q[kDof - 1] : row.roll;
}

}  // namespace swivel
