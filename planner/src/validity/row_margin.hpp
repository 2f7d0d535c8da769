// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/lazy.hpp"
#include "swivel/core/lattice/lattice.hpp"

namespace swivel {

/// How much the clearance of two bodies may differ where a lattice knows the poses of bodies only so well. The bodies are measured
/// when this is first asked: most plans whose paths meet no obstacle never ask. Threads may ask at once.
class RowMargin {
 public:
  RowMargin(const Lattice& lattice, const World& world) : lattice_(&lattice), world_(&world) {}
  /// Between the joints q of a node and its row (Lattice::row_shift), m; 0 where nodes are their own rows, infinite where nothing
  /// is known.
  [[nodiscard]] double from_node(int layer, const Config& q, const BodyPair& pair) const;
  /// The same, between rows of nodes at which the bodies stand alike (Lattice::rows_apart).
  [[nodiscard]] double between_rows(int layer, const Config& q, const BodyPair& pair) const;

 private:
  template <class Shift>
  [[nodiscard]] double sum(const BodyPair& pair, const Shift& shift) const;

  struct Body {
    int group = 0;
    double radius = 0;  ///< m, of its farthest point from where PoseShift is about
  };
  [[nodiscard]] std::vector<Body> measured() const;

  const Lattice* lattice_;
  const World* world_;
  Lazy<std::vector<Body>> bodies_;  // of the robot; empty where nodes are their own rows
};

}  // namespace swivel
