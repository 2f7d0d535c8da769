// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "swivel/graph/search/path_first.hpp"

namespace swivel {

/// What an eager planner found. It is the paper's method and the baseline: every node and every
/// edge is validated first.
struct EagerOutcome : SearchOutcome {
  /// The deepest layer that layer 0 reaches when there is no path; -1 when layer 0 is empty; none
  /// where it was stopped before it knew.
  std::optional<int> deepest;
  std::int64_t edges = 0;  ///< candidate edges compared
  std::int64_t ik_nodes = 0;
  std::int64_t expansions = 0;
};
/// Validates every node and edge, stores the edges as an explicit graph, and searches it with
/// Boost.Graph. Sets `outcome`. Throws std::bad_alloc where the graph exceeds the machine's memory,
/// and Stopped: the counts are then those of what was done.
void eager_search(const Lattice& lattice, Validity& validity, const Budget& budget,
                  EagerOutcome& outcome);

/// Finds the best path by a layered dynamic program over the window, without stored edges: the
/// strong baseline. It asks about an edge only when it would be its tail's best so far. Sets
/// `outcome`. Throws Stopped: the counts are then those of what was done.
void eager_dp(const Lattice& lattice, Validity& validity, const Budget& budget,
              EagerOutcome& outcome);

}  // namespace swivel
