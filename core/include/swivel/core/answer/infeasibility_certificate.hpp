// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "swivel/core/answer/cause.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

/// An infeasibility certificate: it proves that a problem has no path at its resolution. It lists
/// nodes and edges of some neighbouring layers, each removed by a cause, without which nothing
/// leads through these layers. verify_certificate() verifies it from the problem alone;
/// docs/theory.md says why that is a proof.
///
/// In each layer some nodes are marked as *reached*. In the first layer every node is reached or
/// removed. Every edge from a reached node leads to a reached node, or is removed, or its head is.
/// In the last layer no node is reached.
struct InfeasibilityCertificate {
  /// The slots first ... last.
  struct Range {
    int first = 0, last = 0;
    bool operator==(const Range&) const = default;
  };
  /// Nodes that one cause removes.
  struct Nodes {
    Range slots;
    int witness = 0;  ///< index of the cause in `witnesses`
    bool operator==(const Nodes&) const = default;
  };
  /// Edges that one cause removes: all that are left from reached nodes among the tails, slots of
  /// the layer before, to heads that are neither reached nor removed.
  struct Edges {
    Range tails, heads;
    int witness = 0;
    std::int64_t count = 0;  ///< how many edges these are
    bool operator==(const Edges&) const = default;
  };
  /// What is known of the nodes of one layer and the edges that lead to it.
  struct Layer {
    int slots = 0;  ///< number of slots that the lattice has here
    /// Slots of reached nodes, ascending, as all that follow.
    std::vector<Range> reached;
    std::vector<Nodes> removed;
    std::vector<Edges> edges;  ///< edges that lead here; by heads, then tails
    bool operator==(const Layer&) const = default;
  };

  std::string stroke;     ///< of a stroke of a job: its name, else empty
  bool reversed = false;  ///< of a stroke: it is run from its last waypoint to its first
  Resolution resolution;
  EdgeMode edges = EdgeMode::kContinuous;
  /// For lattices where bounded joints of more than a turn count as circles: the joints told apart
  /// (Lattice::joints_with_windings()).
  std::vector<std::array<bool, kDof>> windings;
  /// For lattices whose layers are knots: the steps that were halved, one call of
  /// Lattice::with_knots() after the other.
  std::vector<std::set<int>> halvings;
  int layers = 0;  ///< layers of the whole lattice
  int first_layer = 0;
  std::vector<Layer> band;  ///< layers from `first_layer` on
  /// The causes: kind, joint and side, bodies, name of a check; without values.
  std::vector<Cause> witnesses;
  bool operator==(const InfeasibilityCertificate&) const = default;
};

/// How many nodes and edges a certificate removes by each cause, and how many nodes it reaches.
struct CertificateCounts {
  struct Removed {
    std::int64_t nodes = 0, edges = 0;
  };
  std::vector<Removed> by_witness;
  std::int64_t reached = 0;  ///< reached nodes
};
/// Counts the nodes and edges of a certificate.
[[nodiscard]] CertificateCounts count(const InfeasibilityCertificate& certificate);

}  // namespace swivel
