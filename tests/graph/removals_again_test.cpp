// SPDX-License-Identifier: BSD-3-Clause
// A cost-to-go that begins again, with nearly the removals that it had before, against the
// cost-to-go of a fresh sweep.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "axes_robots.hpp"
#include "random_problem.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {
namespace {

using namespace test;

/// Nodes and edges that a plan removes.
struct Removals {
  std::vector<std::pair<int, int>> nodes;  // layer and slot
  struct Edge {
    int layer, a, b;
    bool operator==(const Edge&) const = default;
  };
  std::vector<Edge> edges;
};

int random_slot(const Lattice& lattice, int layer, Random& random) {
  std::vector<Lattice::Node> nodes;
  lattice.layer_nodes(layer, nodes);
  return nodes.empty()
             ? -1
             : nodes[static_cast<std::size_t>(random.below(static_cast<int>(nodes.size())))].slot;
}

/// Removes some more nodes, and edges that join two nodes.
void add_some(const Lattice& lattice, int nodes, Random& random, Removals& removals) {
  for (int k = 0; k < nodes; ++k) {
    const int layer = random.below(lattice.layers()), slot = random_slot(lattice, layer, random);
    if (slot >= 0 &&
        std::count(removals.nodes.begin(), removals.nodes.end(), std::pair(layer, slot)) == 0)
      removals.nodes.emplace_back(layer, slot);
    const int tail = random.below(lattice.layers() - 1), a = random_slot(lattice, tail, random),
              b = random_slot(lattice, tail + 1, random);
    if (a < 0 || b < 0 || !lattice.in_window(tail, a, b)) continue;
    const Removals::Edge edge{tail, a, b};
    if (std::count(removals.edges.begin(), removals.edges.end(), edge) == 0)
      removals.edges.push_back(edge);
  }
}

/// Takes back each removal with a probability.
void take_back_some(double share, Random& random, Removals& removals) {
  std::erase_if(removals.nodes, [&](const auto&) { return random.coin(share); });
  std::erase_if(removals.edges, [&](const auto&) { return random.coin(share); });
}

void remove_all(const Removals& removals, CostToGo& values) {
  for (const auto& [layer, slot] : removals.nodes) values.verdicts().remove_node(layer, slot);
  for (const Removals::Edge& edge : removals.edges)
    if (values.verdicts().edge(edge.layer, edge.a, edge.b) != Verdict::kRemoved)
      values.remove_edge(edge.layer, edge.a, edge.b);
}

/// Compares all values; on a grid of arm angles at every layer, where those that lie on no best
/// path may differ, the best alone.
void expect_same_values(const CostToGo& values, const CostToGo& fresh, const std::string& what) {
  ASSERT_EQ(values.best(), fresh.best()) << what;
  const Lattice& lattice = values.lattice();
  if (dynamic_cast<const SrsLattice*>(&lattice)) return;
  for (int layer = 0; layer < lattice.layers(); ++layer)
    for (int slot = 0; slot < lattice.slots(layer); ++slot)
      ASSERT_EQ(values.at(layer, slot), fresh.at(layer, slot))
          << what << " layer " << layer << " slot " << slot;
}

struct Counts {
  int lattices = 0, rounds = 0, cheaper = 0;
  std::int64_t edges = 0, fresh_edges = 0;
};

/// Begins again a few times, each time with some removals more and some fewer.
void begin_again(const Lattice& lattice, Random& random, const std::string& what, Counts& counts) {
  const auto values = make_cost_to_go(lattice);
  values->sweep(lattice.layers() - 1);
  Removals removals;
  add_some(lattice, 10 + random.below(40), random, removals);
  for (int round = 0; round < 5; ++round) {
    if (round > 0) {
      ASSERT_TRUE(values->restart({})) << what;
    }
    remove_all(removals, *values);
    const std::int64_t before = values->edges();
    values->repair();
    const std::int64_t after = values->edges();
    const auto fresh = make_cost_to_go(lattice);
    remove_all(removals, *fresh);
    fresh->sweep(lattice.layers() - 1);
    expect_same_values(*values, *fresh, what + " round " + std::to_string(round));
    if (::testing::Test::HasFatalFailure()) return;
    ++counts.rounds;
    counts.edges += after - before;
    const auto repaired = make_cost_to_go(lattice);
    repaired->sweep(lattice.layers() - 1);
    const std::int64_t swept = repaired->edges();
    remove_all(removals, *repaired);
    repaired->repair();
    counts.fresh_edges += repaired->edges() - swept;
    counts.cheaper += after - before < repaired->edges() - swept;
    if (random.coin(0.3)) {  // what a plan finds out later
      add_some(lattice, 3, random, removals);
      remove_all(removals, *values);
      values->repair();
    }
    take_back_some(random.coin() ? 0 : random.uniform(0, 0.3), random, removals);
    if (random.coin(0.7)) add_some(lattice, random.below(6), random, removals);
  }
  ++counts.lattices;
}

TEST(RemovalsAgain, GiveTheValuesOfAFreshSweep) {
  const std::uint64_t base = seed("RemovalsAgain");
  std::vector<TestRobot> robots{slide_robots()[0]};
  for (const char* const name : {"panda_like", "gen3_like", "fetch_like", "iiwa14"}) {
    robots.push_back(data_robot(name));
    if (robots.back().name != "iiwa14") robots.back().tip_link = "flange";
  }
  Counts counts;
  const int count = trials(80);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const TestRobot& robot = robots[static_cast<std::size_t>(trial) % robots.size()];
    PathProblem problem = random_problem(robot, random);
    problem.limits.arm_slope = Limits().arm_slope;
    problem.limits.step_error.reset();
    problem.start.reset();  // else values are bounded, and not kept
    problem.limits.joint_step = random.uniform(0.1, 0.4);
    (has_arm_angle(robot) ? problem.resolution.dphi : problem.resolution.arc) = 0.3;
    problem.resolution.dalpha = 0.5;
    if (has_arm_angle(robot) && random.coin()) {
      problem.roll = Roll{-0.7, 0.7};
      problem.cost.roll = random.coin() ? 1 : 0;
    }
    problem.resolution.knot = random.coin(0.3) ? 0 : 4 * problem.resolution.ds;
    const Chain chain = arm_of(robot).chain;
    const ArmClass arm_class = classify(chain, robot.name);
    const ToolPath path = problem_path(problem, chain);
    const auto lattice = make_lattice(chain, arm_class, path, problem);
    if (lattice->nodes() == 0 || lattice->layers() < 2) continue;
    begin_again(*lattice, random,
                "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                    " robot " + robot.name,
                counts);
    if (HasFatalFailure()) return;
  }
  std::printf("%d lattices, %d rounds, in %d fewer edges; %lld edges where %lld are from nothing\n",
              counts.lattices, counts.rounds, counts.cheaper, static_cast<long long>(counts.edges),
              static_cast<long long>(counts.fresh_edges));
  EXPECT_GE(counts.lattices, at_least_among(count / 2));
  EXPECT_GE(counts.cheaper, at_least_among(counts.rounds / 4));
}

}  // namespace
}  // namespace swivel
