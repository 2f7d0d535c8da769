// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// The angle less its nearest number of whole turns, in [-pi, pi]; half turns round away from zero, as the vector sweep computes
/// it.
[[nodiscard]] inline double wrap_angle(double angle) {
  const double turns = angle / kTwoPi;
  return angle - kTwoPi * std::copysign(std::floor(std::abs(turns) + 0.5), turns);
}

}  // namespace swivel
