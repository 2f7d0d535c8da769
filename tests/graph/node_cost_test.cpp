// SPDX-License-Identifier: BSD-3-Clause
// Costs of nodes that come in by and by, among removals: repaired values against a plain dynamic
// program over all that is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "answer_order.hpp"
#include "cost_to_go/grid/grid_cost_to_go.hpp"
#include "robots.hpp"
#include "swivel/core/lattice/explicit_lattice.hpp"
#include "swivel/graph/search/path_first.hpp"

namespace swivel {
namespace {

using namespace test;

using Values = std::vector<std::vector<double>>;  // [layer][slot]

/// The definition: what a node costs, and the least of the edges' costs and the values of their
/// heads.
Values plain_values(const Lattice& lattice, const Verdicts& verdicts, const Values& costs) {
  const auto layers = static_cast<std::size_t>(lattice.layers());
  Values values(layers);
  std::vector<Lattice::Node> nodes, next;
  std::vector<Lattice::SlotRun> runs;
  for (std::size_t i = layers; i-- > 0; next.swap(nodes)) {
    const int layer = static_cast<int>(i);
    values[i].assign(static_cast<std::size_t>(lattice.slots(layer)), kUnreachable);
    lattice.layer_nodes(layer, nodes);
    for (const Lattice::Node& a : nodes) {
      double& value = values[i][static_cast<std::size_t>(a.slot)];
      if (verdicts.node(layer, a.slot) == Verdict::kRemoved) continue;
      if (i + 1 == layers) {
        value = costs[i][static_cast<std::size_t>(a.slot)];
        continue;
      }
      for (const Lattice::Node& b : next) {
        const Config delta = lattice.delta(a.q, b.q);
        if (!lattice.in_window(layer, a.slot, b.slot) || !lattice.step_allowed(layer, delta) ||
            verdicts.edge(layer, a.slot, b.slot) == Verdict::kRemoved)
          continue;
        value =
            std::min(value, costs[i][static_cast<std::size_t>(a.slot)] + lattice.edge_cost(delta) +
                                values[i + 1][static_cast<std::size_t>(b.slot)]);
      }
    }
  }
  return values;
}

/// Returns the path from the node that the answer begins at, by the smallest slots among those with
/// the best values.
SlotPath plain_path(const Lattice& lattice, const Verdicts& verdicts, const Values& values,
                    const Values& costs) {
  const int start =
      first_of_answer(lattice, values[0], [&](int slot) { return *lattice.node(0, slot); });
  if (start < 0) return {};
  SlotPath path{start};
  for (int layer = 1; layer < lattice.layers(); ++layer) {
    const auto i = static_cast<std::size_t>(layer);
    int found = -1;
    double least = kUnreachable;
    for (int slot = 0; slot < lattice.slots(layer); ++slot) {
      double total = values[i][static_cast<std::size_t>(slot)];
      if (total == kUnreachable) continue;
      const int a = path.back();
      const Config delta = lattice.delta(*lattice.node(layer - 1, a), *lattice.node(layer, slot));
      if (!lattice.in_window(layer - 1, a, slot) || !lattice.step_allowed(layer - 1, delta) ||
          verdicts.edge(layer - 1, a, slot) == Verdict::kRemoved)
        continue;
      total += costs[i - 1][static_cast<std::size_t>(a)] + lattice.edge_cost(delta);
      if (total < least) least = total, found = slot;
    }
    if (found < 0) return {};
    path.push_back(found);
  }
  return path;
}

/// A random problem of few steps; where it is open, any arm angle may follow any other, as in a
/// list.
struct RandomProblem {
  RandomProblem(const TestRobot& robot, const Chain& chain, Random& random)
      : problem(problem_for(robot)) {
    const Config q0 = random_config(chain, random);
    Config q1 = q0;
    for (int j = 0; j < kDof; ++j) q1[j] += random.uniform(-0.4, 0.4);
    problem.waypoints = {waypoint_of(chain.tool(q0)), waypoint_of(chain.tool(q1))};
    const double length = (problem.waypoints[0].position - problem.waypoints[1].position).norm();
    problem.resolution = {
        .ds = length / (2 + random.below(8)), .dphi = random.uniform(0.35, 0.5), .dalpha = 10};
    open = random.coin(0.4);
    problem.limits.arm_slope =
        open ? 1e6 : random.uniform(1, 3) * problem.resolution.dphi / problem.resolution.ds;
    problem.limits.joint_step = random.uniform(0.4, 1);
    if (random.coin(0.4)) problem.cost.metric = random.one_of({CostMetric::kL1, CostMetric::kMax});
    if (random.coin(0.3))
      for (double& weight : problem.cost.weights.emplace())
        weight = random.coin(0.2) ? 0 : random.uniform(0.1, 5);
    if (!open && random.coin()) problem.start = q0;
  }

