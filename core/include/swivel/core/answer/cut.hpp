// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "swivel/core/answer/cause.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// A certificate that a problem has no path at its resolution: nodes and edges of some neighbouring layers, each removed by a
/// witness, without which nothing leads through these layers. check_cut() verifies it from the problem alone; docs/theory.md says
/// why that is a proof.
///
/// Of each layer some nodes are said to be *reached*. In the first layer every node is reached or removed. Every edge from a
/// reached node leads to a reached node, or is removed, or its head is. In the last layer no node is reached.
struct Cut {
  /// Slots first ... last.
  struct Range {
    int first = 0, last = 0;
    bool operator==(const Range&) const = default;
  };
  /// Nodes that one thing removes.
  struct Nodes {
    Range slots;
    int witness = 0;  ///< index into `witnesses`
    bool operator==(const Nodes&) const = default;
  };
  /// Edges that one thing removes: all that are left from reached nodes among the tails, slots of the layer before, to heads that
  /// are neither reached nor removed.
  struct Edges {
    Range tails, heads;
    int witness = 0;
    std::int64_t count = 0;  ///< how many these are
    bool operator==(const Edges&) const = default;
  };
  struct Layer {
    int slots = 0;               ///< of the lattice: as many nodes as there can be
    std::vector<Range> reached;  ///< ascending, like all that follow
    std::vector<Nodes> removed;
    std::vector<Edges> edges;  ///< that lead here; by heads, then tails
    bool operator==(const Layer&) const = default;
  };

  Resolution resolution;
  EdgeMode edges = EdgeMode::kContinuous;
  /// Where bounded joints of more than a turn are taken as circles: ArcLattice::windings().
  std::vector<std::array<bool, kDof>> windings;
  int layers = 0;  ///< of the whole lattice
  int first_layer = 0;
  std::vector<Layer> band;       ///< that layer and those after it
  std::vector<Cause> witnesses;  ///< kind, joint and side, bodies, name of a check; without values
  bool operator==(const Cut&) const = default;
};

/// What a cut consists of.
struct CutCounts {
  struct Removed {
    std::int64_t nodes = 0, edges = 0;
  };
  std::vector<Removed> by_witness;
  std::int64_t reached = 0;  ///< nodes
};
[[nodiscard]] CutCounts count(const Cut& cut);

}  // namespace swivel
