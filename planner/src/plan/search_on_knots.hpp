// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "plan/search.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

/// A lattice and the cost-to-go of its search; null before it was searched.
struct Searched {
  std::shared_ptr<Lattice> lattice;
  std::unique_ptr<CostToGo> cost_to_go;
};

/// Searches one lattice within a budget and puts its cost-to-go there. `coarser`: what was searched
/// before, a lattice from which this one was made by halving steps; null: none. `knots`: as
/// search_lazily() takes it. Throws Stopped at most while it prepares the search.
using SearchLattice = std::function<Found(Searched& searched, const Searched* coarser,
                                          const Budget& budget, KnotSearch* knots)>;

/// Returns Lattice::with_knots() of a lattice, as it may be kept from earlier plans; null where
/// there is none. Throws Stopped.
using HalveSteps = std::function<std::shared_ptr<Lattice>(
    const std::shared_ptr<Lattice>& lattice, const std::set<int>& steps, const Budget& budget)>;

/// The answer of a lattice and of those with more knots.
struct FoundOnKnots {
  Found found;
  std::optional<Searched> finer;  ///< the lattice of the answer, unless it is the first one
  /// What the search says of knots; none of a lattice whose steps cannot be halved.
  std::optional<LatticeInfo::Knots> knots;
};

/// Searches a lattice and, as long as that is worth it, lattices whose narrow steps between knots
/// (KnotSearch) are halved, and uneven_steps() of the answer. Returns the cheapest answer of all,
/// the coarsest of equal ones. With an answer it ends a while before the budget does, so that there
/// is time to prove it. `halve` makes the lattices. Throws as `search` does for the first lattice.
[[nodiscard]] FoundOnKnots search_on_knots(Searched& first, const SearchLattice& search,
                                           const HalveSteps& halve, const PlanOptions& options,
                                           const Budget& budget);

/// Makes a lattice with halved steps (HalveSteps).
[[nodiscard]] inline std::shared_ptr<Lattice> halve_steps(const std::shared_ptr<Lattice>& lattice,
                                                          const std::set<int>& steps,
                                                          const Budget& budget) {
  return lattice->with_knots(steps, budget);
}

/// Returns whether a lattice has a step that can be halved.
[[nodiscard]] bool can_halve(const Lattice& lattice);

/// Returns the steps between knots that are halved though a path is valid, since it drifts between
/// them: if its rows cost more than 1.01 times what its chords do, those that can be halved and
/// whose rows cost more than 1.05 times what their chord does. `rows`: Lattice::path_rows().
[[nodiscard]] std::set<int> uneven_steps(const Lattice& lattice, const SlotPath& path,
                                         std::vector<TrajectoryRow> rows);

/// Takes over what is known of the nodes and edges of a lattice into the cost-to-go of one with
/// more knots, or of the same. A sweep must follow.
void take_verdicts(CostToGo& coarser, CostToGo& finer);
/// Takes over what is known of the nodes and edges of a coarser lattice, and lower bounds if
/// `bounds`: if nodes cost nothing by hooks. A sweep must follow.
void take_from_coarser(const Searched& coarser, Searched& finer, bool bounds);

/// Returns a budget that ends somewhat before that of the plan does.
[[nodiscard]] Budget most_of(const Budget& budget, const PlanOptions& options);

/// Sets LatticeInfo::Knots::gap of an answer whose rows cost `cost`, where there is a bound, and
/// LatticeInfo::Knots::bias. `path`: of the answer, one slot for each layer of `lattice`, whose
/// nodes lie `arc` apart (Resolution::arc_of_nodes()).
void describe_knots(double cost, const Lattice& lattice, const std::vector<int>& path, double arc,
                    LatticeInfo& info);

}  // namespace swivel
