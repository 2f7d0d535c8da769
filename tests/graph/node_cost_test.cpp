// SPDX-License-Identifier: BSD-3-Clause
// Costs of nodes that come in by and by, among removals: repaired values against a plain dynamic
// program over all that is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

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

TEST(NodeCosts, RepairedValuesAreThoseOfAPlainProgram) {
  const std::uint64_t base = seed("NodeCosts");
  Random random(base);
  int rounds = 0, raised = 0, dearer = 0, moved = 0, ended = 0, listed_rounds = 0, followed = 0;
  for (const TestRobot& robot : all_robots()) {
    const ArmModel arm = arm_of(robot);
    const SrsArm srs = fit_srs(arm.chain, robot.name);
    for (int trial = 0; trial < trials(robot.name == "windings" ? 4 : 16); ++trial) {
      Problem problem = problem_for(robot);
      const Config q0 = random_config(arm.chain, random);
      Config q1 = q0;
      for (int j = 0; j < kDof; ++j) q1[j] += random.uniform(-0.4, 0.4);
      problem.waypoints = {waypoint_of(arm.chain.tool(q0)), waypoint_of(arm.chain.tool(q1))};
      const double length = (problem.waypoints[0].position - problem.waypoints[1].position).norm();
      problem.resolution = {
          .ds = length / (2 + random.below(8)), .dphi = random.uniform(0.35, 0.5), .dalpha = 10};
      const bool open = random.coin(0.4);  // any arm angle may follow any other, as in a list
      problem.limits.arm_slope =
          open ? 1e6 : random.uniform(1, 3) * problem.resolution.dphi / problem.resolution.ds;
      problem.limits.joint_step = random.uniform(0.4, 1);
      if (random.coin(0.3)) problem.cost.metric = CostMetric::kMax;
      if (random.coin(0.3))
        for (double& weight : problem.cost.weights)
          weight = random.coin(0.2) ? 0 : random.uniform(0.1, 5);
      if (!open && random.coin()) problem.start = q0;
      problem.resolution.arcs = trial % 2 == 1;
      const ToolPath path(waypoints_in_base(problem), problem.resolution, "test");
      const SrsLattice lattice(arm.chain, srs, path, problem);

      std::vector<std::vector<int>> place(
          static_cast<std::size_t>(lattice.layers()));  // in the list, of each slot
      std::unique_ptr<ExplicitLattice> list;
      std::unique_ptr<CostToGo> listed;
      if (open) {
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
        list = std::make_unique<ExplicitLattice>(arm.chain, path, problem, std::move(points));
        listed = make_cost_to_go(*list);
        listed->sweep(list->layers() - 1);
      }
      GridCostToGo whole(lattice), bounded(lattice, Pruning::kByBound);
      whole.sweep(lattice.layers() - 1);
      bounded.sweep(lattice.layers() - 1);
      Values costs(place.size(),
                   std::vector<double>(static_cast<std::size_t>(lattice.width()), 0.0));
      SlotPath last;
      PathCache earlier;
      for (int round = 0; round < 14; ++round) {
        const std::string what = "SWIVEL_TEST_SEED " + std::to_string(base) + " " + robot.name +
                                 " trial " + std::to_string(trial) + " round " +
                                 std::to_string(round);
        ++rounds;
        const Values values = plain_values(lattice, whole.verdicts(), costs);
        const SlotPath best = plain_path(lattice, whole.verdicts(), values, costs);
        bool cut = false;  // a layer has no node: values say no more than that there is no path
        for (int layer = 0; layer < lattice.layers(); ++layer) cut = cut || !lattice.alive(layer);
        for (int layer = 0; layer < lattice.layers() && !cut; ++layer)
          for (int slot = 0; slot < lattice.width(); ++slot) {
            const double value =
                values[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)];
            ASSERT_EQ(whole.at(layer, slot), value)
                << what << " layer " << layer << " slot " << slot;
            ASSERT_GE(bounded.at(layer, slot), value) << what;
            const int k =
                open ? place[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)] : -1;
            if (k >= 0) {
              ASSERT_EQ(listed->at(layer, k), value)
                  << what << " layer " << layer << " slot " << slot;
            }
          }
        ASSERT_EQ(bounded.best(), whole.best()) << what;
        std::int64_t expansions = 0, fewer = 0;
        ASSERT_EQ(best_path(whole, expansions), best) << what;
        ASSERT_EQ(best_path(bounded, fewer, &earlier), best) << what;
        ASSERT_LE(fewer, expansions) << what;
        followed += fewer < expansions;
        earlier.add(best, bounded);
        ASSERT_EQ(best_path(bounded, expansions), best) << what;
        if (open) {
          ++listed_rounds;
          SlotPath there = best_path(*listed, expansions);
          ASSERT_EQ(there.size(), best.size()) << what;
          for (std::size_t i = 0; i < there.size(); ++i)
            ASSERT_EQ(there[i], place[i][static_cast<std::size_t>(best[i])]) << what;
        }
        if (best.empty()) {
          ++ended;
          break;
        }
        for (int layer = 0; layer < lattice.layers(); ++layer)
          ASSERT_EQ(bounded.at(layer, best[static_cast<std::size_t>(layer)]),
                    whole.at(layer, best[static_cast<std::size_t>(layer)]));
        moved += round > 0 && best != last;
        last = best;

        const auto each = [&](const auto& change) {
          change(static_cast<CostToGo&>(whole), [](int, int slot) { return slot; });
          change(static_cast<CostToGo&>(bounded), [](int, int slot) { return slot; });
          if (open)
            change(*listed, [&](int layer, int slot) {
              return place[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)];
            });
        };
        // Costs of the best path's nodes, or of some, and of those beside them; large ones, small
        // ones, none.
        const double scale =
            lattice.cost_unit() *
            std::array{1e-3, 0.02, 0.5, 100.0}[static_cast<std::size_t>(random.below(4))];
        const int reach = random.below(4);
        const double share = random.coin() ? 1 : 0.3;
        for (int layer = 0; layer < lattice.layers(); ++layer)
          for (int k = -reach; k <= reach; ++k) {
            const int n = lattice.angles(), slot = best[static_cast<std::size_t>(layer)];
            const int there =
                lattice.solution_of(slot) * n + ((lattice.angle_of(slot) + k) % n + n) % n;
            if (whole.verdicts().knows_cost(layer, there) || !lattice.node(layer, there) ||
                !random.coin(share))
              continue;
            const double cost =
                random.coin(0.2) ? 0 : lattice.rounded_cost(random.uniform(0, scale));
            costs[static_cast<std::size_t>(layer)][static_cast<std::size_t>(there)] = cost;
            raised += cost > 0;
            each([&](CostToGo& cost_to_go, const auto& number) {
              cost_to_go.verdicts().set_cost(layer, number(layer, there), cost);
            });
          }
        const int layer = random.below(lattice.layers());
        const auto i = static_cast<std::size_t>(layer);
        if (random.coin(0.3)) {
          each([&](CostToGo& cost_to_go, const auto& number) {
            cost_to_go.verdicts().remove_node(layer, number(layer, best[i]));
          });
        } else if (layer > 0 && random.coin(0.4)) {
          each([&](CostToGo& cost_to_go, const auto& number) {
            cost_to_go.remove_edge(layer - 1, number(layer - 1, best[i - 1]),
                                   number(layer, best[i]));
          });
        }
        const double before = whole.best();
        each([](CostToGo& cost_to_go, const auto&) { cost_to_go.repair(); });
        ASSERT_GE(whole.best(), before) << what;
        dearer += whole.best() > before;
      }
      // The furthest layer is the same whatever nodes cost.
      for (int slot = 0; slot < lattice.width(); ++slot)
        whole.verdicts().remove_node(lattice.layers() - 1, slot);
      const int deepest = whole.deepest_reachable();
      ASSERT_LT(deepest, lattice.layers() - 1);
      if (deepest < 0) continue;
      whole.sweep(deepest);
      ASSERT_NE(whole.best(), kUnreachable);
    }
  }
  std::printf(
      "%d rounds (%d on lists), %d costs, best path dearer %d times and another %d times, %d went "
      "on as an earlier one, %d ended "
      "without one\n",
      rounds, listed_rounds, raised, dearer, moved, followed, ended);
  EXPECT_GT(followed, at_least(rounds / 8));
  EXPECT_GT(rounds, at_least(300));
  EXPECT_GE(listed_rounds, at_least(60));
  EXPECT_GT(raised, 4 * rounds);
  EXPECT_GT(dearer, rounds / 4);
  EXPECT_GT(moved, rounds / 4);
}

}  // namespace
}  // namespace swivel
