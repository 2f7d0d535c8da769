// SPDX-License-Identifier: BSD-3-Clause
// Orders of many strokes against orders drawn at random.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "job/order/stroke_order.hpp"
#include "seed.hpp"

namespace swivel {
namespace {

using namespace test;

OrderCosts random_costs(std::size_t strokes, Random& random) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  OrderCosts costs;
  costs.strokes = strokes;
  std::vector<bool> allowed(2 * strokes, true);
  for (std::size_t k = 0; k < strokes; ++k) allowed[2 * k + 1] = random.coin();
  const auto draw = [&](std::size_t run) { return allowed[run] ? random.uniform(0, 1) : kNone; };
  for (std::size_t run = 0; run < 2 * strokes; ++run) {
    costs.first.push_back(draw(run));
    costs.last.push_back(draw(run));
    costs.follow.emplace_back();
    for (std::size_t next = 0; next < 2 * strokes; ++next)
      costs.follow.back().push_back(allowed[run] ? draw(next) : kNone);
  }
  return costs;
}

void expect_each_once(const std::vector<StrokeRun>& order, std::size_t strokes) {
  std::vector<int> times(strokes);
  for (const StrokeRun& run : order) ++times[run.stroke];
  EXPECT_EQ(times, std::vector<int>(strokes, 1));
}

TEST(StrokeOrder, OfManyStrokesIsNearTheBestOfRandomRestarts) {
  Random random(seed("StrokeOrder many"));
  for (int trial = 0; trial < trials(4); ++trial) {
    constexpr std::size_t kStrokes = 20;
    OrderCosts costs = random_costs(kStrokes, random);
    const std::vector<StrokeRun> order = cheapest_order(costs, {});
    expect_each_once(order, kStrokes);
    double best = std::numeric_limits<double>::infinity();
    std::vector<StrokeRun> drawn = order;
    for (int restart = 0; restart < 2000; ++restart) {
      for (std::size_t k = kStrokes; k > 1; --k)
        std::swap(drawn[k - 1], drawn[static_cast<std::size_t>(random.below(static_cast<int>(k)))]);
      best = std::min(best, cost_of_order(costs, drawn));
    }
    EXPECT_LT(cost_of_order(costs, order), best);
  }
}

}  // namespace
}  // namespace swivel