  PathProblem problem;
  bool open = false;
};

/// The nodes of an open lattice as a list, and their costs-to-go.
struct Listed {
  Listed(const SrsLattice& lattice, const Chain& chain, const ToolPath& path,
         const PathProblem& problem)
      : place(static_cast<std::size_t>(lattice.layers())) {
    std::vector<std::vector<ExplicitLattice::Point>> points(place.size());
    std::vector<Lattice::Node> nodes;
    for (std::size_t i = 0; i < place.size(); ++i) {
      place[i].assign(static_cast<std::size_t>(lattice.width()), -1);
      lattice.layer_nodes(static_cast<int>(i), nodes);
      for (const Lattice::Node& node : nodes) {
        place[i][static_cast<std::size_t>(node.slot)] = static_cast<int>(points[i].size());
        points[i].push_back({.q = node.q});
      }
    }
    list = std::make_unique<ExplicitLattice>(chain, path, problem, std::move(points));
    cost_to_go = make_cost_to_go(*list);
    cost_to_go->sweep(list->layers() - 1);
  }
  /// Returns the number in the list of a node of the lattice; -1 where the slot has no node.
  [[nodiscard]] int number(int layer, int slot) const {
    return place[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)];
  }

  std::vector<std::vector<int>> place;  // in the list, of each slot
  std::unique_ptr<ExplicitLattice> list;
  std::unique_ptr<CostToGo> cost_to_go;
};

/// The costs-to-go of one lattice: swept whole, bounded, and where it is open on a list; and the
/// costs of nodes that they were told.
struct Tables {
  explicit Tables(const SrsLattice& of)
      : lattice(of),
        whole(of),
        bounded(of, Pruning::kByBound),
        costs(static_cast<std::size_t>(of.layers()),
              std::vector<double>(static_cast<std::size_t>(of.width()), 0.0)) {
    whole.sweep(lattice.layers() - 1);
    bounded.sweep(lattice.layers() - 1);
  }
  /// Calls `change` with every table and a function that turns layer and slot of the lattice into
  /// the slot of the table.
  template <class Change>
  void each(const Change& change) {
    change(static_cast<CostToGo&>(whole), [](int, int slot) { return slot; });
    change(static_cast<CostToGo&>(bounded), [](int, int slot) { return slot; });
    if (listed)
      change(*listed->cost_to_go,
             [this](int layer, int slot) { return listed->number(layer, slot); });
  }

  const SrsLattice& lattice;
  std::optional<Listed> listed;
  GridCostToGo whole, bounded;
  Values costs;
};

/// Counts what the rounds met.
struct Rounds {
  int rounds = 0, raised = 0, dearer = 0, moved = 0, ended = 0, listed_rounds = 0, followed = 0;
};

/// Expects the tables to have the plain values; the bounded one may have larger ones.
void expect_plain_values(const Tables& tables, const Values& values, const std::string& what) {
  const SrsLattice& lattice = tables.lattice;
  bool cut = false;  // a layer has no node: values say no more than that there is no path
  for (int layer = 0; layer < lattice.layers(); ++layer) cut = cut || !lattice.alive(layer);
  for (int layer = 0; layer < lattice.layers() && !cut; ++layer)
    for (int slot = 0; slot < lattice.width(); ++slot) {
      const double value = values[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)];
      ASSERT_EQ(tables.whole.at(layer, slot), value)
          << what << " layer " << layer << " slot " << slot;
      ASSERT_GE(tables.bounded.at(layer, slot), value) << what;
      const int k = tables.listed ? tables.listed->number(layer, slot) : -1;
      if (k >= 0) {
        ASSERT_EQ(tables.listed->cost_to_go->at(layer, k), value)
            << what << " layer " << layer << " slot " << slot;
      }
    }
  ASSERT_EQ(tables.bounded.best(), tables.whole.best()) << what;
}

