// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/graph/verdicts/parallel_for.hpp"

namespace swivel {

/// Lower bounds of the cost from layer 0 to the nodes of every stride-th layer and of the last. An
/// edge costs a norm of the joints' move, so a path between two layers costs at least the norm of
/// the chord between its ends. A dynamic program over chords alone, with the window of a stride's
/// steps and any change of IK solution, therefore bounds every path's cost from below, and needs
/// the joints of one layer a stride. It runs in single precision, less what that may lose. Memory:
/// one byte a lattice node, or less.
class ChordLowerBound {
 public:
  /// Computes the bounds. Throws Stopped.
  explicit ChordLowerBound(const SrsLattice& lattice, const Budget& budget = {},
                           const ParallelFor& work = {});

  /// Returns the least bound over the last layer: infinite where some layer stops every path, and
  /// no bound where costs exceed single precision.
  [[nodiscard]] double best() const { return best_; }
  /// Returns the bounds of a layer, [slot]; null where it has none.
  [[nodiscard]] const float* row(int layer) const;
  [[nodiscard]] std::int64_t ik_nodes() const { return ik_nodes_; }

 private:
  int stride_ = 1, last_ = 0, width_ = 0;
  double best_ = 0;
  std::vector<float> rows_;  // [coarse layer][slot]
  std::int64_t ik_nodes_ = 0;
};

}  // namespace swivel
