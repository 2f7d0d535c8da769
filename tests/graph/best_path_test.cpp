// SPDX-License-Identifier: BSD-3-Clause
// The search by Boost.Graph against a plain descent: both go by the cost-to-go, the descent by one
// that is computed here.
#include <gtest/gtest.h>

#include <algorithm>

#include "answer_order.hpp"
#include "given_end.hpp"
#include "robots.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/graph/search/path_first.hpp"

namespace swivel {
namespace {

using namespace test;

/// Nodes of each layer that are not removed, and their costs to the last layer: every pair of nodes
/// compared.
struct PlainLattice {
  PlainLattice(const Lattice& lattice, const Verdicts& verdicts)
      : lattice_(lattice), verdicts_(verdicts) {
    nodes.resize(lattice.layers());
    cost_to_go.resize(lattice.layers());
    for (int layer = lattice.layers() - 1; layer >= 0; --layer) {
      lattice.layer_nodes(layer, nodes[layer]);
      std::erase_if(nodes[layer], [&](const auto& node) {
        return verdicts.node(layer, node.slot) == Verdict::kRemoved;
      });
      for (std::size_t a = 0; a < nodes[layer].size(); ++a) {
        double least = layer + 1 == lattice.layers() ? 0 : kUnreachable;
        for (std::size_t b = 0; layer + 1 < lattice.layers() && b < nodes[layer + 1].size(); ++b)
          least = std::min(least, cost(layer, a, b) + cost_to_go[layer + 1][b]);
        cost_to_go[layer].push_back(least);
      }
    }
  }
  /// Returns the cost from node a of a layer to node b of the next; kUnreachable where no edge
  /// joins them.
  [[nodiscard]] double cost(int layer, std::size_t a, std::size_t b) const {
    const Lattice::Node &from = nodes[layer][a], &to = nodes[layer + 1][b];
    const Config delta = lattice_.delta(from.q, to.q);
    const bool joined = lattice_.in_window(layer, from.slot, to.slot) &&
                        lattice_.step_allowed(layer, delta) &&
                        verdicts_.edge(layer, from.slot, to.slot) != Verdict::kRemoved;
    return joined ? lattice_.edge_cost(delta) : kUnreachable;
  }
  /// Returns the answer's path: it begins at the node of layer 0 that the order names and goes on
  /// to the first node that keeps the cost. `ties` counts the others that would, `chosen` the paths
  /// whose first node is not the first of layer 0 that has the least cost.
  [[nodiscard]] SlotPath descend(int& ties, int& chosen) const {
    SlotPath path;
    const int start =
        first_of_answer(lattice_, cost_to_go[0], [&](int k) { return nodes[0][k].q; });
    if (start < 0) return path;
    const auto least = std::min_element(cost_to_go[0].begin(), cost_to_go[0].end());
    ties += static_cast<int>(std::count(least, cost_to_go[0].end(), *least)) - 1;
    chosen += start != least - cost_to_go[0].begin();
    std::size_t here = start;
    double left = cost_to_go[0][here];
    path.push_back(nodes[0][here].slot);
    for (int layer = 1; layer < lattice_.layers(); ++layer) {
      std::optional<std::size_t> first;
      for (std::size_t b = 0; b < nodes[layer].size(); ++b) {
        if (cost(layer - 1, here, b) + cost_to_go[layer][b] != left) continue;
        if (first) ++ties;
        if (!first) first = b;
      }
      here = first.value();
      left = cost_to_go[layer][here];
      path.push_back(nodes[layer][here].slot);
    }
    return path;
  }

  std::vector<std::vector<Lattice::Node>> nodes;
  std::vector<std::vector<double>> cost_to_go;