/// Expects every table to have the best path of the plain program, the bounded one also where it
/// goes on as an earlier one.
void expect_plain_path(Tables& tables, const SlotPath& best, PathCache& earlier,
                       const std::string& what, Rounds& counts) {
  std::int64_t expansions = 0, fewer = 0;
  ASSERT_EQ(best_path(tables.whole, expansions), best) << what;
  ASSERT_EQ(best_path(tables.bounded, fewer, &earlier), best) << what;
  ASSERT_LE(fewer, expansions) << what;
  counts.followed += fewer < expansions;
  earlier.add(best, tables.bounded);
  ASSERT_EQ(best_path(tables.bounded, expansions), best) << what;
  if (tables.listed) {
    ++counts.listed_rounds;
    SlotPath there = best_path(*tables.listed->cost_to_go, expansions);
    ASSERT_EQ(there.size(), best.size()) << what;
    for (std::size_t i = 0; i < there.size(); ++i)
      ASSERT_EQ(there[i], tables.listed->number(static_cast<int>(i), best[i])) << what;
  }
  for (int layer = 0; !best.empty() && layer < tables.lattice.layers(); ++layer)
    ASSERT_EQ(tables.bounded.at(layer, best[static_cast<std::size_t>(layer)]),
              tables.whole.at(layer, best[static_cast<std::size_t>(layer)]));
}

/// Sets costs of the best path's nodes, or of some, and of those beside them; large ones, small
/// ones, none.
void raise_costs(const SlotPath& best, Tables& tables, Random& random, Rounds& counts) {
  const SrsLattice& lattice = tables.lattice;
  const double scale =
      lattice.cost_unit() *
      std::array{1e-3, 0.02, 0.5, 100.0}[static_cast<std::size_t>(random.below(4))];
  const int reach = random.below(4);
  const double share = random.coin() ? 1 : 0.3;
  for (int layer = 0; layer < lattice.layers(); ++layer)
    for (int k = -reach; k <= reach; ++k) {
      const int n = lattice.angles(), slot = best[static_cast<std::size_t>(layer)];
      const int there = lattice.solution_of(slot) * n + ((lattice.angle_of(slot) + k) % n + n) % n;
      if (tables.whole.verdicts().knows_cost(layer, there) || !lattice.node(layer, there) ||
          !random.coin(share))
        continue;
      const double cost = random.coin(0.2) ? 0 : lattice.rounded_cost(random.uniform(0, scale));
      tables.costs[static_cast<std::size_t>(layer)][static_cast<std::size_t>(there)] = cost;
      counts.raised += cost > 0;
      tables.each([&](CostToGo& cost_to_go, const auto& number) {
        cost_to_go.verdicts().set_cost(layer, number(layer, there), cost);
      });
    }
}

/// Removes a node of the best path, an edge of it, or nothing.
void remove_some(const SlotPath& best, Tables& tables, Random& random) {
  const int layer = random.below(tables.lattice.layers());
  const auto i = static_cast<std::size_t>(layer);
  if (random.coin(0.3)) {
    tables.each([&](CostToGo& cost_to_go, const auto& number) {
      cost_to_go.verdicts().remove_node(layer, number(layer, best[i]));
    });
  } else if (layer > 0 && random.coin(0.4)) {
    tables.each([&](CostToGo& cost_to_go, const auto& number) {
      cost_to_go.remove_edge(layer - 1, number(layer - 1, best[i - 1]), number(layer, best[i]));
    });
  }
}

