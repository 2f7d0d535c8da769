// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/search/closed_path.hpp"

#include <algorithm>
#include <queue>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "cost_to_go/best_start.hpp"
#include "search/closing_slots.hpp"
#include "search/loop_costs.hpp"
#include "search/path_validator.hpp"
#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

/// The best path that begins and ends in a run of slots.
struct Bounded {
  Lattice::SlotRun run;
  SearchOutcome best;
  bool operator<(const Bounded& other) const {  // the queue's top is the greatest
    return std::tie(other.best.cost, other.run.first) < std::tie(best.cost, run.first);
  }
};

/// Finds the best paths within runs of slots by sweeps of one cost-to-go. Where several have found
/// none that closes, it finds out from which slots none can, and leaves these out.
class Sweeps {
 public:
  Sweeps(CostToGo& cost_to_go, Validity& validity, const PathFirstOptions& options,
         SearchCounters& counters)
      : cost_to_go_(cost_to_go),
        validator_(cost_to_go, validity, options),
        counters_(counters),
        may_close_(static_cast<std::size_t>(cost_to_go.lattice().slots(0)), 1) {}

  SearchOutcome best_within(const Lattice::SlotRun& run) {
    if (++solves_ == next_reach_) leave_out_open();
    if (!any_may_close(run)) return {};
    sweep_to(run, cost_to_go_, may_close_);
    PathCache earlier;
    for (;;) {
      cost_to_go_.budget().poll();
      const int slot = cheapest_slot(run);
      if (slot < 0 || validator_.ends_at(cost_to_go_.at(0, slot))) return {};
      const SlotPath path = best_path_from(slot, cost_to_go_, counters_.expansions, &earlier);
      earlier.add(path, cost_to_go_);
      validator_.begin();
      counters_.candidate = path;
      ++counters_.iterations;
      const std::int64_t removed = cost_to_go_.verdicts().removed();
      if (validator_.valid(path)) return {path, cost_to_go_.at(0, slot)};
      if (cost_to_go_.verdicts().removed() == removed)
        throw std::logic_error("a round of the search removed nothing: it would never end");
      cost_to_go_.repair();
    }
  }

 private:
  void leave_out_open() {
    next_reach_ *= 2;
    if (removed_then_ == cost_to_go_.verdicts().removed()) return;
    sweep_to({0, static_cast<int>(may_close_.size())}, cost_to_go_, may_close_);
    leave_out_open_slots(cost_to_go_, may_close_);
    removed_then_ = cost_to_go_.verdicts().removed();
  }
  [[nodiscard]] bool may_close(int slot) const {
    return may_close_[static_cast<std::size_t>(slot)] != 0;
  }
  [[nodiscard]] bool any_may_close(const Lattice::SlotRun& run) const {
    return std::any_of(may_close_.begin() + run.first, may_close_.begin() + run.last,
                       [](std::uint8_t may) { return may != 0; });
  }
  /// Returns the first slot of a run from which the cheapest path leads that may close; -1 where
  /// none does.
  [[nodiscard]] int cheapest_slot(const Lattice::SlotRun& run) const {
    int best = -1;
    double least = kUnreachable;
    for (int slot = run.first; slot < run.last; ++slot)
      if (const double cost = cost_to_go_.at(0, slot); cost < least && may_close(slot))
        least = cost, best = slot;
    return best;
  }

  CostToGo& cost_to_go_;
  PathValidator validator_;
  SearchCounters& counters_;
  static constexpr int kFew = 8;  // sweeps, which take about as long as a pass through all edges
  int solves_ = 0, next_reach_ = kFew;
  std::int64_t removed_then_ = -1;       // when edges were gone through last
  std::vector<std::uint8_t> may_close_;  // by slot
};

}  // namespace

ClosedOutcome closed_path_first(const Lattice& lattice, const Budget& budget,
                                const BestWithin& best_within) {
  const TraceSpan span("closed path");
  ClosedOutcome outcome;
  std::priority_queue<Bounded> queue;
  double most = kUnreachable;  // the largest cost of the coarse cost of the best closed path
  const auto solve = [&](int first, int last) {
    if (first >= last) return;
    budget.poll();
    ++outcome.solves;
    SearchOutcome best = best_within({first, last});
    if (!best.path.empty() && best.cost <= most) queue.push({{first, last}, std::move(best)});
  };
  std::vector<SearchOutcome> closed;  // of the best coarse cost, by slot
  solve(0, lattice.slots(0));
  while (!queue.empty() && queue.top().best.cost <= most) {
    Bounded top = queue.top();
    queue.pop();
    const int begin = top.best.path.front(), end = top.best.path.back();
    if (begin == end) {
      if (closed.empty()) most = lattice.largest_of_same_coarse_cost(top.best.cost);
      closed.push_back(std::move(top.best));
      solve(top.run.first, begin);
      solve(begin + 1, top.run.last);
    } else {
      const int middle = std::min(begin, end) + (std::abs(end - begin) + 1) / 2;
      solve(top.run.first, middle);
      solve(middle, top.run.last);
    }
  }
  std::sort(closed.begin(), closed.end(), [](const SearchOutcome& a, const SearchOutcome& b) {
    return a.path.front() < b.path.front();
  });
  double least = kUnreachable;
  for (const SearchOutcome& path : closed) least = std::min(least, path.cost);
  const auto at = [&](int k) -> const SearchOutcome& {
    return closed[static_cast<std::size_t>(k)];
  };
  const int best = best_start(
      lattice, static_cast<int>(closed.size()), least, [&](int k) { return at(k).cost; },
      [&](int k) { return *lattice.node(0, at(k).path.front()); });
  if (best >= 0) static_cast<SearchOutcome&>(outcome) = at(best);
  return outcome;
}

ClosedOutcome closed_path_first(CostToGo& cost_to_go, Validity& validity,
                                const PathFirstOptions& options, SearchCounters& counters) {
  Sweeps sweeps(cost_to_go, validity, options, counters);
  return closed_path_first(cost_to_go.lattice(), cost_to_go.budget(),
                           [&](const Lattice::SlotRun& run) { return sweeps.best_within(run); });
}

}  // namespace swivel
