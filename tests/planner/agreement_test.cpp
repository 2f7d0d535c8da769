// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "collision_validity.hpp"
#include "random_problem.hpp"
#include "swivel/core/input_error.hpp"
#include "swivel/planner/check.hpp"
#include "swivel/planner/planner.hpp"

namespace swivel {
namespace {

using namespace test;

struct Answer {
  bool solved = false;
  double cost = 0;
  std::vector<int> slots;
  int deepest = -1;
};

/// The definition: every pair of nodes of neighbouring layers, own window, own steps, plain edge rule; dynamic program; ties by
/// slot.
Answer brute_force(const Problem& problem) {
  const PreparedRobot robot(problem);
  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
  const Lattice lattice(robot.arm().chain, robot.srs(), path, problem);
  const World& world = robot.world();
  World::Query query(world);
  const EdgeRule rule = edge_rule(problem.limits, robot.radii());
  const auto layers = static_cast<std::size_t>(lattice.layers()), width = static_cast<std::size_t>(lattice.width());
  std::vector<std::vector<std::optional<Config>>> nodes(layers, std::vector<std::optional<Config>>(width));
  for (std::size_t i = 0; i < layers; ++i)
    for (std::size_t slot = 0; slot < width; ++slot) {
      const auto q = lattice.node(static_cast<int>(i), static_cast<int>(slot));
      if (q && robot.arm().chain.manipulability(*q) >= problem.limits.manipulability &&
          !query.first_below(*q, problem.limits.clearance))
        nodes[i][slot] = q;
    }
  const double window = lattice.window() * kTwoPi / lattice.angles() + 1e-9;
  const auto edge = [&](std::size_t i, std::size_t a, std::size_t b) -> std::optional<double> {
    const int layer = static_cast<int>(i), sa = static_cast<int>(a), sb = static_cast<int>(b);
    if (std::abs(std::remainder(lattice.phi(layer + 1, sb) - lattice.phi(layer, sa), kTwoPi)) > window) return std::nullopt;
    const Config &qa = *nodes[i][a], &qb = *nodes[i + 1][b];
    Config delta = qb - qa;
    for (int j = 0; j < kDof; ++j) {
      if (robot.arm().chain.limit[static_cast<std::size_t>(j)].continuous) delta[j] = std::remainder(delta[j], kTwoPi);
      if (std::abs(delta[j]) > problem.limits.joint_step) return std::nullopt;
    }
    if (!lattice.follows_path(layer, sa, qa, sb, qb)) return std::nullopt;
    if (problem.limits.edges == EdgeMode::kContinuous && edge_blocked_plain(query, rule, qa, qa + delta)) return std::nullopt;
    return lattice.edge_cost(delta);
  };
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::vector<std::vector<double>> g(layers, std::vector<double>(width, kNone));
  std::vector<std::vector<int>> next(layers, std::vector<int>(width, -1));
  std::vector<std::vector<std::vector<std::size_t>>> into(layers, std::vector<std::vector<std::size_t>>(width));
  for (std::size_t slot = 0; slot < width; ++slot)
    if (nodes.back()[slot]) g.back()[slot] = 0;
  for (std::size_t i = layers - 1; i-- > 0;)
    for (std::size_t a = 0; a < width; ++a)
      for (std::size_t b = 0; nodes[i][a] && b < width; ++b) {
        if (!nodes[i + 1][b]) continue;
        const auto cost = edge(i, a, b);
        if (!cost) continue;
        into[i + 1][b].push_back(a);
        if (*cost + g[i + 1][b] < g[i][a]) {
          g[i][a] = *cost + g[i + 1][b];
          next[i][a] = static_cast<int>(b);
        }
      }
  Answer answer;
  const auto best = std::min_element(g[0].begin(), g[0].end());
  answer.cost = *best;
  answer.solved = *best != kNone;
  if (answer.solved) {
    int slot = static_cast<int>(best - g[0].begin());
    for (std::size_t i = 0; i < layers; ++i) {
      answer.slots.push_back(slot);
      slot = next[i][static_cast<std::size_t>(slot)];
    }
    return answer;
  }
  std::vector<char> reached(width, 0);
  for (std::size_t slot = 0; slot < width; ++slot) reached[slot] = nodes[0][slot].has_value();
  for (std::size_t i = 0; i < layers && std::find(reached.begin(), reached.end(), 1) != reached.end(); ++i) {
    answer.deepest = static_cast<int>(i);
    if (i + 1 == layers) break;
    std::vector<char> ahead(width, 0);
    for (std::size_t b = 0; b < width; ++b)
      for (const std::size_t a : into[i + 1][b]) ahead[b] |= reached[a];
    reached.swap(ahead);
  }
  return answer;
}

constexpr PlannerKind kPlanners[] = {PlannerKind::kEager, PlannerKind::kEagerDp, PlannerKind::kLazy, PlannerKind::kParallel};

void expect_same(const PlanResult& a, const PlanResult& b, const std::string& what) {
  ASSERT_EQ(a.status, b.status) << what;
  ASSERT_EQ(a.trajectory.size(), b.trajectory.size()) << what;
  ASSERT_EQ(a.cost, b.cost) << what;
  for (std::size_t i = 0; i < a.trajectory.size(); ++i) {
    ASSERT_EQ(a.trajectory[i].q, b.trajectory[i].q) << what << " row " << i;
    ASSERT_EQ(a.trajectory[i].branch, b.trajectory[i].branch) << what;
    ASSERT_EQ(a.trajectory[i].phi, b.trajectory[i].phi) << what;
  }
  ASSERT_EQ(a.diagnosis.reached_layer, b.diagnosis.reached_layer) << what;
  ASSERT_EQ(a.diagnosis.reason, b.diagnosis.reason) << what;
  ASSERT_EQ(a.diagnosis.empty_layers.size(), b.diagnosis.empty_layers.size()) << what;
}

TEST(Agreement, FourPlannersAndBruteForceOnRandomProblems) {
  const std::uint64_t base = seed("Agreement");
  const auto robots = all_robots();
  int solved = 0, infeasible = 0, continuous = 0, started = 0, obstacles = 0, label_changes = 0, detours = 0;
  std::int64_t certified = 0, lazy_fcl_calls = 0;
  const int count = trials(320);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const Problem problem = random_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) + " robot " + problem.source;
    const Answer truth = brute_force(problem);
    std::vector<PlanResult> results;
    for (const PlannerKind planner : kPlanners) {
      PlanOptions options;
      options.planner = planner;
      options.threads = 2;
      results.push_back(plan(problem, options));
    }
    PlanOptions astar;
    astar.planner = PlannerKind::kEager;
    astar.eager_search = EagerSearch::kAStar;
    results.push_back(plan(problem, astar));
    PlanOptions compared;
    compared.planner = PlannerKind::kLazy;
    compared.compare_with_fcl = true;  // throws where a certificate contradicts FCL
    results.push_back(plan(problem, compared));
    ASSERT_EQ(results.back().counters.certified_free, results[2].counters.certified_free) << what;
    ASSERT_EQ(results.back().counters.certified_colliding, results[2].counters.certified_colliding) << what;
    certified += results[2].counters.certified_free + results[2].counters.certified_colliding;
    lazy_fcl_calls += results[2].counters.fcl_calls;
    ASSERT_EQ(results[0].status == PlanStatus::kSolved, truth.solved) << what;
    for (std::size_t k = 1; k < results.size(); ++k) {
      expect_same(results[0], results[k], what + " planner " + results[k].planner);
      if (HasFatalFailure()) return;
    }
    continuous += problem.limits.edges == EdgeMode::kContinuous;
    started += problem.start.has_value();
    obstacles += !problem.scene.empty();
    if (truth.solved) {
      ++solved;
      ASSERT_EQ(results[0].cost, truth.cost) << what;
      const PreparedRobot robot(problem);
      const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
      const Lattice lattice(robot.arm().chain, robot.srs(), path, problem);
      for (int i = 0; i < lattice.layers(); ++i) {
        const int slot = truth.slots[static_cast<std::size_t>(i)];
        ASSERT_EQ(results[0].trajectory[static_cast<std::size_t>(i)].phi, lattice.phi(i, slot)) << what;
        ASSERT_EQ(results[0].trajectory[static_cast<std::size_t>(i)].branch, lattice.branch_of(slot)) << what;
        if (i > 0) label_changes += lattice.label_of(slot) != lattice.label_of(truth.slots[static_cast<std::size_t>(i) - 1]);
      }
      detours += results[2].counters.iterations > 1;
      const CheckResult check = check_trajectory(problem, results[0].trajectory);
      ASSERT_TRUE(check.passed) << what << ": " << (check.failures.empty() ? "" : check.failures[0]);
      ASSERT_NEAR(check.cost, results[0].cost, 1e-9) << what;
    } else {
      ++infeasible;
      ASSERT_EQ(results[0].diagnosis.reached_layer.value_or(-1), truth.deepest) << what;
      ASSERT_FALSE(results[0].diagnosis.reason.empty()) << what;
    }
  }
  std::printf(
      "%d problems: %d solved (%d after failures, %d label changes), %d infeasible, %d continuous, %d with a start, %d with "
      "obstacles; lazy: %lld questions certified, %lld FCL calls\n",
      count, solved, detours, label_changes, infeasible, continuous, started, obstacles, static_cast<long long>(certified),
      static_cast<long long>(lazy_fcl_calls));
  EXPECT_GE(solved, count / 4);
  EXPECT_GT(certified, 10 * lazy_fcl_calls);
  EXPECT_GE(infeasible, count / 20);
  EXPECT_GE(continuous, count / 5);
  EXPECT_GE(started, count / 10);
  EXPECT_GE(detours, count / 20);
}