 private:
  const Lattice& lattice_;
  const Verdicts& verdicts_;
};

/// Returns a problem of some four steps between two random poses near one another.
PathProblem random_problem(const TestRobot& robot, const Chain& chain, Random& random) {
  const Config q0 = random_config(chain, random);
  Config q1 = q0;
  for (int j = 0; j < kDof; ++j) q1[j] += random.uniform(-0.25, 0.25);
  PathProblem problem = problem_for(robot);
  problem.waypoints = {waypoint_of(chain.tool(q0)), waypoint_of(chain.tool(q1))};
  const double length = (problem.waypoints[0].position - problem.waypoints[1].position).norm();
  problem.resolution = {.ds = length / 4,
                        .dphi = robot.name == "windings" ? 0.5 : random.uniform(0.2, 0.35),
                        .dalpha = 10};
  problem.limits.arm_slope = 2 * problem.resolution.dphi / problem.resolution.ds;
  problem.limits.joint_step = random.uniform(0.3, 0.6);
  problem.cost.metric = random.one_of({CostMetric::kL2, CostMetric::kL1, CostMetric::kMax});
  if (random.coin(0.2))
    problem.cost.weights = {0, 0, 0, 0, 0, 0, 0};  // all paths are equal, the first one wins
  if (random.coin(0.3)) problem.start = q0;
  if (random.coin(0.3)) end_at(problem, chain, q1);
  return problem;
}

/// Counts what the rounds met.
struct Rounds {
  int found = 0, none = 0, ties = 0, chosen = 0, changed = 0, followed = 0;
};

/// Removes a node of the path or an edge of it, drawn by `random`, and repairs the values.
void remove_from(const SlotPath& path, CostToGo& cost_to_go, Random& random) {
  const int layer = random.below(cost_to_go.lattice().layers() - 1);
  if (random.coin())
    cost_to_go.verdicts().remove_node(layer, path[layer]);
  else
    cost_to_go.remove_edge(layer, path[layer], path[layer + 1]);
  cost_to_go.repair();
}

/// Expects the best path to be that of the plain descent, in up to eight rounds with a removal
/// after each of them.
void expect_plain_paths(const Lattice& lattice, CostToGo& cost_to_go, Random& random,
                        const std::string& trial, Rounds& rounds) {
  PathCache earlier;
  for (int round = 0; round < 8; ++round) {
    const std::string what = trial + " round " + std::to_string(round);
    const SlotPath wanted =
        PlainLattice(lattice, cost_to_go.verdicts()).descend(rounds.ties, rounds.chosen);
    std::int64_t expansions = 0;
    ASSERT_EQ(best_path(cost_to_go, expansions), wanted) << what;
    ++(wanted.empty() ? rounds.none : rounds.found);
    if (wanted.empty()) break;
    ASSERT_EQ(expansions, lattice.layers()) << what;  // no vertex beside the path
    std::int64_t fewer = 0;
    ASSERT_EQ(best_path(cost_to_go, fewer, &earlier), wanted) << what;
    ASSERT_LE(fewer, expansions) << what;
    rounds.followed += fewer < expansions;
    earlier.add(wanted, cost_to_go);
    const double before = cost_to_go.best();
    remove_from(wanted, cost_to_go, random);
    rounds.changed += cost_to_go.best() != before;
  }
}

TEST(BestPath, IsThatOfAPlainDescent) {
  const std::uint64_t base = seed("BestPath");
  const auto robots = all_robots();
  Rounds rounds;
  const int count = trials(120);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + trial);
    const TestRobot& robot = robots[trial % robots.size()];
    const ArmModel arm = arm_of(robot);
    const SrsArm srs = fit_srs(arm.chain, robot.name);
    PathProblem problem = random_problem(robot, arm.chain, random);
    problem.resolution.arcs = trial % 2 == 1;
    const ToolPath path(waypoints_in_base(problem), problem.resolution, "test");
    const SrsLattice lattice(arm.chain, srs, path, problem);
    const auto cost_to_go =
        make_cost_to_go(lattice, random.coin() ? Pruning::kNone : Pruning::kByBound);
    cost_to_go->sweep(lattice.layers() - 1);
    expect_plain_paths(lattice, *cost_to_go, random,
                       "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                           std::to_string(trial) + " robot " + robot.name,
                       rounds);
    if (HasFatalFailure()) return;
  }
  const auto& [found, none, ties, chosen, changed, followed] = rounds;
  std::printf(
      "%d paths, %d lattices without one; %d ties, %d starts chosen among them, %d removals "
      "changed the optimum, %d paths went on "
      "as an earlier one\n",
      found, none, ties, chosen, changed, followed);
  EXPECT_GE(chosen, at_least_among(count / 4 + 1));
  EXPECT_GE(found, 2 * count);
  EXPECT_GE(ties, at_least_among(count + 1));
  EXPECT_GE(changed, at_least_among(count / 4 + 1));
  EXPECT_GE(followed, at_least_among(count / 4 + 1));
}

TEST(BestPath, FollowsNoEarlierOneWhereSumsAreRounded) {
  const TestRobot robot = all_robots().front();
  const ArmModel arm = arm_of(robot);
  const SrsArm srs = fit_srs(arm.chain, robot.name);
  Random random(seed("BestPath.Rounded"));
  const Config q0 = random_config(arm.chain, random);
  PathProblem problem = problem_for(robot);
  problem.waypoints = {waypoint_of(arm.chain.tool(q0)), waypoint_of(arm.chain.tool(q0))};
  problem.waypoints[1].position.x() += 0.02;
  problem.resolution = {.ds = 0.001, .dphi = 0.2, .dalpha = 10};
  problem.limits.arm_slope = 2 * problem.resolution.dphi / problem.resolution.ds;
  const ToolPath path(waypoints_in_base(problem), problem.resolution, "test");
  const SrsLattice lattice(arm.chain, srs, path, problem);
  ASSERT_GT(lattice.layers(), 9);
  for (const double units : {1.0, 1000.0}) {  // of each node; in sum some 20, or more than kExact
    const auto cost_to_go = make_cost_to_go(lattice);
    for (int layer = 0; layer < lattice.layers(); ++layer)
      for (int slot = 0; slot < lattice.width(); ++slot)
        cost_to_go->verdicts().set_cost(layer, slot, units * lattice.cost_unit());
    cost_to_go->sweep(lattice.layers() - 1);
    PathCache earlier;
    std::int64_t first = 0, again = 0;
    const SlotPath best = best_path(*cost_to_go, first, &earlier);
    ASSERT_EQ(first, lattice.layers());
    earlier.add(best, *cost_to_go);
    EXPECT_EQ(best_path(*cost_to_go, again, &earlier), best);
    EXPECT_EQ(again, units < 2 ? 1 : lattice.layers());
  }
}

}  // namespace
}  // namespace swivel
