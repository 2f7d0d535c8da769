// SPDX-License-Identifier: BSD-3-Clause
// The cheapest way on from the end of a run, found by boxes, against all pairs of nodes.
#include "search/transition_costs.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "robots.hpp"
#include "swivel/core/lattice/explicit_lattice.hpp"

namespace swivel {
namespace {

using namespace test;

/// Transitions that are all free.
class FreeTransitions : public Transitions {
 public:
  explicit FreeTransitions(const Lattice& metric) : metric_(&metric) {}
  [[nodiscard]] double distance(const Config& from, const Config& to) const override {
    return metric_->edge_cost(metric_->delta(from, to));
  }
  [[nodiscard]] double least_distance(const Config& from, const Config& lower,
                                      const Config& upper) const override {
    return metric_->edge_cost(metric_->least_delta(from, lower, upper));
  }
  void find_barred(std::span<const Config>, std::span<std::uint8_t>) override {}
  void find(std::span<const TransitionQuestion>, std::span<TransitionAnswer>) override {}

 private:
  const Lattice* metric_;
};

/// How often the test met what.
struct Met {
  int asked = 0, ties = 0, unreachable = 0;
};

/// Draws nodes; on a coarse grid many ways cost the same.
std::vector<EndNode> random_nodes(const Chain& chain, int count, bool grid, Random& random) {
  std::vector<EndNode> nodes;
  for (int slot = 0; slot < count; ++slot) {
    EndNode& node = nodes.emplace_back(EndNode{0, slot, random_config(chain, random)});
    if (grid)
      for (int j = 0; j < kDof; ++j) node.q[j] = 0.5 * (random.below(9) - 4);
  }
  return nodes;
}

/// Raises and bars some pairs and nodes.
void raise_some(TransitionCosts& costs, Random& random) {
  const auto any = [&](std::size_t count) {
    return static_cast<std::size_t>(random.below(static_cast<int>(count)));
  };
  for (std::size_t k = 0; k < costs.nodes(Side::kBegin).size() / 4; ++k) {
    const std::size_t end = any(costs.nodes(Side::kEnd).size()),
                      begin = any(costs.nodes(Side::kBegin).size());
    if (random.coin(0.2)) costs.bar(Side::kBegin, begin);
    costs.raise(end, begin, random.coin(0.3) ? kUnreachable : costs.at(end, begin) + 0.5);
  }
  if (random.coin(0.3)) costs.bar(Side::kEnd, any(costs.nodes(Side::kEnd).size()));
}

void expect_best_of_all_pairs(const TransitionCosts& costs, Met& met) {
  for (std::size_t end = 0; end < costs.nodes(Side::kEnd).size(); ++end) {
    TransitionCosts::Onward best;
    int equal = 0;
    for (std::size_t begin = 0; begin < costs.nodes(Side::kBegin).size(); ++begin) {
      const double cost = costs.at(end, begin) + costs.rest(begin);
      if (cost == kUnreachable) continue;
      equal = cost < best.cost ? 1 : equal + (cost == best.cost);
      if (cost < best.cost || (cost == best.cost && costs.rest(begin) < costs.rest(best.begin)))
        best = {begin, cost};
    }
    const TransitionCosts::Onward found = costs.onward(end);
    ASSERT_EQ(found.cost, best.cost);
    if (best.cost != kUnreachable) {
      ASSERT_EQ(found.begin, best.begin);
    }
    ++met.asked;
    met.ties += equal > 1;
    met.unreachable += best.cost == kUnreachable;
  }
}

void expect_best_ways(const Chain& chain, const Lattice& metric, Random& random, Met& met) {
  const FreeTransitions transitions(metric);
  for (int trial = 0; trial < trials(20); ++trial) {
    const bool grid = random.coin(0.5);
    TransitionCosts costs(
        transitions, random_nodes(chain, 20, grid, random),
        random_nodes(chain, 1 + random.below(trial % 2 == 0 ? 20 : 1000), grid, random));
    std::vector<double> rest;
    for (std::size_t k = 0; k < costs.nodes(Side::kBegin).size(); ++k)
      rest.push_back(random.coin(0.1) ? kUnreachable
                     : grid           ? 0.5 * random.below(6)
                                      : random.uniform(0, 10));
    costs.set_rest(rest);
    raise_some(costs, random);
    expect_best_of_all_pairs(costs, met);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

TEST(TransitionCosts, TheCheapestWayOnIsThatOfAllPairs) {
  const std::uint64_t base = seed("TransitionCosts");
  SCOPED_TRACE("SWIVEL_TEST_SEED " + std::to_string(base));
  Random random(base);
  Met met;
  for (const TestRobot& robot : all_robots()) {
    const ArmModel arm = arm_of(robot);
    PathProblem problem = problem_for(robot);
    const Config q0 = random_config(arm.chain, random);
    problem.waypoints = {waypoint_of(arm.chain.tool(q0)),
                         waypoint_of(arm.chain.tool(q0 + Config::Constant(0.05)))};
    const ToolPath path(waypoints_in_base(problem), problem.resolution, "test");
    for (const CostMetric metric : {CostMetric::kL2, CostMetric::kL1, CostMetric::kMax}) {
      problem.cost.metric = metric;
      std::vector<std::vector<ExplicitLattice::Point>> points(
          static_cast<std::size_t>(path.size()));
      for (auto& layer : points) layer.push_back({.q = q0});
      const ExplicitLattice lattice(arm.chain, path, problem, std::move(points));
      expect_best_ways(arm.chain, lattice, random, met);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
  std::printf("%d ends, %d with several cheapest ways on, %d with none\n", met.asked, met.ties,
              met.unreachable);
  EXPECT_GE(met.asked, at_least(2000));
  EXPECT_GE(met.ties, at_least(50));
  EXPECT_GE(met.unreachable, at_least(10));
}

}  // namespace
}  // namespace swivel
