// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "cost_to_go/grid/grid_cost_to_go.hpp"
#include "given_end.hpp"
#include "robots.hpp"
#include "swivel/graph/lattice_graph/implicit_lattice.hpp"
#include "window.hpp"

namespace swivel {
namespace {

using namespace test;

struct Edge {
  int b;
  double cost;
  bool operator==(const Edge&) const = default;
};

/// Successors of a by brute force over all pairs, by the definition: own window, own joint steps.
std::vector<Edge> brute_force(const SrsLattice& lattice, int layer, int a,
                              const std::vector<std::optional<Config>>& here,
                              const std::vector<std::optional<Config>>& next) {
  std::vector<Edge> edges;
  for (int b = 0; b < lattice.width(); ++b) {
    if (!here[static_cast<std::size_t>(a)] || !next[static_cast<std::size_t>(b)]) continue;
    if (!window_allows(lattice, layer, a, b)) continue;
    Config delta = *next[static_cast<std::size_t>(b)] - *here[static_cast<std::size_t>(a)];
    bool allowed = true;
    for (int j = 0; j < kDof; ++j) {
      if (lattice.chain().limit[static_cast<std::size_t>(j)].continuous)
        delta[j] = std::remainder(delta[j], kTwoPi);
      allowed = allowed && std::abs(delta[j]) <= lattice.limits().joint_step;
    }
    if (allowed) edges.push_back({b, lattice.edge_cost(delta)});
  }
  return edges;
}

/// Where the pair of layers is put: near each singular pose, at a joint's window, through axis 1,
/// or anywhere.
enum class Place { kAnywhere, kShoulder, kElbow, kWrist, kWindow, kAxisOne };

std::pair<Config, Config> ends(const TestRobot& robot, const Chain& chain, const SrsArm& srs,
                               Place place, Random& random) {
  Config q0 = random_config(chain, random), q1;
  const auto through = [&](int joint, double zero) {
    q0[joint] = zero + random.uniform(-0.15, -0.02);
    q1 = q0;
    for (int j = 0; j < kDof; ++j) q1[j] += random.uniform(-0.05, 0.05);
    q1[joint] = zero + random.uniform(0.02, 0.15);
  };
  switch (place) {
    case Place::kShoulder:
      through(1, -srs.shoulder.shift);
      break;
    case Place::kElbow:
      through(3, std::remainder(-srs.elbow_shift, kTwoPi));
      break;
    case Place::kWrist:
      through(5, -srs.wrist.shift);
      break;
    case Place::kWindow: {
      const int joint = robot.name == "windings" ? (random.coin() ? 0 : 6) : random.below(kDof);
      const JointLimit& limit = chain.limit[static_cast<std::size_t>(joint)];
      // For a joint of more than a turn the first image ends a turn above its lower limit.
      through(joint, limit.continuous                     ? kPi
                     : limit.upper - limit.lower > kTwoPi ? limit.lower + kTwoPi
                                                          : limit.upper);
      break;
    }
    case Place::kAxisOne: {
      // The wrist stands above the shoulder: S->W along axis 1 in between.
      q0.setZero();
      q0[0] = random.uniform(-1, 1);
      q0[3] = std::remainder(-srs.elbow_shift, kTwoPi) + random.uniform(0.7, 1.5);
      q1 = q0;
      // Lean until the wrist is over the shoulder, then a little to either side.
      double lean = 0, best = 1e9;
      for (double t = -2; t < 2; t += 1e-3) {
        q1[1] = t;
        const Vector3d sw = wrist_centre(srs, chain.tool(q1)) - srs.S;
        const double off = sw.cross(srs.axis[0]).norm();
        if (off < best) {
          best = off;
          lean = t;
        }
      }
      q0[1] = lean - random.uniform(0.01, 0.05);
      q1[1] = lean + random.uniform(0.01, 0.05);
      break;
    }
    case Place::kAnywhere:
      q1 = q0;
      for (int j = 0; j < kDof; ++j) q1[j] += random.uniform(-0.15, 0.15);
      break;
  }
  return {q0, q1};
}

/// Returns a problem of two layers: from the pose q0 to q1.
PathProblem two_layers(const TestRobot& robot, const Chain& chain,
                       const std::pair<Config, Config>& q, Random& random) {
  PathProblem problem = problem_for(robot);
  problem.waypoints = {waypoint_of(chain.tool(q.first)), waypoint_of(chain.tool(q.second))};
  problem.resolution = {.ds = 10, .dphi = random.uniform(0.08, 0.3), .dalpha = 10};
  problem.limits.arm_slope = random.uniform(0.0, 0.1);
  problem.limits.joint_step = random.uniform(0.3, 0.7);
  return problem;
}

/// Counts edges: all, those that change the solution, by place, and those that flip a sign of the
/// branch or change the winding.
struct EdgeCounts {
  std::int64_t total = 0;
  std::map<Place, std::int64_t> changing;
  std::array<std::int64_t, 3> flips{};
  std::int64_t windings = 0;

