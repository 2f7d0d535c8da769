// SPDX-License-Identifier: BSD-3-Clause
// Orders of strokes in small graphs against all orders, directions and groups of nodes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <numeric>
#include <vector>

#include "job/order/order_program.hpp"
#include "seed.hpp"

namespace swivel {
namespace {

using namespace test;

constexpr double kNoWay = std::numeric_limits<double>::infinity();

/// Draws a graph. Costs are multiples of a power of two, so that sums do not depend on their order,
/// and few, so that many orders cost the same.
OrderGraph random_graph(std::size_t strokes, Random& random) {
  const double none = random.coin() ? 0 : random.uniform(0, 0.5);
  const int steps = random.coin() ? 8 : 4096;
  const auto draw = [&] {
    return random.coin(none) ? kNoWay : static_cast<double>(random.below(steps)) / 64;
  };
  OrderGraph graph;
  graph.strokes = strokes;
  for (std::size_t k = 0; k < 2 * strokes; ++k) {
    OrderGraph::Run& run = graph.runs.emplace_back();
    if (k % 2 == 1 && random.coin(0.4)) continue;
    run.begins = static_cast<std::size_t>(1 + random.below(3));
    run.ends = static_cast<std::size_t>(1 + random.below(3));
    for (std::size_t n = 0; n < run.begins * run.ends; ++n) run.through.push_back(draw());
    for (std::size_t n = 0; n < run.begins; ++n) run.first.push_back(draw());
    for (std::size_t n = 0; n < run.ends; ++n) run.last.push_back(draw());
  }
  graph.follow.assign(2 * strokes, std::vector<std::vector<double>>(2 * strokes));
  for (std::size_t k = 0; k < 2 * strokes; ++k)
    for (std::size_t next = 0; next < 2 * strokes; ++next)
      if (k / 2 != next / 2)
        for (std::size_t n = 0; n < graph.runs[k].ends * graph.runs[next].begins; ++n)
          graph.follow[k][next].push_back(draw());
  return graph;
}

/// A group of nodes of a run, and the least cost up to it or from it on.
struct At {
  std::size_t run = 0, group = 0;
  double cost = kNoWay;
};

/// What jobs in all orders cost, one order after the other.
class AllOrders {
 public:
  explicit AllOrders(const OrderGraph& graph) : graph_(graph) {
    for (const OrderGraph::Run& run : graph.runs) {
      uses.begins.emplace_back(run.begins, kNoWay);
      uses.ends.emplace_back(run.ends, kNoWay);
    }
    std::vector<std::size_t> strokes(graph.strokes);
    std::iota(strokes.begin(), strokes.end(), 0);
    do {
      const double cost = least_of(strokes);
      if (cost != kNoWay) orders.push_back({strokes, cost});
    } while (std::next_permutation(strokes.begin(), strokes.end()));
    std::stable_sort(orders.begin(), orders.end(),
                     [](const auto& a, const auto& b) { return a.cost < b.cost; });
  }

  std::vector<BoundedOrder> orders;  // the cheapest first
  OrderProgram::Uses uses;

