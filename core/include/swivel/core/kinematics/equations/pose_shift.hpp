// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// A bound on how far apart two poses of one body are: it is turned by at most `turn` (rad), and its point that is at `about` at
/// q = 0 (base frame, m) is moved by at most `shift` (m), infinite where nothing is known.
struct PoseShift {
  Vector3d about = Vector3d::Zero();
  double turn = 0, shift = 0;
  /// Of any point of the body that is no further from `about`, m.
  [[nodiscard]] double of(double radius) const { return shift + turn * radius; }
  [[nodiscard]] static PoseShift unknown(const Vector3d& about) { return {about, 0, std::numeric_limits<double>::infinity()}; }
};

}  // namespace swivel
