// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "swivel/core/base/types.hpp"

namespace swivel {

inline constexpr double kDegrees = 180 / kPi;  ///< degrees in a radian

/// Returns the angle, rad, less its nearest whole number of turns: a value in [-pi, pi]. An odd
/// multiple of pi rounds away from zero (pi gives -pi), as in the vector kernels, so that both
/// agree bit for bit.
[[nodiscard]] inline double wrap_angle(double angle) {
  const double turns = angle / kTwoPi;
  return angle - kTwoPi * std::copysign(std::floor(std::abs(turns) + 0.5), turns);
}

}  // namespace swivel
