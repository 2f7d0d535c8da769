// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/kinds/make_lattice.hpp"

#include <algorithm>

#include "kinematics/newton/pose_newton.hpp"
#include "lattice/given_posture.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/lattice/kinds/knot_grid.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

std::unique_ptr<Lattice> make_lattice(const Chain& chain, const ArmClass& arm, const ToolPath& path,
                                      const PathProblem& problem, const Budget& budget) {
  if (path.closed() && chain.free_roll)
    throw InputError(problem.source,
                     "path.closed: is not supported yet for arms of seven joints whose roll is "
                     "free: allowed is path.roll left out, or path.closed");
  if (chain.free_roll && !path.unturned())
    return KnotGrid::make(chain, *arm.srs, path, problem, budget, std::nullopt, true);
  // The estimate of the step error is that of a move between neighbouring layers.
  if (arm.kind == ArmKind::kSrs && !chain.free_roll &&
      problem.resolution.knot_of_grids(false) > 0 && !problem.limits.step_error)
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
    resolution.knot = of.limits.step_error ? 0 : resolution.knot_of_grids(of.roll.has_value());
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

namespace {

/// Returns whether a start, carried along the path, comes beside a singular pose, as
/// make_lattice_past_singularity() describes.
bool leads_past_singularity(const Chain& chain, const SrsArm& arm, const ToolPath& path,
                            const PathProblem& problem, const Budget& budget) {
  constexpr int kSteps = 6;
  constexpr double kFast = 15;      // rad of a joint for each rad of the arm angle
  constexpr double kLittle = 1e-6;  // rad of self-motion
  const auto inside = [&](const Config& q) {
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain.limit[j];
      const double x = q[static_cast<Eigen::Index>(j)], margin = problem.limits.joint_margin;
      if (!limit.continuous && !(x >= limit.lower + margin && x <= limit.upper - margin))
        return false;
    }
    return true;
  };
  const std::vector<ArmPlane> planes = carried_planes(arm, path, budget);
  const PoseNewton newton(chain);
  Config q = joints_given(PathEnd::kFirst, problem, chain, path);
  for (int i = 1; i < path.size(); ++i) {
    const auto next = newton.nearest(q, path.layer(i).tool, Config::Ones(), kSteps);
    if (!next || !inside(next->q) ||
        !((next->q - q).cwiseAbs().maxCoeff() <= problem.limits.joint_step))
      return false;
    q = next->q;
    const ArmPlane& plane = planes[static_cast<std::size_t>(i)];
    const double turned =
        wrap_angle(arm_angle(arm, plane, q + kLittle * next->tangent) - arm_angle(arm, plane, q));
    if (kLittle * next->tangent.cwiseAbs().maxCoeff() > kFast * std::abs(turned)) return true;
  }
  return false;
}

}  // namespace

std::unique_ptr<Lattice> make_lattice_past_singularity(const Chain& chain, const ArmClass& arm,
                                                       const ToolPath& path,
                                                       const PathProblem& problem,
                                                       const Budget& budget) {
  if (!arm.srs || chain.free_roll || !problem.start || problem.limits.step_error ||
      problem.limits.arm_slope != Limits().arm_slope || path.closed() ||
      !leads_past_singularity(chain, *arm.srs, path, problem, budget))
    return nullptr;
  return std::make_unique<ArcLattice>(chain, lock_method(chain), path, problem, budget, &*arm.srs);
}

}  // namespace swivel
