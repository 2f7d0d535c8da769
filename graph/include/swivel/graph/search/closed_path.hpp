// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>

#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/search/path_first.hpp"

namespace swivel {

/// Returns the cheapest valid path that begins and ends in slots of one run, not necessarily the
/// same; of several the one whose first slot is the smallest, then the first in slot order. An
/// empty path where there is none. Throws Stopped.
using BestWithin = std::function<SearchOutcome(const Lattice::SlotRun& run)>;

/// What a search for a closed path found.
struct ClosedOutcome : SearchOutcome {
  int solves = 0;  ///< calls of BestWithin
};

/// Returns the valid path that ends in the slot in which it begins, the first in the order of
/// answers (docs/model.md); an empty path where there is none. The lattice must be closed
/// (Lattice::is_closed()).
///
/// Branch and bound over runs of slots, cheapest first: no path that is closed within a run costs
/// less than the best path that begins and ends in it. Where that path is closed, it is the best of
/// its slot, and the rest of the run is searched for paths of the same coarse cost; else the run is
/// cut between the two slots. Throws Stopped.
[[nodiscard]] ClosedOutcome closed_path_first(const Lattice& lattice, const Budget& budget,
                                              const BestWithin& best_within);

/// Returns the closed path that closed_path_first() finds by sweeps of a cost-to-go, which must be
/// whole (Pruning::kNone). What is known of nodes and edges serves all of them. Nodes of the last
/// layer must cost what the lattice says. Throws Stopped.
[[nodiscard]] ClosedOutcome closed_path_first(CostToGo& cost_to_go, Validity& validity,
                                              const PathFirstOptions& options,
                                              SearchCounters& counters);

}  // namespace swivel
