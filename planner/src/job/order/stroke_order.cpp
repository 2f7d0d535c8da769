// SPDX-License-Identifier: BSD-3-Clause
#include "job/order/stroke_order.hpp"

#include <algorithm>
#include <limits>

namespace swivel {

namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr std::size_t kMostLocal = 120;  // strokes whose order is improved by local search

using Runs = std::vector<std::size_t>;  // 2 * stroke + reversed

std::vector<StrokeRun> as_order(const Runs& runs) {
  std::vector<StrokeRun> order;
  order.reserve(runs.size());
  for (const std::size_t run : runs) order.push_back({run / 2, run % 2 == 1});
  return order;
}

Runs as_runs(const std::vector<StrokeRun>& order) {
  Runs runs;
  for (const StrokeRun& run : order) runs.push_back(2 * run.stroke + (run.reversed ? 1 : 0));
  return runs;
}

double cost_of(const OrderCosts& costs, const Runs& runs) {
  double cost = costs.first[runs.front()] + costs.last[runs.back()];
  for (std::size_t k = 1; k < runs.size(); ++k) cost += costs.follow[runs[k - 1]][runs[k]];
  return cost;
}

/// Returns the order that takes the cheapest run next, from a first run on.
Runs nearest_next(const OrderCosts& costs, std::size_t first) {
  Runs order{first};
  std::vector<bool> done(costs.strokes);
  done[first / 2] = true;
  while (order.size() < costs.strokes) {
    std::size_t best = 0;
    double least = kNone;
    bool any = false;
    for (std::size_t next = 0; next < 2 * costs.strokes; ++next) {
      if (done[next / 2]) continue;
      const double cost = costs.follow[order.back()][next];
      if (!any || cost < least) least = cost, best = next, any = true;
    }
    done[best / 2] = true;
    order.push_back(best);
  }
  return order;
}

/// Calls `visit` with each order that differs from `order` by one move, until it returns true: with
/// a stroke turned round, a stretch turned round, or up to three strokes moved elsewhere, either
/// way round. Returns whether one did.
template <class Visit>
bool any_neighbour(const Runs& order, const Visit& visit) {
  const std::size_t n = order.size();
  const auto turn = [](Runs& runs, std::size_t first, std::size_t last) {
    std::reverse(runs.begin() + static_cast<std::ptrdiff_t>(first),
                 runs.begin() + static_cast<std::ptrdiff_t>(last));
    for (std::size_t k = first; k < last; ++k) runs[k] ^= 1;
  };
  Runs tried;
  for (std::size_t first = 0; first < n; ++first)
    for (std::size_t last = first + 1; last <= n; ++last) {
      tried = order;
      turn(tried, first, last);
      if (visit(tried)) return true;
      // a stretch in the other order, each stroke in its own direction
      for (std::size_t k = first; k < last; ++k) tried[k] ^= 1;
      if (visit(tried)) return true;
    }
  for (std::size_t length = 1; length <= 3 && length < n; ++length)
    for (std::size_t first = 0; first + length <= n; ++first)
      for (std::size_t to = 0; to + length <= n; ++to)
        for (const bool turned : {false, true}) {
          if (to == first) continue;
          tried = order;
          const auto at = tried.begin() + static_cast<std::ptrdiff_t>(first);
          Runs moved(at, at + static_cast<std::ptrdiff_t>(length));
          tried.erase(at, at + static_cast<std::ptrdiff_t>(length));
          if (turned) turn(moved, 0, length);
          tried.insert(tried.begin() + static_cast<std::ptrdiff_t>(to), moved.begin(), moved.end());
          if (visit(tried)) return true;
        }
  return false;
}

/// Improves an order by the first cheaper one among its neighbours. Returns false if there is none.
bool improve(const OrderCosts& costs, Runs& order, double& cost) {
  const Runs from = order;
  return any_neighbour(from, [&](const Runs& tried) {
    const double of_tried = cost_of(costs, tried);
    if (!(of_tried < cost)) return false;
    order = tried;
    cost = of_tried;
    return true;
  });
}

Runs searched_order(const OrderCosts& costs, const Budget& budget) {
  budget.tell(Stage::kSearch);
  Runs best;
  double least = kNone;
  const std::size_t runs = 2 * costs.strokes;
  const std::size_t starts = std::clamp<std::size_t>(kMostLocal / costs.strokes, 1, runs);
  for (std::size_t k = 0; k < starts; ++k) {
    Runs order = nearest_next(costs, k * runs / starts);
    double cost = cost_of(costs, order);
    do budget.poll();
    while (costs.strokes <= kMostLocal && improve(costs, order, cost));
    if (best.empty() || cost < least) best = order, least = cost;
  }
  return best;
}

}  // namespace

double cost_of_order(const OrderCosts& costs, const std::vector<StrokeRun>& order) {
  return cost_of(costs, as_runs(order));
}

std::optional<std::vector<StrokeRun>> cheapest_neighbour(
    const OrderCosts& costs, const std::vector<StrokeRun>& order,
    const std::vector<std::vector<StrokeRun>>& others, const Budget& budget) {
  if (order.size() > kMostLocal) return std::nullopt;
  const auto is_left_out = [&](const Runs& tried) {
    return std::any_of(others.begin(), others.end(), [&](const std::vector<StrokeRun>& other) {
      return std::equal(tried.begin(), tried.end(), other.begin(), other.end(),
                        [](std::size_t run, const StrokeRun& of) { return run / 2 == of.stroke; });
    });
  };
  Runs best;
  double least = kNone;
  any_neighbour(as_runs(order), [&](const Runs& tried) {
    const double cost = cost_of(costs, tried);
    if (!(cost < least) || is_left_out(tried)) return false;
    budget.poll();
    best = tried;
    least = cost;
    return false;
  });
  return best.empty() ? std::nullopt : std::optional(as_order(best));
}

std::vector<StrokeRun> cheapest_order(const OrderCosts& costs, const Budget& budget) {
  return as_order(searched_order(costs, budget));
}

}  // namespace swivel
