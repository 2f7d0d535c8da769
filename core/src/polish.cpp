// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>
#include <cmath>

#include "swivel/core/srs.hpp"

namespace swivel {

std::optional<Config> polish(const Chain& chain, const SrsArm& arm, const ArmPlane& plane, const Pose& tool, double phi,
                             const Config& seed) {
  if (arm.exact) return seed;
  constexpr int kSteps = 5;
  constexpr double kResidual = 1e-10, kLargestMove = 0.05;
  const Vector3d ur = plane.u.cross(plane.r);
  Config q = seed;
  for (int step = 0; step <= kSteps; ++step) {
    const auto G = chain.displacements(q);
    const Pose reached = G[kDof] * chain.home;
    const Eigen::AngleAxisd turn(tool.linear() * reached.linear().transpose());
    const Vector3d h = arm.elbow_axis(q);
    const double x = h.dot(plane.r), y = h.dot(ur);
    Eigen::Matrix<double, 7, 1> error;
    error.head<3>() = tool.translation() - reached.translation();
    error.segment<3>(3) = turn.angle() * turn.axis();
    error[6] = std::remainder(phi - std::atan2(y, x), kTwoPi);
    if (!error.allFinite()) return std::nullopt;
    if (error.lpNorm<Eigen::Infinity>() <= kResidual) {
      if ((q - seed).lpNorm<Eigen::Infinity>() > kLargestMove) return std::nullopt;
      return q;
    }
    if (step == kSteps) break;
    Eigen::Matrix<double, 7, 7> J;
    Matrix3d fitted = Matrix3d::Identity();  // turn of the fitted shoulder before joint k
    for (std::size_t k = 0; k < kDof; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      const Vector3d a = G[k].linear() * chain.axis[k];
      J.block<3, 1>(0, column) = a.cross(reached.translation() - G[k] * chain.point[k]);
      J.block<3, 1>(3, column) = a;
      J(6, column) = 0;
      if (k < 3) {  // d(angle)/dq_k through dh = a_k x h
        const Vector3d dh = (fitted * arm.axis[k]).cross(h);
        J(6, column) = (x * dh.dot(ur) - y * dh.dot(plane.r)) / (x * x + y * y);
        fitted = fitted * Eigen::AngleAxisd(q[column], arm.axis[k]).toRotationMatrix();
      }
    }
    q += J.partialPivLu().solve(error);
  }
  return std::nullopt;
}

}  // namespace swivel
