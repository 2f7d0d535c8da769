// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/kinematics/chain/arm.hpp"

namespace swivel {

/// A joint angle at which the axes on both sides of the joint are one line (or, where three
/// parallel axes follow or precede, have one direction), so that they swing against each other
/// while this joint stands: a singular pose of a spherical shoulder or wrist, or of the elbow.
struct Alignment {
  int joint;     ///< the joint between the two axes, 0-based
  double angle;  ///< its angle there, rad

  /// Returns which part of the arm it is: "shoulder", "elbow" or "wrist".
  [[nodiscard]] const char* where() const;
  /// Returns how far the joint is from the alignment in q, in [0, pi] rad.
  [[nodiscard]] double away(const Config& q) const;
};
/// Returns the alignments of every three neighbouring axes that meet in a point, and of the three
/// axes before or behind three parallel ones.
[[nodiscard]] std::vector<Alignment> alignments_of(const Chain& chain);

}  // namespace swivel
