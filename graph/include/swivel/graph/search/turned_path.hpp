// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/graph/search/path_first.hpp"

namespace swivel {

/// The values, rad, that a joint may have which a lattice treats as a circle.
struct CircleRange {
  int joint = 0;
  double lower = 0, upper = 0;
};

/// Searches as path_first() does for the cheapest valid path along which circles stay within their
/// ranges, counted without jumps from the only node of layer 0; at a given end each circle must be
/// in the turn of the end. Of several, the first in the order of slots. Paths are found by A* over
/// labels, nodes with the turn of each circle, with the cost-to-go, which knows no turns, as its
/// heuristic. Returns nothing where no such path is left, or where `most_labels` labels did not
/// suffice for all rounds together. The cost-to-go must be whole (Pruning::kNone), and nodes
/// without costs of their own. Throws Stopped.
[[nodiscard]] std::optional<SearchOutcome> path_first_within(
    CostToGo& cost_to_go, Validity& validity, const std::vector<CircleRange>& ranges,
    const PathFirstOptions& options, int most_labels, SearchCounters& counters);

}  // namespace swivel
