// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>

#include "kinematics/srs/exact_chain_turned.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

namespace {

/// Returns v turned about a unit axis by the angle with that cosine and sine (Rodrigues).
Vector3d turned(const Vector3d& v, const Vector3d& axis, double cosine, double sine) {
  return cosine * v + sine * axis.cross(v) + (1 - cosine) * axis.dot(v) * axis;
}

/// Returns the rotation vector of a rotation matrix, rad: exact above a quarter turn; below it the
/// axis times the sine of the angle, whose error is of the third order in the angle.
Vector3d rotation_vector(const Matrix3d& R) {
  if (R.trace() < 1) {
    const Eigen::AngleAxisd turn(R);
    return turn.angle() * turn.axis();
  }
  return 0.5 * Vector3d(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
}

/// Solves the seven equations J x = e, rows (J e), by elimination with the largest pivot of each
/// column: a third of the time of a general decomposition.
Config solved(std::array<std::array<double, kDof + 1>, kDof>& rows) {
  constexpr std::size_t n = kDof;
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(rows[i][k]) > std::abs(rows[pivot][k])) pivot = i;
    if (pivot != k) std::swap(rows[pivot], rows[k]);
    const double inverse = 1 / rows[k][k];
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = rows[i][k] * inverse;
      for (std::size_t j = k + 1; j <= n; ++j) rows[i][j] -= factor * rows[k][j];
    }
  }
  Config x;
  for (std::size_t k = n; k-- > 0;) {
    double rest = rows[k][n];
    for (std::size_t j = k + 1; j < n; ++j) rest -= rows[k][j] * x[static_cast<Eigen::Index>(j)];
    x[static_cast<Eigen::Index>(k)] = rest / rows[k][k];
  }
  return x;
}

}  // namespace

std::optional<Config> solve_exact_chain(const Chain& chain, const SrsArm& arm,
                                        const ArmPlane& plane, const Pose& tool, double phi,
                                        const Config& seed) {
  if (arm.exact) return seed;
  constexpr int kSteps = 5;
  constexpr double kResidual = 1e-10;
  // After a step this short Newton leaves its square times second derivatives below 1,000: less
  // than the residual.
  constexpr double kLastStep = 1e-7, kLeastSine = 0.1;
  const auto near_seed = [&](const Config& q) {
    return (q - seed).lpNorm<Eigen::Infinity>() > kMostCorrection ? std::nullopt : std::optional(q);
  };
  const Vector3d ur = plane.u.cross(plane.r);
  Config q = seed;
  for (int step = 0; step <= kSteps; ++step) {
    const auto G = chain.displacements(q);
    const Pose reached = G[kDof] * chain.home;
    // Direction of axis 4 of the fitted arm, and the fitted axes that turn it.
    const double c0 = std::cos(q[0]), s0 = std::sin(q[0]), c1 = std::cos(q[1]), s1 = std::sin(q[1]);
    const auto by_two = [&](const Vector3d& v) {
      return turned(turned(v, arm.axis[1], c1, s1), arm.axis[0], c0, s0);
    };
    const Vector3d h = by_two(turned(arm.axis[3], arm.axis[2], std::cos(q[2]), std::sin(q[2])));
    const double x = h.dot(plane.r), y = h.dot(ur);
    Eigen::Matrix<double, 7, 1> error;
    error.head<3>() = tool.translation() - reached.translation();
    error.segment<3>(3) = rotation_vector(tool.linear() * reached.linear().transpose());
    error[6] = std::remainder(phi - std::atan2(y, x), kTwoPi);
    if (!error.allFinite()) return std::nullopt;
    if (error.lpNorm<Eigen::Infinity>() <= kResidual) return near_seed(q);
    if (step == kSteps) break;
    std::array<std::array<double, kDof + 1>, kDof> rows{};
    for (std::size_t k = 0; k < kDof; ++k) {
      const Vector3d a = G[k].linear() * chain.axis[k];
      const Vector3d v = a.cross(reached.translation() - G[k] * chain.point[k]);
      for (std::size_t i = 0; i < 3; ++i) {
        rows[i][k] = v[static_cast<Eigen::Index>(i)];
        rows[i + 3][k] = a[static_cast<Eigen::Index>(i)];
      }
      rows[k][kDof] = error[static_cast<Eigen::Index>(k)];
    }
    // d(angle)/dq_k through dh = a_k x h.
    const Vector3d normal = (x * ur - y * plane.r) / (x * x + y * y);
    rows[6][0] = arm.axis[0].cross(h).dot(normal);
    rows[6][1] = turned(arm.axis[1], arm.axis[0], c0, s0).cross(h).dot(normal);
    rows[6][2] = by_two(arm.axis[2]).cross(h).dot(normal);
    const Config change = solved(rows);
    q += change;
    if (change.lpNorm<Eigen::Infinity>() <= kLastStep && x * x + y * y >= kLeastSine * kLeastSine)
      return near_seed(q);
  }
  return std::nullopt;
}

Config measure_fit_error(const Chain& chain, const SrsArm& arm) {
  constexpr int kPostures = 400;
  constexpr double kLeastSine = 0.1;
  std::mt19937_64 engine(1);
  // gives the same numbers with every standard library
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1.0p-53);
  };
  Config fit_error = Config::Zero();
  for (int posture = 0; posture < kPostures; ++posture) {
    Config q;
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain.limit[j];
      const bool turns = limit.continuous || limit.wide();
      q[static_cast<Eigen::Index>(j)] =
          turns ? uniform(-kPi, kPi) : uniform(limit.lower, limit.upper);
    }
    const double least_sine =
        std::min({std::abs(std::sin(arm.shoulder_angle(q))), std::abs(std::sin(arm.elbow_angle(q))),
                  std::abs(std::sin(arm.wrist_angle(q)))});
    const Pose tool = chain.tool(q);
    const ArmPlane plane = first_plane(arm, tool);
    if (least_sine < kLeastSine || reach_status(arm, plane.reach) != ReachStatus::kReachable)
      continue;
    const double phi = plane.angle_of(arm.elbow_axis(q));
    Config apart = srs_ik(arm, elbow_circles(arm, plane, tool), phi, arm.branch(q)) - q;
    for (double& joint : apart.coordinates()) joint = std::abs(wrap_angle(joint));
    if (apart.maxCoeff() <= kMostCorrection) fit_error = fit_error.cwiseMax(apart);
  }
  return fit_error;
}

std::optional<Config> solve_exact_chain_turned(const Chain& chain, const SrsArm& arm,
                                               const ArmPlane& plane, const Pose& tool, double phi,
                                               const Config& seed) {
  const Pose turned = rolled(tool, roll_between(tool, chain.tool(seed)));
  return solve_exact_chain(chain, arm, carry_plane(arm, plane, turned), turned, phi, seed);
}

}  // namespace swivel
