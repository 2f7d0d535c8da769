// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// A bound on how far apart two poses of one body are: they differ by a turn of at most `turn`
/// (rad), and the body's point that is at `about` at q = 0 (base frame, m) moves by at most `shift`
/// (m), infinite where nothing is known.
struct PoseErrorBound {
  Vector3d about = Vector3d::Zero();
  double turn = 0, shift = 0;
  /// Returns a bound, m, on how far a point of the body moves that is at most `radius` m from
  /// `about`.
  [[nodiscard]] double of(double radius) const { return shift + turn * radius; }
  /// Returns the bound that says nothing, about a point (base frame, q = 0, m).
  [[nodiscard]] static PoseErrorBound unknown(const Vector3d& about) {
    return {about, 0, std::numeric_limits<double>::infinity()};
  }
};

}  // namespace swivel
