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

/// The lattice of a problem's path for an arm of this class: a grid of arm angles (SrsLattice), of
/// rolls and arm angles where the tool may turn (RollLattice), or arcs of self-motion (ArcLattice).
/// Throws as the lattices do; Stopped. The arguments but the problem and the budget must outlive
/// it.
[[nodiscard]] std::unique_ptr<Lattice> make_lattice(const Chain& chain, const ArmClass& arm,
                                                    const ToolPath& path, const Problem& problem,
                                                    const Budget& budget = {});

/// Where joint 7 stays, rad, of an S-R-S arm whose tool may turn by any roll about that joint's own
/// axis, without a start: as far from its limits as it can. The other six joints alone put the tool
/// where it has to be, so that a path along which joint 7 moves costs no less than the same with
/// joint 7 at rest.
[[nodiscard]] std::optional<double> last_joint_at_rest(const Chain& chain, const ArmClass& arm,
                                                       const Problem& problem);

/// The lattice of such an arm with joint 7 at rest, of arm angles alone; else null. No path of
/// make_lattice() is cheaper than its cheapest one by the joints; but what the tool's bodies meet
/// hangs on where joint 7 rests: where there is no path here, there may be one there. Arguments and
/// what is thrown as there.
[[nodiscard]] std::unique_ptr<Lattice> make_coaxial_lattice(const Chain& chain, const ArmClass& arm,
                                                            const ToolPath& path,
                                                            const Problem& problem,
                                                            const Budget& budget = {});

/// By how much the tool stands turned at a row, rad.
[[nodiscard]] inline double roll_of(const Chain& chain, const TrajectoryRow& row) {
  return chain.roll ? row.q[kDof - 1] : row.roll;
}

}  // namespace swivel
