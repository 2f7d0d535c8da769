// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/base/types.hpp"

namespace swivel {

/// Rz(yaw) Ry(pitch) Rx(roll) of the angles (roll, pitch, yaw), rad.
[[nodiscard]] inline Quaterniond from_rpy(const Vector3d& rpy) {
  return Eigen::AngleAxisd(rpy.z(), Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Vector3d::UnitX());
}

/// The rotation that a problem file has which says these angles.
[[nodiscard]] inline Matrix3d rotation_from_rpy(const Vector3d& rpy) {
  return from_rpy(rpy).normalized().toRotationMatrix();
}

}  // namespace swivel
