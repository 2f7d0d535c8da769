// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/kinematics/chain/arm.hpp"

namespace swivel {

/// Where the outer axes of a triple are one line, so that they swing against each other while the middle one stands: a singular
/// pose of a spherical shoulder or wrist.
struct Alignment {
  int joint;     ///< the middle one, 0-based
  double angle;  ///< rad, its value there

  /// "shoulder", "elbow" or "wrist".
  [[nodiscard]] const char* where() const;
  /// rad, of the joint from there.
  [[nodiscard]] double away(const Config& q) const;
};
/// Of three neighbouring axes that meet in a point, and of the three before or behind three parallel ones.
[[nodiscard]] std::vector<Alignment> alignments_of(const Chain& chain);

}  // namespace swivel
