// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// What it costs to run strokes one after the other, by estimate. Run 2 k is stroke k as it is
/// listed, run 2 k + 1 is stroke k from its last waypoint to its first; costs of runs that are not
/// allowed are infinite.
struct OrderCosts {
  std::size_t strokes = 0;
  std::vector<double> first, last;  ///< by run: to begin the job with it, and to end with it
  std::vector<std::vector<double>> follow;  ///< [run][next run]: to go on with the next run
};

/// Returns what an order costs.
[[nodiscard]] double cost_of_order(const OrderCosts& costs, const std::vector<StrokeRun>& order);

/// Returns an order in which each stroke is run once: the cheapest of local searches from some
/// first runs, fewer the more strokes there are, which move stretches of up to three strokes and
/// turn stretches around (Or-opt, 2-opt). Deterministic. Throws Stopped.
[[nodiscard]] std::vector<StrokeRun> cheapest_order(const OrderCosts& costs, const Budget& budget);

/// Returns the cheapest order that differs from `order` by one move: a stretch of strokes turned
/// round, each stroke of it too or not, or up to three strokes moved elsewhere, either way round.
/// Orders in which the strokes follow each other as in one of `others`, whatever their directions,
/// are left out. Returns none where no such order can be run, or where there are
/// more strokes than local searches take.
[[nodiscard]] std::optional<std::vector<StrokeRun>> cheapest_neighbour(
    const OrderCosts& costs, const std::vector<StrokeRun>& order,
    const std::vector<std::vector<StrokeRun>>& others, const Budget& budget);

}  // namespace swivel
