// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/lazy.hpp"
#include "swivel/core/lattice/lattice.hpp"

namespace swivel {

/// Bounds how much the clearance of two bodies may differ between configurations that a lattice
/// treats as placing them equally. The bodies are measured when this is first asked, because most
/// plans whose paths meet no obstacle never ask. Safe to call from many threads.
class ClearanceError {
 public:
  ClearanceError(const Lattice& lattice, const World& world) : lattice_(&lattice), world_(&world) {}
  /// Returns an upper bound, m, of how much the clearance of a pair may differ between the joints q
  /// of a node and the node's exact configuration (Lattice::pose_error_of_node). 0 if nodes are
  /// exact configurations themselves, infinite if nothing is known.
  [[nodiscard]] double from_node(int layer, const Config& q, const BodyPair& pair) const;
  /// Returns an upper bound, m, of how much the clearance of a pair may differ between the exact
  /// configurations of two nodes at which its bodies have the same poses
  /// (Lattice::pose_error_between). `q` holds the joints of either node. 0 if nodes are exact
  /// configurations themselves, infinite if nothing is known.
  [[nodiscard]] double between_exact_configs(int layer, const Config& q,
                                             const BodyPair& pair) const;

 private:
  template <class Shift>
  [[nodiscard]] double sum(const BodyPair& pair, const Shift& shift) const;

  struct Body {
    int group = 0;
    double radius = 0;  ///< m, from the centre of its PoseErrorBound to its farthest point
  };
  [[nodiscard]] std::vector<Body> measured() const;

  const Lattice* lattice_;
  const World* world_;
  // of the robot; empty if nodes are exact configurations themselves
  Lazy<std::vector<Body>> bodies_;
};

}  // namespace swivel