 private:
  /// Returns the groups at which the runs of a stroke begin or end.
  [[nodiscard]] std::vector<At> groups(std::size_t stroke, bool ends) const {
    std::vector<At> all;
    for (std::size_t run = 2 * stroke; run < 2 * stroke + 2; ++run)
      for (std::size_t k = 0; k < (ends ? graph_.runs[run].ends : graph_.runs[run].begins); ++k)
        all.push_back({run, k});
    return all;
  }
  /// Returns what it costs to go from a group of an order to one of the next.
  [[nodiscard]] double step(const At& from, const At& to) const {
    if (from.run == to.run)
      return graph_.runs[from.run].through[from.group * graph_.runs[from.run].ends + to.group];
    if (from.run / 2 == to.run / 2) return kNoWay;
    return graph_.follow[from.run][to.run][from.group * graph_.runs[to.run].begins + to.group];
  }
  /// Returns the least cost of jobs in an order; each of its groups learns what they cost through
  /// it.
  double least_of(const std::vector<std::size_t>& order) {
    std::vector<std::vector<At>> places;  // the begins of each stroke, then its ends
    for (const std::size_t stroke : order)
      for (const bool ends : {false, true}) places.push_back(groups(stroke, ends));
    std::vector<std::vector<At>> onward = places;
    for (At& at : places.front()) at.cost = graph_.runs[at.run].first[at.group];
    for (At& at : onward.back()) at.cost = graph_.runs[at.run].last[at.group];
    for (std::size_t k = 1; k < places.size(); ++k) {
      for (At& to : places[k])
        for (const At& from : places[k - 1])
          to.cost = std::min(to.cost, from.cost + step(from, to));
      const std::size_t back = places.size() - 1 - k;
      for (At& from : onward[back])
        for (const At& to : onward[back + 1])
          from.cost = std::min(from.cost, to.cost + step(from, to));
    }
    double least = kNoWay;
    for (std::size_t k = 0; k < places.size(); ++k)
      for (std::size_t n = 0; n < places[k].size(); ++n) {
        const At& at = places[k][n];
        double& use = (k % 2 == 1 ? uses.ends : uses.begins)[at.run][at.group];
        use = std::min(use, at.cost + onward[k][n].cost);
        if (k == 0) least = std::min(least, at.cost + onward[k][n].cost);
      }
    return least;
  }
  const OrderGraph& graph_;
};

struct Met {
  int graphs = 0, without = 0;
  std::int64_t orders = 0, equal = 0;
};

void expect_as_all_orders(const OrderGraph& graph, const AllOrders& all, Random& random, Met& met) {
  const OrderProgram program(graph, {});
  ++met.graphs;
  if (all.orders.empty()) {
    ++met.without;
    ASSERT_EQ(program.least(), kNoWay);
    ASSERT_TRUE(program.cheaper_than(kNoWay, 100).empty());
    return;
  }
  ASSERT_EQ(program.least(), all.orders.front().cost);
  const auto& some =
      all.orders[static_cast<std::size_t>(random.below(static_cast<int>(all.orders.size())))];
  const double most = random.coin() ? kNoWay : some.cost;
  std::vector<BoundedOrder> expected;
  for (const BoundedOrder& order : all.orders)
    if (order.cost < most) expected.push_back(order);
  const auto count = static_cast<std::size_t>(random.below(200));
  if (expected.size() > count) expected.resize(count);
  ASSERT_EQ(program.cheaper_than(most, count), expected);
  met.orders += static_cast<std::int64_t>(expected.size());
  for (std::size_t k = 1; k < expected.size(); ++k)
    met.equal += expected[k].cost == expected[k - 1].cost;
}

TEST(OrderProgram, GivesTheCheapestOfAllOrdersUpToSevenStrokes) {
  Random random(seed("OrderProgram"));
  Met met;
  std::vector<int> of_strokes(8);
  for (int trial = 0; trial < trials(10'000); ++trial) {
    // Fewer graphs of many strokes, whose orders are so many more.
    const int draw = random.below(1000);
    const std::size_t strokes = draw < 20    ? 7
                                : draw < 70  ? 6
                                : draw < 250 ? 5
                                             : static_cast<std::size_t>(1 + random.below(4));
    ++of_strokes[strokes];
    const OrderGraph graph = random_graph(strokes, random);
    const AllOrders all(graph);
    expect_as_all_orders(graph, all, random, met);
    const OrderProgram::Uses uses = OrderProgram(graph, {}).uses();
    ASSERT_EQ(uses.begins, all.uses.begins) << "trial " << trial;
    ASSERT_EQ(uses.ends, all.uses.ends) << "trial " << trial;
    if (HasFatalFailure()) FAIL() << "trial " << trial;
  }
  std::printf(
      "%d graphs, %d without a job; %lld orders, %lld of them cost what the one before does\n",
      met.graphs, met.without, static_cast<long long>(met.orders),
      static_cast<long long>(met.equal));
  for (std::size_t k = 1; k < 8; ++k) std::printf("%zu strokes: %d\n", k, of_strokes[k]);
  EXPECT_GE(met.orders, at_least(40'000));
  EXPECT_GE(met.equal, at_least(5'000));
}

}  // namespace
}  // namespace swivel
