// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <numbers>

#include "swivel/core/base/config.hpp"

namespace swivel {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2 * std::numbers::pi;

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
