// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice/kinds/past_singularity.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "kinematics/newton/pose_newton.hpp"
#include "lattice/given_posture.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"

namespace swivel {

namespace {

bool may_lead_past(const ArmClass& arm, bool free_roll, const PathProblem& problem) {
  return arm.srs && !free_roll && problem.start && !problem.closed && !problem.limits.step_error &&
         problem.limits.arm_slope == Limits().arm_slope;
}

/// Carries the start of a problem along its path, from one layer to the one that is `stride` layers
/// ahead, or the last, by Newton steps of least norm. Calls visit(before, point, layer) there, with
/// the joints at the layer before and the point of the self-motion reached, until that returns
/// false. Returns whether the last layer was visited: false also where the joints leave their
/// limits or move by more than joint_step for each layer.
template <class Visit>
bool carry_start(const Chain& chain, const ToolPath& path, const PathProblem& problem, int stride,
                 const Visit& visit) {
  constexpr int kSteps = 6;
  const auto inside = [&](const Config& q) {
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain.limit[j];
      const double x = q[static_cast<Eigen::Index>(j)], margin = problem.limits.joint_margin;
      if (!limit.continuous && !(x >= limit.lower + margin && x <= limit.upper - margin))
        return false;
    }
    return true;
  };
  const PoseNewton newton(chain);
  Config q = joints_given(PathEnd::kFirst, problem, chain, path);
  for (int layer = 0; layer + 1 < path.size();) {
    const int next = std::min(layer + stride, path.size() - 1);
    const auto point = newton.nearest(q, path.layer(next).tool, Config::Ones(), kSteps);
    const double most = problem.limits.joint_step * (next - layer);
    if (!point || !inside(point->q) || !((point->q - q).cwiseAbs().maxCoeff() <= most) ||
        !visit(q, *point, next))
      return false;
    q = point->q;
    layer = next;
  }
  return true;
}

/// Returns whether a joint moves by more than `rate` rad for each rad of the arm angle.
bool is_fast(const SrsArm& arm, const ArmPlane& plane, const PoseNewton::Point& point,
             double rate) {
  constexpr double kLittle = 1e-6;  // rad of self-motion
  const double turned = wrap_angle(arm_angle(arm, plane, point.q + kLittle * point.tangent) -
                                   arm_angle(arm, plane, point.q));
  return kLittle * point.tangent.cwiseAbs().maxCoeff() > rate * std::abs(turned);
}

}  // namespace

bool leads_past_singularity(const Chain& chain, const ArmClass& arm, const ToolPath& path,
                            const PathProblem& problem, const Budget& budget) {
  constexpr double kFast = 15;
  if (!may_lead_past(arm, chain.free_roll.has_value(), problem)) return false;
  const std::vector<ArmPlane> planes = carried_planes(*arm.srs, path, budget);
  bool fast = false;
  carry_start(chain, path, problem, 1,
              [&](const Config&, const PoseNewton::Point& point, int layer) {
                fast = is_fast(*arm.srs, planes[static_cast<std::size_t>(layer)], point, kFast);
                return !fast;
              });
  return fast;
}

CarriedStart carried_past_singularity(const Lattice& grid, const ArmClass& arm,
                                      const PathProblem& problem, const Budget& budget) {
  constexpr double kFast = 5;
  constexpr int kVisits = 32;
  const Chain& chain = grid.chain();
  const ToolPath& path = grid.path_of_rows();
  if (!may_lead_past(arm, chain.free_roll.has_value(), problem)) return {};
  const std::vector<ArmPlane> planes = carried_planes(*arm.srs, path, budget);
  CarriedStart carried{0, {}};
  bool fast = false;
  const auto visit = [&](const Config& before, const PoseNewton::Point& point, int layer) {
    carried.cost += grid.edge_cost(grid.delta(before, point.q));
    carried.joints.push_back(point.q);
    fast = fast || is_fast(*arm.srs, planes[static_cast<std::size_t>(layer)], point, kFast);
    return true;
  };
  if (!carry_start(chain, path, problem, 1 + path.size() / kVisits, visit) || !fast) return {};
  if (problem.end)
    carried.cost += grid.edge_cost(
        grid.delta(carried.joints.back(), joints_given(PathEnd::kLast, problem, chain, path)));
  return carried;
}

std::unique_ptr<Lattice> make_srs_arcs(const Chain& chain, const ArmClass& arm,
                                       const ToolPath& path, const PathProblem& problem,
                                       const Budget& budget) {
  return std::make_unique<ArcLattice>(chain, lock_method(chain), path, problem, budget, &*arm.srs);
}

}  // namespace swivel