  /// Counts the edges from slot a of layer 0.
  void add(const SrsLattice& lattice, Place place, int a, const std::vector<Edge>& edges) {
    total += static_cast<std::int64_t>(edges.size());
    for (const Edge& edge : edges) {
      const int change = lattice.branch_of(a) ^ lattice.branch_of(edge.b);
      if (lattice.solution_of(a) != lattice.solution_of(edge.b)) ++changing[place];
      for (int bit = 0; bit < 3; ++bit) flips[static_cast<std::size_t>(bit)] += (change >> bit) & 1;
      windings += change == 0 && lattice.solution_of(a) != lattice.solution_of(edge.b);
    }
  }
};

/// Expects the implicit graph and the sweep to have the edges of brute force between the two layers
/// of the lattice; `what` tells the problem.
void expect_edges_of_brute_force(const SrsLattice& lattice, Place place, const std::string& what,
                                 EdgeCounts& counts) {
  std::vector<std::optional<Config>> here, next;
  for (int slot = 0; slot < lattice.width(); ++slot) {
    here.push_back(lattice.node(0, slot));
    next.push_back(lattice.node(1, slot));
  }
  GridCostToGo cost_to_go(lattice);
  cost_to_go.sweep(1);
  const ImplicitLattice graph(cost_to_go, kUnreachable);
  for (int a = 0; a < lattice.width(); ++a) {
    const std::vector<Edge> wanted = brute_force(lattice, 0, a, here, next);
    double least = kUnreachable;
    for (const Edge& edge : wanted) least = std::min(least, edge.cost);
    ASSERT_EQ(cost_to_go.at(0, a), least) << what;  // the vector sweep sees the same edges
    if (!here[static_cast<std::size_t>(a)]) continue;
    std::vector<Edge> found;
    for (const auto& edge : graph.expand(graph.vertex(0, a)))
      found.push_back({graph.slot_of(edge.target), edge.cost});
    std::sort(found.begin(), found.end(), [](const Edge& x, const Edge& y) { return x.b < y.b; });
    ASSERT_EQ(found, wanted) << what;
    counts.add(lattice, place, a, found);
  }
}

TEST(EdgeSet, ImplicitSuccessorsAreThoseOfBruteForce) {
  Random random(seed("EdgeSet"));
  const std::map<Place, const char*> places{
      {Place::kAnywhere, "anywhere"}, {Place::kShoulder, "shoulder"}, {Place::kElbow, "elbow"},
      {Place::kWrist, "wrist"},       {Place::kWindow, "window"},     {Place::kAxisOne, "axis 1"}};
  EdgeCounts counts;
  for (const TestRobot& robot : all_robots()) {
    const ArmModel arm = arm_of(robot);
    const SrsArm srs = fit_srs(arm.chain, robot.name);
    for (const auto& [place, name] : places)
      for (int trial = 0; trial < trials(6); ++trial) {
        PathProblem problem =
            two_layers(robot, arm.chain, ends(robot, arm.chain, srs, place, random), random);
        problem.resolution.arcs = trial % 2 == 1;
        const ToolPath path(waypoints_in_base(problem), problem.resolution, "test");
        const SrsLattice lattice(arm.chain, srs, path, problem);
        expect_edges_of_brute_force(lattice, place, robot.name + " " + name, counts);
        if (HasFatalFailure()) return;
      }
  }
  auto& [total, changing, flips, windings] = counts;
  std::printf("%lld edges; sheet-changing:", static_cast<long long>(total));
  for (const auto& [place, count] : changing)
    std::printf(" %s %lld", places.at(place), static_cast<long long>(count));
  std::printf("; shoulder %lld, wrist %lld, elbow %lld, winding %lld\n",
              static_cast<long long>(flips[0]), static_cast<long long>(flips[1]),
              static_cast<long long>(flips[2]), static_cast<long long>(windings));
  EXPECT_GE(total, at_least(10001));
  for (const Place place : {Place::kShoulder, Place::kElbow, Place::kWrist})
    EXPECT_GE(changing[place], at_least(1)) << places.at(place);
  for (const std::int64_t count : flips) EXPECT_GE(count, at_least(1));
  EXPECT_GE(windings, at_least(1));
}

/// Cost-to-go of the whole lattice by the definition: every pair, minus removed nodes and edges.
std::vector<std::vector<double>> plain_cost_to_go(const SrsLattice& lattice,
                                                  const GridCostToGo& cost_to_go) {
  std::vector<std::vector<double>> g(
      static_cast<std::size_t>(lattice.layers()),
      std::vector<double>(static_cast<std::size_t>(lattice.width()), kUnreachable));
  std::vector<std::optional<Config>> next;
  for (int layer = cost_to_go.goal_layer(); layer >= 0; --layer) {
    std::vector<std::optional<Config>> here;
    for (int slot = 0; slot < lattice.width(); ++slot)
      here.push_back(cost_to_go.verdicts().node(layer, slot) == Verdict::kRemoved
                         ? std::nullopt
                         : lattice.node(layer, slot));
    for (int a = 0; a < lattice.width(); ++a) {
      double& value = g[static_cast<std::size_t>(layer)][static_cast<std::size_t>(a)];
      if (layer == cost_to_go.goal_layer()) {
        if (here[static_cast<std::size_t>(a)]) value = 0;
        continue;
      }
      for (const Edge& edge : brute_force(lattice, layer, a, here, next))
        if (cost_to_go.verdicts().edge(layer, a, edge.b) != Verdict::kRemoved)
          value = std::min(
              value,
              edge.cost + g[static_cast<std::size_t>(layer) + 1][static_cast<std::size_t>(edge.b)]);
    }
    next.swap(here);
  }
  return g;
}

/// Returns a problem of some five steps between two random poses near one another.
PathProblem five_steps(const TestRobot& robot, const Chain& chain, Random& random) {
  const Config q0 = random_config(chain, random);
  Config q1 = q0;
  for (int j = 0; j < kDof; ++j) q1[j] += random.uniform(-0.3, 0.3);
  PathProblem problem = problem_for(robot);
  problem.waypoints = {waypoint_of(chain.tool(q0)), waypoint_of(chain.tool(q1))};
  const double length = (problem.waypoints[0].position - problem.waypoints[1].position).norm();
  problem.resolution = {.ds = length / 5,
                        .dphi = robot.name == "windings" ? 0.4 : random.uniform(0.1, 0.3),
                        .dalpha = 10};
  problem.limits.arm_slope = 2 * problem.resolution.dphi / problem.resolution.ds;
  if (random.coin()) problem.start = q0;
  if (random.coin(0.3)) end_at(problem, chain, q1);
  return problem;
}

/// Counts rounds, what they removed, and how often that changed the optimum.
struct RemovalCounts {
  int rounds = 0, removed_nodes = 0, removed_edges = 0, changed = 0;
};

/// Expects the cost-to-go of every node to be that of the definition; `what` tells the round.
void expect_plain_cost_to_go(const GridCostToGo& cost_to_go, const std::string& what) {
  const SrsLattice& lattice = cost_to_go.lattice();
  const auto wanted = plain_cost_to_go(lattice, cost_to_go);
  for (int layer = 0; layer < lattice.layers(); ++layer)
    for (int slot = 0; slot < lattice.width(); ++slot)
      ASSERT_EQ(cost_to_go.at(layer, slot),
                wanted[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)])
          << what << " layer " << layer << " slot " << slot;
}

/// Removes a blob about the best path, and some edges of it, and repairs the costs-to-go.
void remove_about_best_path(GridCostToGo& cost_to_go, Random& random, RemovalCounts& counts) {
  const SrsLattice& lattice = cost_to_go.lattice();
  const double before = cost_to_go.best();
  ImplicitLattice graph(cost_to_go);
  int slot = 0;
  for (int s = 0; s < lattice.width(); ++s)
    if (cost_to_go.at(0, s) == before) slot = s;
  const int cut = random.below(lattice.layers());
  for (int layer = 0; layer <= cut && layer < lattice.layers(); ++layer) {
    if (layer == cut) {
      for (int k = 0; k < 3; ++k) {
        const int j = (lattice.angle_of(slot) + k) % lattice.angles();
        cost_to_go.verdicts().remove_node(layer, lattice.solution_of(slot) * lattice.angles() + j);
        ++counts.removed_nodes;
      }
      break;
    }
    const auto& edges = graph.expand(graph.vertex(layer, slot));
    if (edges.empty()) break;
    const int next = graph.slot_of(edges[0].target);
    if (random.coin(0.3)) {
      cost_to_go.remove_edge(layer, slot, next);
      ++counts.removed_edges;
    }
    slot = next;
  }
  cost_to_go.repair();
  counts.changed += cost_to_go.best() != before;
}

/// Expects a fresh sweep with the same removals to agree with the repaired values.
void expect_fresh_sweep_agrees(GridCostToGo& cost_to_go) {
  const int width = cost_to_go.lattice().width();
  std::vector<double> repaired;
  for (int s = 0; s < width; ++s) repaired.push_back(cost_to_go.at(0, s));
  cost_to_go.sweep(cost_to_go.goal_layer());
  for (int s = 0; s < width; ++s)
    ASSERT_EQ(cost_to_go.at(0, s), repaired[static_cast<std::size_t>(s)]);
}

TEST(CostToGo, StaysExactUnderRemovals) {
  Random random(seed("CostToGo.StaysExactUnderRemovals"));
  RemovalCounts counts;
  for (const TestRobot& robot : all_robots()) {
    const ArmModel arm = arm_of(robot);
    const SrsArm srs = fit_srs(arm.chain, robot.name);
    for (int trial = 0; trial < trials(6); ++trial) {
      PathProblem problem = five_steps(robot, arm.chain, random);
      problem.resolution.arcs = trial % 2 == 1;
      const ToolPath path(waypoints_in_base(problem), problem.resolution, "test");
      const SrsLattice lattice(arm.chain, srs, path, problem);
      GridCostToGo cost_to_go(lattice);
      cost_to_go.sweep(lattice.layers() - 1);
      for (int round = 0; round < 6; ++round) {
        expect_plain_cost_to_go(cost_to_go, robot.name + " trial " + std::to_string(trial) +
                                                " round " + std::to_string(round));
        if (HasFatalFailure()) return;
        ++counts.rounds;
        if (cost_to_go.best() == kUnreachable) break;
        remove_about_best_path(cost_to_go, random, counts);
      }
      expect_fresh_sweep_agrees(cost_to_go);
      if (HasFatalFailure()) return;
    }
  }
  const auto& [rounds, removed_nodes, removed_edges, changed] = counts;
  std::printf("%d rounds, %d nodes and %d edges removed, optimum changed %d times\n", rounds,
              removed_nodes, removed_edges, changed);
  EXPECT_GE(rounds, at_least(61));
  EXPECT_GE(changed, at_least(11));
  EXPECT_GE(removed_edges, at_least(11));
}

TEST(CostToGo, DeepestReachableIsThatOfBruteForce) {
  Random random(seed("CostToGo.DeepestReachable"));
  int blocked = 0;
  for (const TestRobot& robot : all_robots()) {
    const ArmModel arm = arm_of(robot);
    const SrsArm srs = fit_srs(arm.chain, robot.name);
    for (int trial = 0; trial < trials(8); ++trial) {
      PathProblem problem = problem_for(robot);
      const Config q0 = random_config(arm.chain, random),
                   q1 = random_config(arm.chain, random);  // far apart: often no way through
      problem.waypoints = {waypoint_of(arm.chain.tool(q0)), waypoint_of(arm.chain.tool(q1))};
      const double length = (problem.waypoints[0].position - problem.waypoints[1].position).norm();
      problem.resolution = {.ds = length / 8, .dphi = 0.35, .dalpha = 10};
      problem.limits.arm_slope = 0.7 / problem.resolution.ds;
      problem.limits.joint_step = 0.8;
      if (random.coin()) problem.start = q0;
      if (random.coin(0.3)) end_at(problem, arm.chain, q1);
      problem.resolution.arcs = trial % 2 == 1;
      const ToolPath path(waypoints_in_base(problem), problem.resolution, "test");
      const SrsLattice lattice(arm.chain, srs, path, problem);
      std::vector<std::vector<std::optional<Config>>> nodes(
          static_cast<std::size_t>(lattice.layers()));
      for (int layer = 0; layer < lattice.layers(); ++layer)
        for (int slot = 0; slot < lattice.width(); ++slot)
          nodes[static_cast<std::size_t>(layer)].push_back(lattice.node(layer, slot));
      std::vector<char> reached;
      for (const auto& q : nodes[0]) reached.push_back(q.has_value());
      int deepest = std::find(reached.begin(), reached.end(), 1) == reached.end() ? -1 : 0;
      for (int layer = 0; layer + 1 < lattice.layers() && deepest == layer; ++layer) {
        std::vector<char> ahead(reached.size(), 0);
        for (int a = 0; a < lattice.width(); ++a)
          if (reached[static_cast<std::size_t>(a)])
            for (const Edge& edge :
                 brute_force(lattice, layer, a, nodes[static_cast<std::size_t>(layer)],
                             nodes[static_cast<std::size_t>(layer) + 1]))
              ahead[static_cast<std::size_t>(edge.b)] = 1;
        if (std::find(ahead.begin(), ahead.end(), 1) != ahead.end()) deepest = layer + 1;
        reached.swap(ahead);
      }
      GridCostToGo cost_to_go(lattice);
      EXPECT_EQ(cost_to_go.deepest_reachable(), deepest) << robot.name;
      cost_to_go.sweep(lattice.layers() - 1);
      EXPECT_EQ(cost_to_go.best() == kUnreachable, deepest + 1 < lattice.layers());
      blocked += deepest + 1 < lattice.layers();
    }
  }
  std::printf("%d blocked\n", blocked);
  EXPECT_GE(blocked, at_least(6));
}

}  // namespace
}  // namespace swivel