class Experiments : public testing::TestWithParam<const char*> {};

TEST_P(Experiments, FourPlannersAgreeAtTheCoarseResolution) {
  Problem problem = io::load_problem(data_dir() / "problems" / (std::string(GetParam()) + ".yaml"));
  problem.resolution.ds = 0.02;
  problem.resolution.dphi = 0.2;
  problem.limits.edges = EdgeMode::kNodes;
  const PreparedRobot robot(problem);
  std::vector<PlanResult> results;
  for (const PlannerKind planner : kPlanners) {
    PlanOptions options;
    options.planner = planner;
    results.push_back(plan(robot, problem, options));
    expect_same(results[0], results.back(), results.back().planner);
    std::printf("%s %s: %s, cost %.12g, %lld nodes checked, %lld FCL calls, plan %.1f ms\n", GetParam(),
                results.back().planner.c_str(), to_string(results.back().status), results.back().cost,
                static_cast<long long>(results.back().counters.nodes_checked),
                static_cast<long long>(results.back().counters.fcl_calls), results.back().time_ms["plan"]);
  }
  ASSERT_EQ(results[0].status, PlanStatus::kSolved);
  EXPECT_TRUE(check_trajectory(problem, results[0].trajectory).passed);
}
INSTANTIATE_TEST_SUITE_P(Paper, Experiments, testing::Values("experiment_a", "experiment_b", "experiment_c"));

}  // namespace
}  // namespace swivel
