// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "swivel/graph/search/path_first.hpp"

namespace swivel {

/// The paper's method: every node and every edge validated first, edges stored, then a search by Boost.Graph. The baseline.
struct EagerOutcome : SearchOutcome {
  /// Deepest layer that layer 0 reaches when there is no path; -1 when layer 0 is empty; none where it was stopped before it knew.
  std::optional<int> deepest;
  std::int64_t edges = 0;  ///< candidate edges compared
  std::int64_t ik_nodes = 0;
  std::int64_t expansions = 0;
};
/// Explicit graph, searched by Dijkstra from the goal. Throws std::bad_alloc beyond the machine's memory, and Stopped, like
/// eager_dp: the counts are then those of what was done.
void eager_search(const Lattice& lattice, Validity& validity, const Budget& budget, EagerOutcome& outcome);

/// Same validity, a layered dynamic program over the window, no stored edges: the strong baseline. An edge is asked about only when
/// it would be its tail's best so far.
void eager_dp(const Lattice& lattice, Validity& validity, const Budget& budget, EagerOutcome& outcome);

}  // namespace swivel
