// SPDX-License-Identifier: BSD-3-Clause
#include "plan/search.hpp"

#include "plan/stopwatch.hpp"
#include "swivel/graph/eager/eager.hpp"
#include "swivel/graph/search/closed_path.hpp"
#include "validity/collision_validity.hpp"

namespace swivel {

void add_counters(const CollisionCounters& more, Counters& sum) {
  sum.fcl_calls += more.fcl_calls;
  sum.proved_free += more.proved_free;
  sum.proved_colliding += more.proved_colliding;
}

void add_counters(const CollisionValidity& validity, Counters& sum) {
  sum.nodes_checked += validity.nodes_checked();
  sum.edges_checked += validity.edges_checked();
  add_counters(validity.counters(), sum);
}

Found search_eagerly(const Lattice& lattice, Validity& validity, const PlanOptions& options,
                     const Budget& budget, Counters& counters) {
  Found found;
  EagerOutcome eager;
  try {
    if (options.planner == PlannerKind::kEager)
      eager_search(lattice, validity, budget, eager);
    else
      eager_dp(lattice, validity, budget, eager);
    found = {true, eager, eager.deepest, eager.path};
  } catch (const Stopped&) {
  }
  counters.ik_nodes = eager.ik_nodes;
  counters.edges = eager.edges;
  counters.expansions = eager.expansions;
  return found;
}

namespace {

/// Returns the leading part of a path whose nodes and edges are proved valid.
SlotPath proved_part(const SlotPath& path, const Verdicts& verdicts, const Validity& validity) {
  SlotPath proved;
  for (const int slot : path) {
    const int layer = static_cast<int>(proved.size());
    if (verdicts.node(layer, slot) != Verdict::kValid) break;
    if (layer > 0 && validity.asks_edges() &&
        verdicts.edge(layer - 1, proved.back(), slot) != Verdict::kValid)
      break;
    proved.push_back(slot);
  }
  return proved;
}

}  // namespace

bool worth_halving(const KnotSearch& knots, const SearchOutcome& best) {
  return !knots.narrow.empty() && (best.path.empty() || best.cost > kWorthHalving * knots.from);
}

Found search_lazily(CostToGo& cost_to_go, bool swept, Validity& validity,
                    const PriorFailures& first, std::span<const FailureHint> failure_hints,
                    const PlanOptions& options, Counters& counters,
                    std::map<std::string, double>& time_ms, KnotSearch* knots) {
  Stopwatch watch;
  Found found;
  SearchCounters searched;
  // Batch sizes are fixed, so that what is asked (and counted) does not depend on the number of
  // threads. Threads share the questions of a batch, and hardly anything of the work between two
  // paths. A caller's check is asked about many states at once, because a call may cost more than
  // the answers.
  PathFirstOptions path_first_options{.batch = 8};
  if (options.hooks.check)
    path_first_options.batch = 32;
  else if (options.planner == PlannerKind::kParallel)
    path_first_options = {.batch = 16,
                          .min_questions_per_iteration = 128,
                          .overlap_region_questions = shares_work(cost_to_go.lattice())};
  path_first_options.knots = knots;
  try {
    if (!swept) {
      check_failure_hints(cost_to_go, validity, failure_hints);
      cost_to_go.sweep(cost_to_go.lattice().layers() - 1);
    }
    time_ms["sweep"] += watch.lap();
    found.outcome = path_first(cost_to_go, validity, path_first_options, searched, first);
    const bool closes = cost_to_go.lattice().is_closed() && !found.outcome.path.empty();
    if (closes) {
      found.deepest = cost_to_go.lattice().layers() - 1;
      found.valid_path = found.outcome.path;  // an open path, should there be no closed one
      found.outcome = closed_path_first(cost_to_go, validity, path_first_options, searched);
      if (knots && knots->idle >= knots->patience) found.outcome = {};
    }
    found.decided = true;
    if (!closes || !found.outcome.path.empty()) found.valid_path = found.outcome.path;
    time_ms["search"] += watch.lap();
    if (found.outcome.path.empty() && !closes &&
        !(knots && (knots->most != kUnreachable || worth_halving(*knots, {})))) {
      cost_to_go.budget().tell(Stage::kReach);
      found.deepest = deepest_valid_layer(cost_to_go, validity, path_first_options, searched);
      // the path tried last is valid
      if (*found.deepest >= 0) found.valid_path = searched.candidate;
      time_ms["reach"] += watch.lap();
    }
  } catch (const Stopped&) {
    found.valid_path = proved_part(searched.candidate, cost_to_go.verdicts(), validity);
  }
  counters.ik_nodes = cost_to_go.ik_nodes();
  counters.edges = cost_to_go.edges();
  counters.expansions = searched.expansions;
  counters.iterations = searched.iterations;
  return found;
}

}  // namespace swivel
