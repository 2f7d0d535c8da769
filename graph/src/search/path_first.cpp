// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/search/path_first.hpp"

#include <stdexcept>

#include "search/path_validator.hpp"

namespace swivel {

namespace {

/// Searches for the first valid path, with failures of an earlier search asked about first.
SearchOutcome search(CostToGo& cost_to_go, Validity& validity, const PathFirstOptions& options,
                     SearchCounters& counters, const PriorFailures& first) {
  const Verdicts& verdicts = cost_to_go.verdicts();
  PathValidator validator(cost_to_go, validity, options);
  PathCache earlier;
  validator.ask_again(first);
  if (verdicts.removed() > 0 && !verdicts.pending.empty()) cost_to_go.repair();
  return first_valid_path(cost_to_go, validity, validator, earlier, counters);
}

/// Returns the first slot of layer 0 from which a path of the least cost leads, -1 when no path is
/// left.
int cheapest_slot(const CostToGo& cost_to_go) {
  const double best = cost_to_go.best();
  if (best == kUnreachable) return -1;
  int slot = 0;
  while (cost_to_go.at(0, slot) != best) ++slot;
  return slot;
}

}  // namespace

SearchOutcome first_valid_path(CostToGo& cost_to_go, const Validity& validity,
                               PathValidator& validator, PathCache& earlier,
                               SearchCounters& counters, FirstPath first) {
  for (;;) {
    cost_to_go.budget().poll();
    if (validator.ends_at(cost_to_go.best())) return {};
    const int slot =
        first == FirstPath::kCheapest ? cheapest_slot(cost_to_go) : cost_to_go.first_slot();
    const SlotPath path =
        slot < 0 ? SlotPath() : best_path_from(slot, cost_to_go, counters.expansions, &earlier);
    if (path.empty()) return {};
    earlier.add(path, cost_to_go);
    validator.begin();
    counters.candidate = path;
    ++counters.iterations;
    if (validity.asks_costs() && validator.costs_more(path)) {
      cost_to_go.repair();
      continue;
    }
    const std::int64_t removed = cost_to_go.verdicts().removed();
    if (validator.valid(path)) return {path, cost_to_go.at(0, path.front())};
    if (validator.bars_a_layer()) return {};
    if (cost_to_go.verdicts().removed() == removed)
      throw std::logic_error("a round of the search removed nothing: it would never end");
    cost_to_go.repair();
  }
}

SearchOutcome path_first(CostToGo& cost_to_go, Validity& validity, const PathFirstOptions& options,
                         SearchCounters& counters, const PriorFailures& first) {
  return search(cost_to_go, validity, options, counters, first);
}

void check_failure_hints(CostToGo& cost_to_go, Validity& validity,
                         std::span<const FailureHint> failure_hints) {
  if (!failure_hints.empty())
    PathValidator(cost_to_go, validity, {}).check_failure_hints(failure_hints);
}

int deepest_valid_layer(CostToGo& cost_to_go, Validity& validity, const PathFirstOptions& options,
                        SearchCounters& counters) {
  for (;;) {
    const int optimistic = cost_to_go.deepest_reachable();
    if (optimistic < 0) return -1;
    const std::int64_t removed = cost_to_go.verdicts().removed();
    cost_to_go.sweep(optimistic);
    KnotSearch on_the_way;
    PathFirstOptions to_there = options;
    if (options.knots) to_there.knots = &on_the_way;
    const bool found = !search(cost_to_go, validity, to_there, counters, {}).path.empty();
    if (options.knots) options.knots->narrow = on_the_way.narrow;
    if (found) return optimistic;
    if (!on_the_way.narrow.empty()) return -1;
    if (cost_to_go.verdicts().removed() == removed)
      throw std::logic_error("a round of the search removed nothing: it would never end");
  }
}

}  // namespace swivel
