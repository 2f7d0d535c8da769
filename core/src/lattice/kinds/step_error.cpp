// SPDX-License-Identifier: BSD-3-Clause
#include <limits>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"

namespace swivel {

double step_error(const SrsLattice& lattice, int layer, int end, int branch, double phi,
                  double dphi) {
  // Step of the finite differences, of the step parameter; truncation and rounding both stay below
  // 1e-6 of the value.
  constexpr double kStep = 1e-3;
  const SrsArm& arm = lattice.arm();
  const ArmPlane& plane = lattice.plane(layer + end);
  const auto joints = [&](double t, double angle) -> std::optional<Config> {
    const Pose tool = lattice.path().at(layer, end + t);
    const ArmPlane carried = carry_plane(arm, plane, tool);
    if (reach_status(arm, carried.reach) != ReachStatus::kReachable) return std::nullopt;
    return srs_ik(arm, elbow_circles(arm, carried, tool), angle, branch);
  };
  const auto center = joints(0, phi);
  const auto ahead = joints(kStep, phi + kStep * dphi), behind = joints(-kStep, phi - kStep * dphi);
  const auto s_ahead = joints(kStep, phi), s_behind = joints(-kStep, phi),
             phi_ahead = joints(0, phi + kStep), phi_behind = joints(0, phi - kStep);
  if (!center || !ahead || !behind || !s_ahead || !s_behind || !phi_ahead || !phi_behind)
    return std::numeric_limits<double>::infinity();
  const auto difference = [](const Config& a, const Config& b) {
    Config d = a - b;
    for (int k = 0; k < kDof; ++k) d[k] = wrap_angle(d[k]);
    return d;
  };
  Config second = (difference(*ahead, *center) - difference(*center, *behind)) / (kStep * kStep);
  // Remove the part in the tangent plane spanned by theta_s and theta_phi (Gram-Schmidt).
  Config t1 = difference(*s_ahead, *s_behind), t2 = difference(*phi_ahead, *phi_behind);
  if (joint_norm(t1) > 0) {
    t1 /= joint_norm(t1);
    second -= joint_dot(second, t1) * t1;
    t2 -= joint_dot(t2, t1) * t1;
  }
  if (joint_norm(t2) > 1e-12) {
    t2 /= joint_norm(t2);
    second -= joint_dot(second, t2) * t2;
  }
  return 0.5 * joint_norm(second);
}

}  // namespace swivel