/// Expects the tables to agree with the plain program in up to 14 rounds, with costs and removals
/// after each of them; `trial` tells the problem.
void expect_plain_program(Tables& tables, const std::string& trial, Random& random,
                          Rounds& counts) {
  GridCostToGo& whole = tables.whole;
  SlotPath last;
  PathCache earlier;
  for (int round = 0; round < 14; ++round) {
    const std::string what = trial + " round " + std::to_string(round);
    ++counts.rounds;
    const Values values = plain_values(tables.lattice, whole.verdicts(), tables.costs);
    const SlotPath best = plain_path(tables.lattice, whole.verdicts(), values, tables.costs);
    expect_plain_values(tables, values, what);
    if (::testing::Test::HasFatalFailure()) return;
    expect_plain_path(tables, best, earlier, what, counts);
    if (::testing::Test::HasFatalFailure()) return;
    if (best.empty()) {
      ++counts.ended;
      break;
    }
    counts.moved += round > 0 && best != last;
    last = best;

    raise_costs(best, tables, random, counts);
    remove_some(best, tables, random);
    const double before = whole.best();
    tables.each([](CostToGo& cost_to_go, const auto&) { cost_to_go.repair(); });
    ASSERT_GE(whole.best(), before) << what;
    counts.dearer += whole.best() > before;
  }
}

/// Removes the last layer and expects a path to the furthest layer that is left, which is the same
/// whatever nodes cost.
void expect_path_to_furthest_layer(GridCostToGo& whole) {
  const SrsLattice& lattice = whole.lattice();
  for (int slot = 0; slot < lattice.width(); ++slot)
    whole.verdicts().remove_node(lattice.layers() - 1, slot);
  const int deepest = whole.deepest_reachable();
  ASSERT_LT(deepest, lattice.layers() - 1);
  if (deepest < 0) return;
  whole.sweep(deepest);
  ASSERT_NE(whole.best(), kUnreachable);
}

TEST(NodeCosts, RepairedValuesAreThoseOfAPlainProgram) {
  const std::uint64_t base = seed("NodeCosts");
  Random random(base);
  Rounds counts;
  for (const TestRobot& robot : all_robots()) {
    const ArmModel arm = arm_of(robot);
    const SrsArm srs = fit_srs(arm.chain, robot.name);
    for (int trial = 0; trial < trials(robot.name == "windings" ? 4 : 16); ++trial) {
      auto [problem, open] = RandomProblem(robot, arm.chain, random);
      problem.resolution.arcs = trial % 2 == 1;
      const ToolPath path(waypoints_in_base(problem), problem.resolution, "test");
      const SrsLattice lattice(arm.chain, srs, path, problem);
      Tables tables(lattice);
      if (open) tables.listed.emplace(lattice, arm.chain, path, problem);
      expect_plain_program(tables,
                           "SWIVEL_TEST_SEED " + std::to_string(base) + " " + robot.name +
                               " trial " + std::to_string(trial),
                           random, counts);
      if (HasFatalFailure()) return;
      expect_path_to_furthest_layer(tables.whole);
      if (HasFatalFailure()) return;
    }
  }
  const auto& [rounds, raised, dearer, moved, ended, listed_rounds, followed] = counts;
  std::printf(
      "%d rounds (%d on lists), %d costs, best path dearer %d times and another %d times, %d went "
      "on as an earlier one, %d ended "
      "without one\n",
      rounds, listed_rounds, raised, dearer, moved, followed, ended);
  EXPECT_GT(followed, at_least_among(rounds / 8));
  EXPECT_GT(rounds, at_least(300));
  EXPECT_GE(listed_rounds, at_least(60));
  EXPECT_GT(raised, 4 * rounds);
  EXPECT_GT(dearer, rounds / 4);
  EXPECT_GT(moved, rounds / 4);
}

}  // namespace
}  // namespace swivel
