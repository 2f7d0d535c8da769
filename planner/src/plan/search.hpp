// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

/// Whether lower bounds, sweeps and what comes between two questions take long enough to be shared.
[[nodiscard]] inline bool shares_work(const Lattice& lattice) {
  return lattice.nodes() >= 150'000;  // some milliseconds
}

/// What a search found, by whichever planner.
struct Found {
  bool decided = false;  ///< whether there is a path; else it was stopped before
  SearchOutcome outcome;
  std::optional<int> deepest;  ///< where there is no path: of the layers reached; none where that was not found in time
  /// Valid from layer 0 on, as far as it goes: the path, or where there is none the way to the deepest layer, or what was proved of
  /// one before the search was stopped.
  SlotPath valid_path;
};

/// The planners eager and eager_dp.
[[nodiscard]] Found search_eagerly(const Lattice& lattice, Validity& validity, const PlanOptions& options, const Budget& budget,
                                   Counters& counters);
/// The planners lazy and parallel. `swept`: the cost-to-go is that of the lattice without removals; else `suspects` are asked about
/// before it is swept.
[[nodiscard]] Found search_lazily(CostToGo& cost_to_go, bool swept, Validity& validity, const AskedFirst& first,
                                  std::span<const Suspect> suspects, const PlanOptions& options, Counters& counters,
                                  std::map<std::string, double>& time_ms);

}  // namespace swivel
