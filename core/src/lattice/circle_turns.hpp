// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/lattice/lattice.hpp"

namespace swivel {

/// How the rows of a path fit into the limits of joints that a lattice treats as circles.
struct CircleTurns {
  /// The whole turns, rad, by joint, that take the rows into the limits; 0 for joints that
  /// do not fit and for joints that are no circles.
  Config turn = Config::Zero();
  /// By how much each circle leaves its limits in every turn that is allowed, at least, rad, by
  /// joint; infinite for one that does not reach the turn of a given end. 0 for joints that keep
  /// them.
  Config over = Config::Zero();
  [[nodiscard]] bool fit() const { return (over.array() == 0).all(); }
  /// Returns the joint that is furthest over its limits, the first of two as far; none if fit().
  [[nodiscard]] Lattice::Joints furthest_over() const;
};

/// Returns the turns of circles along rows that do not jump, from layer 0 of the lattice on. Of
/// several turns in which all rows are within the limits less the joint margin, the one counts in
/// which the first row is nearest to the middle of the range, and of two as near the lower one. A
/// given start leaves no choice, nor does a given end if the rows lead to the last layer; rows that
/// begin at the start must also reach the end in its own turn.
[[nodiscard]] CircleTurns circle_turns(const Lattice& lattice, const Lattice::Joints& circles,
                                       const std::vector<Config>& rows, bool starts_given,
                                       const Config* end);

}  // namespace swivel
