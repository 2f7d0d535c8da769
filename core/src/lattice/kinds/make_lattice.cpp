// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/kinds/make_lattice.hpp"

#include <algorithm>

#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/lattice/kinds/knot_grid.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

namespace {

/// Returns the length of path between knots of an S-R-S arm, m; 0 if every layer has nodes. A grid
/// of arm angles alone has them for an estimate of the step error, which is one of moves between
/// neighbouring layers, and for nodes besides on arcs.
double knot_of_srs(const Resolution& resolution, const PathProblem& of) {
  const bool all_layers = of.limits.step_error || resolution.arcs;
  return all_layers && !of.roll ? 0 : resolution.knot_of_grids();
}

}  // namespace

std::unique_ptr<Lattice> make_lattice(const Chain& chain, const ArmClass& arm, const ToolPath& path,
                                      const PathProblem& problem, const Budget& budget) {
  if (path.closed() && chain.free_roll)
    throw InputError(problem.source,
                     "path.closed: is not supported yet for arms of seven joints whose roll is "
                     "free: allowed is path.roll left out, or path.closed");
  if (chain.free_roll && !path.unturned())
    return KnotGrid::make(chain, *arm.srs, path, problem, budget, std::nullopt, true);
  if (arm.kind == ArmKind::kSrs && !chain.free_roll && knot_of_srs(problem.resolution, problem) > 0)
    return KnotGrid::make(chain, *arm.srs, path, problem, budget, std::nullopt, true);
  if (arm.kind == ArmKind::kSrs)
    return std::make_unique<SrsLattice>(
        chain, *arm.srs, path, problem, budget, std::vector<ArmPlane>(), std::nullopt,
        SrsLattice::possible_circles(chain, *arm.srs, path, problem));
  if (problem.limits.arm_slope != Limits().arm_slope)
    throw InputError(problem.source,
                     "limits.arm_slope: the arm has no arm angle, since it is not S-R-S: allowed "
                     "is to leave it out");
  return std::make_unique<ArcLattice>(chain, arm.lock, path, problem, budget);
}

PathProblem on_all_layers(PathProblem problem, const ArmClass& arm) {
  if (!arm.srs || !problem.roll) problem.resolution.knot = 0;
  return problem;
}

Resolution resolution_in_effect(Resolution resolution, const PathProblem& of, const ArmClass& arm) {
  if (arm.srs) {
    resolution.arc.reset();
    resolution.knot = knot_of_srs(resolution, of);
  } else {
    resolution.arc = resolution.arc_of_nodes();
    resolution.knot = arm.redundant ? resolution.knot_of_arcs() : 0;
  }
  return resolution;
}

std::optional<double> last_joint_at_rest(const Chain& chain, const ArmClass& arm,
                                         const PathProblem& problem) {
  // If the roll has a cost, turning joint 7 may be cheaper than resting it.
  if (!arm.srs || !arm.srs->coaxial || problem.start || problem.end || !problem.rolls.empty() ||
      problem.cost.roll > 0)
    return std::nullopt;
  const JointLimit& limit = chain.limit.back();
  if (limit.continuous) return 0.0;
  return limit.wide() ? std::clamp(0.0, limit.lower, limit.upper) : (limit.lower + limit.upper) / 2;
}

std::unique_ptr<Lattice> make_coaxial_lattice(const Chain& chain, const ArmClass& arm,
                                              const ToolPath& path, const PathProblem& problem,
                                              const Budget& budget) {
  if (path.closed()) return nullptr;
  const auto rest = last_joint_at_rest(chain, arm, problem);
  return rest ? KnotGrid::make(chain, *arm.srs, path, problem, budget, rest, true) : nullptr;
}

}  // namespace swivel
