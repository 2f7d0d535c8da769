// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/base/types.hpp"

namespace swivel {

/// Returns the rotation Rz(yaw) Ry(pitch) Rx(roll) for angles (roll, pitch, yaw), rad: roll, pitch
/// and yaw about fixed axes, as in a URDF.
[[nodiscard]] inline Quaterniond from_rpy(const Vector3d& rpy) {
  return Eigen::AngleAxisd(rpy.z(), Vector3d::UnitZ()) *
         Eigen::AngleAxisd(rpy.y(), Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Vector3d::UnitX());
}

/// Returns the rotation matrix that loading a problem file with these angles (roll, pitch, yaw),
/// rad, gives, bit for bit: the quaternion of from_rpy(), normalised.
[[nodiscard]] inline Matrix3d rotation_from_rpy(const Vector3d& rpy) {
  return from_rpy(rpy).normalized().toRotationMatrix();
}

}  // namespace swivel
