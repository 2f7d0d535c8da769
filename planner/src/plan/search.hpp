// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "swivel/collision/proofs/verdict.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

class CollisionValidity;

/// Returns true if the lattice is so large that lower bounds, sweeps and the work between two
/// batches of questions are worth sharing between threads.
[[nodiscard]] inline bool shares_work(const Lattice& lattice) {
  // from this size on, each of these takes some milliseconds
  return lattice.nodes() >= 150'000;
}

/// Returns how much a sweep of the lattice's cost-to-go may leave out.
[[nodiscard]] inline Pruning pruning_of(const Lattice& lattice) {
  // With fewer layers, chords are too long to give good bounds. From a given start costs are known.
  constexpr int kFewLayers = 64;
  const bool bounds_well = lattice.layers() >= kFewLayers || lattice.is_given(0);
  return !bounds_well || lattice.is_closed() ? Pruning::kNone : Pruning::kByBound;
}

/// Adds the work of one search to that of all.
inline void add_counters(const Counters& more, Counters& sum) {
  sum.ik_nodes += more.ik_nodes;
  sum.edges += more.edges;
  sum.nodes_checked += more.nodes_checked;
  sum.edges_checked += more.edges_checked;
  sum.fcl_calls += more.fcl_calls;
  sum.proved_free += more.proved_free;
  sum.proved_colliding += more.proved_colliding;
  sum.expansions += more.expansions;
  sum.iterations += more.iterations;
}
/// Adds queries for collisions.
void add_counters(const CollisionCounters& more, Counters& sum);
/// Adds what was asked about nodes and edges, and the queries for that.
void add_counters(const CollisionValidity& validity, Counters& sum);

/// The result of a search by any of the planners.
struct Found {
  /// False if the search was stopped before it was known whether there is a path.
  bool decided = false;
  SearchOutcome outcome;
  /// If there is no path: the last layer that a valid path reaches, of closed paths that of a path
  /// which need not be closed; unset if it was not found in time.
  std::optional<int> deepest;
  /// A valid path from layer 0: the whole path; if there is none, the one to the deepest layer; if
  /// the lazy search was stopped, the part that was proved.
  SlotPath valid_path;
  /// Lattice::path_rows() of outcome.path, where it was asked for; empty if it was not, or if a
  /// joint leaves its limits.
  std::vector<TrajectoryRow> rows;
};

/// Searches with the eager planner or eager_dp (options.planner), which validate the whole lattice
/// first. Fills `counters`.
[[nodiscard]] Found search_eagerly(const Lattice& lattice, Validity& validity,
                                   const PlanOptions& options, const Budget& budget,
                                   Counters& counters);
/// Searches with the lazy or the parallel planner (options.planner). `swept`: whether cost_to_go
/// already holds the values of the lattice without removals; otherwise `failure_hints` are
/// validated before it is swept. `first`: failures of earlier searches, which are tested first.
/// `knots`: where to note what the search says of steps between knots; null: nowhere. If it notes
/// that halving steps may lead to a path, the deepest layer is not sought. Fills `counters` and the
/// times of the stages, ms, in `time_ms`.
[[nodiscard]] Found search_lazily(CostToGo& cost_to_go, bool swept, Validity& validity,
                                  const PriorFailures& first,
                                  std::span<const FailureHint> failure_hints,
                                  const PlanOptions& options, Counters& counters,
                                  std::map<std::string, double>& time_ms,
                                  KnotSearch* knots = nullptr);

/// What a path costs, over the bound of its lattice's knots, to be good enough.
inline constexpr double kWorthHalving = 1.01;
/// Returns whether a lattice with more knots may have a path, where none was found, or one that is
/// cheaper by more than a hundredth than the best one: whether steps are narrow that can be halved.
[[nodiscard]] bool worth_halving(const KnotSearch& knots, const SearchOutcome& best);

}  // namespace swivel
