// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <numbers>

namespace swivel {

/// Joints of the planned arm. Arms of six joints count the tool's roll as the seventh.
inline constexpr int kDof = 7;
inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2 * std::numbers::pi;

/// Joint positions of the arm, radians, base to tip.
using Config = Eigen::Matrix<double, kDof, 1>;
/// A rigid transform, lengths in m; X_AB is the pose of frame B in frame A.
using Pose = Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Returns the product A B. Faster than Eigen's, which multiplies the constant last rows too.
inline Pose product(const Pose& A, const Pose& B) {
  const Eigen::Matrix4d &a = A.matrix(), &b = B.matrix();
  Pose C;
  for (int j = 0; j < 4; ++j)
    C.matrix().col(j) = b(0, j) * a.col(0) + b(1, j) * a.col(1) + b(2, j) * a.col(2);
  C.matrix().col(3) += a.col(3);
  return C;
}

}  // namespace swivel
