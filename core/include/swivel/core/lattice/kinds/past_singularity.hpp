// SPDX-License-Identifier: BSD-3-Clause
// Paths of S-R-S arms whose given start leads past a singular pose of the shoulder or of the wrist.
// Joints move fast there for each rad of the arm angle, so that a grid of arm angles may have no
// node where the arm stands, or only paths that are dear. The start is carried along the path by
// Newton steps of least norm, within the limits of the joints.
#pragma once
#include <limits>
#include <memory>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"

namespace swivel {

struct ArmClass;

/// Returns whether the given start of an S-R-S arm, carried from layer to layer as long as moves
/// keep joint_step, comes where a joint moves by more than 15 rad for each rad of the arm angle.
/// False for other arms, paths without a start, closed ones, a tool that may turn, and with
/// limits.step_error or an arm_slope that is not the default. Throws InputError and Stopped.
[[nodiscard]] bool leads_past_singularity(const Chain& chain, const ArmClass& arm,
                                          const ToolPath& path, const PathProblem& problem,
                                          const Budget& budget = {});

/// A start that is carried to the end of a path, over a 32nd of it at a time.
struct CarriedStart {
  /// By the metric, and on from the last layer to a given end; infinity where there is none.
  double cost = std::numeric_limits<double>::infinity();
  std::vector<Config> joints;  ///< on the way, rad
};

/// Returns the given start of an S-R-S arm carried along the path of its grid `grid`: none where
/// the joints leave their limits, or if no joint moves by more than 5 rad for each rad of the arm
/// angle; none also for arms and paths for which leads_past_singularity() is always false. Throws
/// as that.
[[nodiscard]] CarriedStart carried_past_singularity(const Lattice& grid, const ArmClass& arm,
                                                    const PathProblem& problem,
                                                    const Budget& budget = {});

/// Returns arcs of self-motion (ArcLattice) of an S-R-S arm, whose rows have branches and arm
/// angles of such arms. Arguments must outlive it. Throws InputError and Stopped.
[[nodiscard]] std::unique_ptr<Lattice> make_srs_arcs(const Chain& chain, const ArmClass& arm,
                                                     const ToolPath& path,
                                                     const PathProblem& problem,
                                                     const Budget& budget = {});

}  // namespace swivel
