// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/collision/world.hpp"
#include "swivel/core/lattice.hpp"

namespace swivel {

/// How much the clearance of two bodies may differ where a lattice knows the poses of bodies only so well.
class RowMargin {
 public:
  RowMargin(const Lattice& lattice, const World& world);
  /// Between the joints q of a node and its row (Lattice::row_shift), m; 0 where nodes are their own rows, infinite where nothing
  /// is known.
  [[nodiscard]] double from_node(int layer, const Config& q, const BodyPair& pair) const;
  /// The same, between rows of nodes at which the bodies stand alike (Lattice::rows_apart).
  [[nodiscard]] double between_rows(int layer, const Config& q, const BodyPair& pair) const;

 private:
  template <class Shift>
  [[nodiscard]] double sum(const BodyPair& pair, const Shift& shift) const;

  const Lattice* lattice_;
  struct Body {
    int group = 0;
    double radius = 0;  ///< m, of its farthest point from where PoseShift is about
  };
  std::vector<Body> bodies_;  // of the robot; empty where nodes are their own rows
};

}  // namespace swivel
