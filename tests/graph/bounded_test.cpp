// SPDX-License-Identifier: BSD-3-Clause
// Leaving out what cannot matter changes no answer: the bounded sweep against the whole one.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <thread>

#include "cost_to_go/grid/grid_cost_to_go.hpp"
#include "cost_to_go/kernels/relax.hpp"
#include "given_end.hpp"
#include "robots.hpp"
#include "swivel/core/base/isa.hpp"
#include "swivel/graph/lattice_graph/implicit_lattice.hpp"
#include "swivel/graph/search/path_first.hpp"

namespace swivel {
namespace {

using namespace test;

PathProblem random_problem(const TestRobot& robot, const Chain& chain, Random& random, int layers) {
  PathProblem problem = problem_for(robot);
  const Config q0 = random_config(chain, random);
  Config q1 = q0;
  for (int j = 0; j < kDof; ++j) q1[j] += random.uniform(-0.5, 0.5);
  problem.waypoints = {waypoint_of(chain.tool(q0)), waypoint_of(chain.tool(q1))};
  const double length = (problem.waypoints[0].position - problem.waypoints[1].position).norm();
  problem.resolution = {.ds = length / layers,
                        .dphi = robot.name == "windings" ? 0.4 : random.uniform(0.1, 0.3),
                        .dalpha = 10};
  problem.limits.arm_slope = random.uniform(1, 3) * problem.resolution.dphi / problem.resolution.ds;
  problem.limits.joint_step = random.uniform(0.2, 0.6);
  problem.cost.metric =
      random.one_of({CostMetric::kL2, CostMetric::kL1, CostMetric::kMax, CostMetric::kTime});
  if (random.coin())
    for (double& weight : problem.cost.weights.emplace())
      weight = random.coin(0.1) ? 0 : random.uniform(0.1, 10);
  if (random.coin()) problem.start = q0;
  if (random.coin(0.3)) end_at(problem, chain, q1);
  problem.resolution.arcs = layers % 2 == 1;
  return problem;
}

/// Cost from layer 0 to every node, forward over every edge of the lattice.
std::vector<std::vector<double>> cost_to_come(GridCostToGo& whole) {
  const SrsLattice& lattice = whole.lattice();
  std::vector<std::vector<double>> cost(
      static_cast<std::size_t>(lattice.layers()),
      std::vector<double>(static_cast<std::size_t>(lattice.width()), kUnreachable));
  const ImplicitLattice graph(whole, kUnreachable);
  for (int slot = 0; slot < lattice.width(); ++slot)
    if (whole.at(0, slot) != kUnreachable) cost[0][static_cast<std::size_t>(slot)] = 0;
  for (int layer = 0; layer + 1 < lattice.layers(); ++layer)
    for (int slot = 0; slot < lattice.width(); ++slot) {
      const double done = cost[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)];
      if (done == kUnreachable || whole.at(layer, slot) == kUnreachable) continue;
      for (const auto& edge : graph.expand(graph.vertex(layer, slot))) {
        double& there = cost[static_cast<std::size_t>(layer) + 1]
                            [static_cast<std::size_t>(graph.slot_of(edge.target))];
        there = std::min(there, done + edge.cost);
      }
    }
  return cost;
}

/// Three threads, made for every call.
ParallelFor shared_by_threads() {
  return {3, [](int parts, const std::function<void(int, int)>& body) {
            std::atomic<int> next{0};
            std::vector<std::thread> threads;
            for (int worker = 0; worker < std::min(3, parts); ++worker)
              threads.emplace_back([&, worker] {
                for (int part = next++; part < parts; part = next++) body(part, worker);
              });
            for (std::thread& thread : threads) thread.join();
          }};
}

/// The costs-to-go of one lattice: swept whole, bounded, and in some problems bounded by threads.
struct Sweeps {
  Sweeps(const SrsLattice& of, bool by_threads)
      : lattice(of),
        shares(by_threads),
        whole(of),
        bounded(of, Pruning::kByBound),
        shared(of, Pruning::kByBound) {
    if (shares) {
      shared.share(shared_by_threads());
      shared.sweep(lattice.layers() - 1);
    }
    whole.sweep(lattice.layers() - 1);
    bounded.sweep(lattice.layers() - 1);
  }
  [[nodiscard]] std::vector<GridCostToGo*> all() {
    std::vector<GridCostToGo*> swept{&whole, &bounded};
    if (shares) swept.push_back(&shared);
    return swept;
  }

  const SrsLattice& lattice;
  bool shares;
  GridCostToGo whole, bounded, shared;
};

/// Counts what the problems of a test met.
struct BoundedCounts {
  int problems = 0, rounds = 0, changed = 0, ended = 0, bounds = 0, to_deepest = 0, met = 0,
      apart = 0, longest = 0, followed = 0;
  std::int64_t whole_ik = 0, bounded_ik = 0, whole_deepest_ik = 0, bounded_deepest_ik = 0,
               compared = 0;
  double tightest = 0;
};

/// Counts a problem, its steps with and without a change of the elbow side, its layers and the
/// nodes that the first sweeps solved.
void count_problem(const Sweeps& sweeps, BoundedCounts& counts) {
  ++counts.problems;
  for (int step = 0; step + 1 < sweeps.lattice.layers(); ++step)
    (sweeps.lattice.may_change_elbow_side(step) ? counts.met : counts.apart) += 1;
  counts.longest = std::max(counts.longest, sweeps.lattice.layers());
  counts.whole_ik += sweeps.whole.ik_nodes();
  counts.bounded_ik += sweeps.bounded.ik_nodes();
}

/// Expects the table that threads swept, where there is one, to be the bounded one.
void expect_shared_is_bounded(Sweeps& sweeps, BoundedCounts& counts) {
  if (!sweeps.shares) return;
  ASSERT_EQ(sweeps.shared.ik_nodes(), sweeps.bounded.ik_nodes());
  ASSERT_EQ(sweeps.shared.edges(), sweeps.bounded.edges());
  for (int layer = 0; layer < sweeps.lattice.layers(); ++layer)
    for (int slot = 0; slot < sweeps.lattice.width(); ++slot)
      ASSERT_EQ(sweeps.shared.at(layer, slot), sweeps.bounded.at(layer, slot));
  ++counts.compared;
}

/// Expects no lower bound to exceed the cost from layer 0 to its node.
void expect_bounds_below_costs(Sweeps& sweeps, const std::string& trial, BoundedCounts& counts) {
  const SrsLattice& lattice = sweeps.lattice;
  const ChordLowerBound bound(lattice);
  const auto come = cost_to_come(sweeps.whole);
  ASSERT_LE(bound.best(), sweeps.whole.best());
  for (int layer = 0; layer < lattice.layers(); ++layer)
    for (int slot = 0; const float* row = bound.row(layer) ? bound.row(layer) + slot : nullptr;
         ++slot) {
      if (slot == lattice.width()) break;
      const double cost = come[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)];
      ASSERT_LE(*row, cost) << trial << " layer " << layer << " slot " << slot;
      if (cost != kUnreachable && cost > 0) {
        ++counts.bounds;
        counts.tightest = std::max(counts.tightest, *row / cost);
      }
    }
}

/// Keeps the paths of earlier rounds, for the bounded table and for the one of threads.
struct EarlierPaths {
  PathCache of_bounded, of_shared;
};

/// Expects every table to have the whole sweep's best path, searched anew or along earlier ones,
/// and stores it in `best`.
void expect_same_best_path(Sweeps& sweeps, EarlierPaths& earlier, const std::string& what,
                           SlotPath& best, BoundedCounts& counts) {
  ASSERT_EQ(sweeps.bounded.best(), sweeps.whole.best()) << what;
  std::int64_t expansions = 0, same_expansions = 0, fewer = 0, as_few = 0;
  best = best_path(sweeps.whole, expansions);
  ASSERT_EQ(best_path(sweeps.bounded, same_expansions), best) << what;
  ASSERT_EQ(expansions, same_expansions) << what;
  ASSERT_EQ(best_path(sweeps.bounded, fewer, &earlier.of_bounded), best) << what;
  ASSERT_LE(fewer, expansions) << what;
  counts.followed += fewer < expansions;
  earlier.of_bounded.add(best, sweeps.bounded);
  if (sweeps.shares) {
    ASSERT_EQ(best_path(sweeps.shared, same_expansions), best);
    ASSERT_EQ(best_path(sweeps.shared, as_few, &earlier.of_shared), best);
    ASSERT_EQ(as_few, fewer) << what;
    earlier.of_shared.add(best, sweeps.shared);
  }
  for (int layer = 0; !best.empty() && layer < sweeps.lattice.layers(); ++layer)
    ASSERT_EQ(sweeps.bounded.at(layer, best[static_cast<std::size_t>(layer)]),
              sweeps.whole.at(layer, best[static_cast<std::size_t>(layer)]));
}

/// Removes from every table an edge of the path, the nodes with the body poses of one of its
/// nodes, or nodes about one of them, and repairs the tables.
void remove_about(const SlotPath& path, Sweeps& sweeps, Random& random) {
  const SrsLattice& lattice = sweeps.lattice;
  const int layer = random.below(lattice.layers()), slot = path[static_cast<std::size_t>(layer)];
  const int kind = random.below(4);
  const int reach = random.below(lattice.angles() / 2);
  for (GridCostToGo* cost_to_go : sweeps.all()) {
    if (kind == 0 && layer > 0) {
      cost_to_go->remove_edge(layer - 1, path[static_cast<std::size_t>(layer) - 1], slot);
    } else if (kind == 1) {
      std::vector<int> same_poses;
      lattice.slots_with_same_body_poses(layer, slot, 1u << 4, same_poses);
      for (const int like : same_poses) cost_to_go->verdicts().remove_node(layer, like);
    } else {  // a blob of arm angles, over some layers
      for (int i = layer; i < std::min(lattice.layers(), layer + 3); ++i)
        for (int k = -reach; k <= reach; ++k) {
          const int n = lattice.angles(), j = ((lattice.angle_of(slot) + k) % n + n) % n;
          cost_to_go->verdicts().remove_node(i, lattice.solution_of(slot) * n + j);
        }
    }
    cost_to_go->repair();
  }
}

/// Expects the tables to agree in up to twelve rounds with removals after each of them; `trial`
/// tells the problem.
void expect_same_paths_under_removals(Sweeps& sweeps, CostMetric metric, const std::string& trial,
                                      Random& random, BoundedCounts& counts) {
  EarlierPaths earlier;
  for (int round = 0; round < 12; ++round) {
    ++counts.rounds;
    SlotPath best;
    expect_same_best_path(sweeps, earlier,
                          trial + " round " + std::to_string(round) + " metric " +
                              std::to_string(static_cast<int>(metric)),
                          best, counts);
    if (::testing::Test::HasFatalFailure()) return;
    if (best.empty()) {
      ++counts.ended;
      break;
    }
    const double before = sweeps.whole.best();
    remove_about(best, sweeps, random);
    counts.changed += sweeps.whole.best() != before;
    expect_shared_is_bounded(sweeps, counts);
    ASSERT_FALSE(::testing::Test::HasFatalFailure());
  }
}

/// Expects the tables to agree about the deepest layer that can be reached where no path is left,
/// and about the paths to it under removals that `beyond` draws.
void expect_same_paths_to_deepest_layer(Sweeps& sweeps, Random& beyond, BoundedCounts& counts) {
  const bool shares = sweeps.shares;
  GridCostToGo &whole = sweeps.whole, &bounded = sweeps.bounded, &shared = sweeps.shared;
  const int deepest = whole.deepest_reachable();
  ASSERT_EQ(bounded.deepest_reachable(), deepest);
  if (shares) {
    ASSERT_EQ(shared.deepest_reachable(), deepest);
  }
  if (deepest < 0) return;
  const std::int64_t whole_before = whole.ik_nodes(), bounded_before = bounded.ik_nodes();
  for (GridCostToGo* cost_to_go : sweeps.all()) cost_to_go->sweep(deepest);
  if (!sweeps.lattice.is_given(sweeps.lattice.layers() - 1)) {  // a given end leaves few to solve
    counts.whole_deepest_ik += whole.ik_nodes() - whole_before;
    counts.bounded_deepest_ik += bounded.ik_nodes() - bounded_before;
  }
  expect_shared_is_bounded(sweeps, counts);
  ASSERT_EQ(bounded.best(), whole.best());
  for (int round = 0; round < 4 && whole.best() != kUnreachable; ++round) {
    std::int64_t expansions = 0;
    const SlotPath best = best_path(whole, expansions);
    ASSERT_EQ(best_path(bounded, expansions), best);
    if (shares) {
      ASSERT_EQ(best_path(shared, expansions), best);
    }
    const int layer = beyond.below(deepest + 1);
    for (GridCostToGo* cost_to_go : sweeps.all()) {
      cost_to_go->verdicts().remove_node(layer, best[static_cast<std::size_t>(layer)]);
      cost_to_go->repair();
    }
    ASSERT_EQ(bounded.best(), whole.best());
    expect_shared_is_bounded(sweeps, counts);
    ++counts.to_deepest;
  }
  ASSERT_EQ(bounded.deepest_reachable(), whole.deepest_reachable());
}

/// Prints what was met and expects enough of each kind.
void expect_enough(const BoundedCounts& counts) {
  const auto share = [](std::int64_t some, std::int64_t all) {
    return 100.0 * static_cast<double>(some) / static_cast<double>(all);
  };
  const double deepest_share = share(counts.bounded_deepest_ik, counts.whole_deepest_ik);
  std::printf(
      "%d problems, %d rounds, optimum changed %d times, %d ended without a path, %d removed from "
      "paths to the deepest layer; %d "
      "bounds held, up to %.4f of the cost; first sweeps solved %.1f %% of the whole's nodes, "
      "those to the deepest layer %.1f %%; "
      "%lld tables by threads the same; families meet at %d steps, not at %d; up to %d layers; %d "
      "paths went on as an earlier "
      "one\n",
      counts.problems, counts.rounds, counts.changed, counts.ended, counts.to_deepest,
      counts.bounds, counts.tightest, share(counts.bounded_ik, counts.whole_ik), deepest_share,
      static_cast<long long>(counts.compared), counts.met, counts.apart, counts.longest,
      counts.followed);
  EXPECT_GE(counts.followed, at_least_among(counts.rounds / 60));
  EXPECT_GE(counts.met, at_least(20));
  EXPECT_GE(counts.apart, at_least(200));
  EXPECT_GT(counts.longest, 64);
  if (at_least(8) > 0) {
    EXPECT_LT(deepest_share, 65);  // about 80 where the costs of the reach are lost
  }
  EXPECT_GE(counts.compared, at_least_among(counts.problems + 1));
  EXPECT_GE(counts.rounds, at_least_among(3 * counts.problems + 1));
  EXPECT_GE(counts.changed, at_least_among(counts.problems + 1));
  EXPECT_GE(counts.ended, at_least(4));
  EXPECT_GE(counts.to_deepest, at_least(10));
  EXPECT_GE(counts.bounds, at_least(1001));
  EXPECT_GT(counts.tightest, 0.99);
}

/// A third of the problems are also swept by threads: the same values, the same counts.
TEST(Bounded, SameBestPathsAsTheWholeSweepUnderRemovals) {
  Random random(seed("Bounded"));
  Random beyond(seed(
      "Bounded.Deepest"));  // its own, so that the problems are the same however many rounds it has
  BoundedCounts counts;
  for (const TestRobot& robot : all_robots()) {
    const ArmModel arm = arm_of(robot);
    const SrsArm srs = fit_srs(arm.chain, robot.name);
    for (int trial = 0; trial < trials(robot.name == "windings" ? 6 : 16); ++trial) {
      // Some of more layers than elbow sides go through at once.
      const int waypoints = counts.problems % 8 == 0 ? 66 + random.below(80) : 2 + random.below(30);
      const PathProblem problem = random_problem(robot, arm.chain, random, waypoints);
      const ToolPath path(waypoints_in_base(problem), problem.resolution, "test");
      const SrsLattice lattice(arm.chain, srs, path, problem);
      const std::string what = robot.name + " trial " + std::to_string(trial);
      Sweeps sweeps(lattice, counts.problems % 3 == 0);
      count_problem(sweeps, counts);
      expect_shared_is_bounded(sweeps, counts);
      expect_bounds_below_costs(sweeps, what, counts);
      if (HasFatalFailure()) return;
      expect_same_paths_under_removals(sweeps, problem.cost.metric, what, random, counts);
      if (HasFatalFailure()) return;
      if (sweeps.whole.best() == kUnreachable)
        expect_same_paths_to_deepest_layer(sweeps, beyond, counts);
      if (HasFatalFailure()) return;
    }
  }
  expect_enough(counts);
}

/// Relaxes pair by pair, as the definition says. Partners of node k are those from k on, or with
/// `all` the same ones for every node.
std::vector<double> relaxed_plainly(const RelaxTask<double>& task, bool all = false) {
  std::vector<double> best(static_cast<std::size_t>(task.n), kUnreachable);
  for (int k = 0; k < task.n; ++k)
    for (int offset = 0; offset < task.offsets; ++offset) {
      const int partner = all ? offset : k + offset;
      double squares[kDof], sizes[kDof], most = 0;
      bool allowed = true;
      for (int j = 0; j < kDof; ++j) {
        double d = task.to[j][partner] - task.from[j][k];
        d -= task.turn[j] * std::round(d / kTwoPi);
        allowed = allowed && std::abs(d) <= task.bound[j];
        const double x = task.scale[j] * d;
        squares[j] = x * x;
        sizes[j] = std::abs(x);
        most = std::max(most, std::abs(x));
      }
      const auto sum = [](const double* s) {
        return ((s[0] + s[1]) + s[2]) + s[3] + ((s[4] + s[5]) + s[6]);
      };
      const double cost = task.metric == RelaxMetric::kL2   ? std::sqrt(sum(squares))
                          : task.metric == RelaxMetric::kL1 ? sum(sizes)
                                                            : most;
      if (allowed)
        best[static_cast<std::size_t>(k)] =
            std::min(best[static_cast<std::size_t>(k)],
                     cost + 6144.0 * task.unit - 6144.0 * task.unit + task.value[partner]);
    }
  return best;
}

std::vector<const RelaxKernels*> vector_units() {
  std::vector<const RelaxKernels*> units{&scalar_relax_kernels()};
#ifdef SWIVEL_X86_KERNELS
  if (__builtin_cpu_supports("avx2")) units.push_back(&avx2_relax_kernels());
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    units.push_back(&avx512_relax_kernels());
#endif
  return units;
}

/// A random task about pairs of neighbouring nodes, and the coarse task about the same nodes in
/// single precision. The tasks point into the vectors.
struct NeighbourCase {
  explicit NeighbourCase(Random& random) {
    task.n = 1 + random.below(40);
    task.offsets = 1 + random.below(9);
    const auto length = static_cast<std::size_t>(task.n + task.offsets);
    const auto random_values = [&](auto sample) {
      std::vector<double> values(length);
      for (double& x : values) x = sample();
      return values;
    };
    idle = random.coin(0.1);
    const double spread = random.coin() ? 7 : 0.5;  // moves beyond the bounds, or within
    for (auto* joints : {&from, &to})
      for (auto& joint : *joints)
        joint = random_values([&] { return random.uniform(-spread, spread); });
    const double unit = random.coin() ? 1 : std::exp2(random.below(41) - 20);
    value = random_values(
        [&] { return random.coin(0.2) ? kUnreachable : unit * random.uniform(0, 5); });
    task.value = value.data();
    task.unit = unit;
    task.metric = random.one_of({RelaxMetric::kL2, RelaxMetric::kL1, RelaxMetric::kMax});
    task.wraps = random.coin();
    for (std::size_t j = 0; j < kDof; ++j) {
      task.from[j] = from[j].data();
      task.to[j] = to[j].data();
      task.scale[j] = idle || random.coin(0.2) ? 0 : unit * random.uniform(0, 3);
      task.bound[j] = random.uniform(1, 9);
      task.turn[j] = task.wraps && random.coin() ? kTwoPi : 0;
    }
    round_to_coarse();
  }
  NeighbourCase(const NeighbourCase&) = delete;
  NeighbourCase& operator=(const NeighbourCase&) = delete;

  std::array<std::vector<double>, kDof> from, to;
  std::vector<double> value;
  RelaxTask<double> task{};
  std::array<std::vector<float>, kDof> chord_from, chord_to;
  std::vector<float> coarse_value;
  RelaxTask<float> coarse{};
  bool idle = false;  ///< no joint has a weight: every move costs nothing

 private:
  /// Makes the coarse task of the other one: without bounds, its numbers rounded to floats.
  void round_to_coarse() {
    coarse.n = task.n;
    coarse.offsets = task.offsets;
    coarse.unit = static_cast<float>(task.unit);
    coarse.metric = task.metric;
    coarse.wraps = task.wraps;
    coarse_value.assign(value.begin(), value.end());
    coarse.value = coarse_value.data();
    for (std::size_t j = 0; j < kDof; ++j) {
      chord_from[j].assign(from[j].begin(), from[j].end());
      chord_to[j].assign(to[j].begin(), to[j].end());
      coarse.from[j] = chord_from[j].data();
      coarse.to[j] = chord_to[j].data();
      coarse.scale[j] = static_cast<float>(task.scale[j]);
      coarse.turn[j] = static_cast<float>(task.turn[j]);
    }
  }
};

/// Counts runs of vector units, and nodes that are reached or not.
struct RelaxCounts {
  int runs = 0, reached = 0, barred = 0;
};

/// Expects the plain values of every vector unit, and of all the same coarse ones.
void expect_plain_bits(NeighbourCase& c, const std::vector<const RelaxKernels*>& units,
                       RelaxCounts& counts) {
  const auto n = static_cast<std::size_t>(c.task.n);
  std::vector<std::vector<double>> best;
  std::vector<std::vector<float>> coarse_best;
  const std::vector<double> plain = relaxed_plainly(c.task);
  for (const double found : plain) (found == kUnreachable ? counts.barred : counts.reached) += 1;
  for (const RelaxKernels* kernels : units) {
    best.emplace_back(n, kUnreachable);
    coarse_best.emplace_back(n, std::numeric_limits<float>::infinity());
    c.task.best = best.back().data();
    c.coarse.best = coarse_best.back().data();
    kernels->relax(c.task);
    kernels->coarse(c.coarse);
    ASSERT_EQ(best.back(), plain);
    ASSERT_EQ(coarse_best.back(), coarse_best.front());
    ++counts.runs;
  }
  // A coarse step allows every step, so it is nowhere dearer, and single precision loses little.
  for (std::size_t k = 0; k < best[0].size(); ++k)
    ASSERT_LE(coarse_best[0][k], best[0][k] + 1e-4 * c.task.unit);
}

TEST(Kernels, EveryVectorUnitRelaxesToThePlainBits) {
  Random random(seed("RelaxKernels"));
  const std::vector<const RelaxKernels*> units = vector_units();
  RelaxCounts counts;
  int idle_runs = 0;
  for (int trial = 0; trial < trials(4000); ++trial) {
    NeighbourCase some(random);
    idle_runs += some.idle;
    expect_plain_bits(some, units, counts);
    if (HasFatalFailure()) return;
  }
  const auto& [runs, reached, barred] = counts;
  std::printf("%zu units, %d runs, %d nodes reached, %d not\n", units.size(), runs, reached,
              barred);
  EXPECT_GE(reached, at_least_among(runs + 1));
  EXPECT_GE(barred, at_least_among(runs / 10 + 1));
  EXPECT_GE(idle_runs, at_least_among(runs / 60 + 1));
}

template <class T>
void expect_plain_ranges(Random& random, const std::vector<const RelaxKernels*>& units,
                         void (*RelaxKernels::*range)(const T*, const T*, int, T&, T&), int& ranges,
                         int& empty) {
  for (int trial = 0; trial < trials(4000); ++trial) {
    const int n = random.below(40);
    const double known = random.coin(0.2) ? 0.05 : 0.7;
    std::vector<T> q(static_cast<std::size_t>(n)), value(q.size());
    T low = std::numeric_limits<T>::infinity(), high = -low;
    for (std::size_t k = 0; k < q.size(); ++k) {
      q[k] = static_cast<T>(random.uniform(-7, 7));
      value[k] = random.coin(known) ? static_cast<T>(random.uniform(0, 5))
                                    : std::numeric_limits<T>::infinity();
      if (value[k] == std::numeric_limits<T>::infinity()) continue;
      low = std::min(low, q[k]);
      high = std::max(high, q[k]);
    }
    for (const RelaxKernels* kernels : units) {
      T found_low = 1, found_high = 1;
      (kernels->*range)(q.data(), value.data(), n, found_low, found_high);
      ASSERT_EQ(found_low, low) << n;
      ASSERT_EQ(found_high, high) << n;
      ++ranges;
      empty += low > high;
    }
  }
}

TEST(Kernels, RangesAreOfTheNodesWithAValue) {
  Random random(seed("Ranges"));
  const std::vector<const RelaxKernels*> units = vector_units();
  int ranges = 0, empty = 0;
  expect_plain_ranges<double>(random, units, &RelaxKernels::range, ranges, empty);
  expect_plain_ranges<float>(random, units, &RelaxKernels::coarse_range, ranges, empty);
  std::printf("%zu units, %d ranges, %d of no node\n", units.size(), ranges, empty);
  EXPECT_GE(empty, at_least_among(ranges / 100 + 1));
}

/// A random task about nodes that each meet all partners: nodes in runs along which joints change
/// little, as on arcs, or anywhere; partners near some of them. The task points into the vectors.
struct ReachCase {
  explicit ReachCase(Random& random) {
    task.n = 1 + random.below(60);
    task.offsets = 1 + random.below(random.coin(0.1) ? 600 : 40);
    const double turns = random.coin() ? kPi : 20;  // joints go so far from 0
    const double spacing = random.uniform(0, 0.5);
    for (int k = 0; k < task.n; ++k) {
      const bool jump = k == 0 || random.coin(0.1);
      for (auto& joint : from)
        joint.push_back(jump ? random.uniform(-turns, turns)
                             : joint.back() + random.uniform(-spacing, spacing));
    }
    task.unit = random.coin() ? 1 : std::exp2(random.below(41) - 20);
    task.metric = random.one_of({RelaxMetric::kL2, RelaxMetric::kL1, RelaxMetric::kMax});
    task.wraps = random.coin();
    const double widest = random.coin(0.3) ? 8 : 1;  // as of steps from knot to knot
    for (std::size_t j = 0; j < kDof; ++j) {
      task.turn[j] = task.wraps && random.coin() ? kTwoPi : 0;
      task.bound[j] = random.coin(0.05) ? 0 : widest * random.uniform(0.1, 1);
      task.scale[j] = random.coin(0.1) ? 0 : task.unit * random.uniform(0, 3);
    }
    for (int k = 0; k < task.offsets; ++k) add_partner(random);
    for (int k = 0; k < task.offsets; ++k)
      value.push_back(random.coin(0.2) ? kUnreachable : task.unit * random.uniform(0, 5));
    task.value = value.data();
    for (std::size_t j = 0; j < kDof; ++j) {
      task.from[j] = from[j].data();
      task.to[j] = to[j].data();
    }
  }
  /// Adds boxes about blocks of partners, and the least value in each.
  void add_blocks() {
    constexpr int kBlock = RelaxTask<double>::kBlock;
    for (int first = 0; first < task.offsets; first += kBlock) {
      const int end = std::min(task.offsets, first + kBlock);
      for (std::size_t j = 0; j < kDof; ++j) {
        double low = 0, high = 0;
        for (int k = first; k < end; ++k) {
          double step = to[j][static_cast<std::size_t>(k)] - to[j][static_cast<std::size_t>(first)];
          if (task.turn[j] > 0) step = std::remainder(step, kTwoPi);
          low = std::min(low, step), high = std::max(high, step);
        }
        block_middle[j].push_back(to[j][static_cast<std::size_t>(first)] + (low + high) / 2);
        block_radius[j].push_back((high - low) / 2);
      }
      block_value.push_back(*std::min_element(value.begin() + first, value.begin() + end));
    }
    for (std::size_t j = 0; j < kDof; ++j) {
      task.block_middle[j] = block_middle[j].data();
      task.block_radius[j] = block_radius[j].data();
    }
    task.block_value = block_value.data();
  }
  ReachCase(const ReachCase&) = delete;
  ReachCase& operator=(const ReachCase&) = delete;

  std::array<std::vector<double>, kDof> from, to, block_middle, block_radius;
  std::vector<double> value, block_value;
  RelaxTask<double> task{};
  int turned = 0;  ///< joints of partners that are a turn further than those of the node

 private:
  /// Adds a partner about as far from a node as the bounds allow, some joints a turn further.
  void add_partner(Random& random) {
    const auto near = static_cast<std::size_t>(random.below(task.n));
    const double share =
        random.coin() ? 1 : 1.1;  // of the bounds: some partners stand on them to the bit
    for (std::size_t j = 0; j < kDof; ++j) {
      const double away =
          random.coin(0.2) ? std::copysign(1.0, random.uniform(-1, 1)) : random.uniform(-1, 1);
      const double whole = task.turn[j] > 0 ? kTwoPi * (random.below(3) - 1) : 0;
      turned += whole != 0;
      to[j].push_back(from[j][near] + share * away * task.bound[j] + whole);
    }
  }
};

TEST(Kernels, EveryNodeMeetsEveryPartnerInItsReach) {
  Random random(seed("RelaxAll"));
  const std::vector<const RelaxKernels*> units = vector_units();
  int runs = 0, reached = 0, barred = 0, turned = 0;
  for (int trial = 0; trial < trials(4000); ++trial) {
    ReachCase some(random);
    turned += some.turned;
    const std::vector<double> plain = relaxed_plainly(some.task, true);
    for (const double found : plain) (found == kUnreachable ? barred : reached) += 1;
    for (const RelaxKernels* kernels : units) {
      std::vector<double> best(static_cast<std::size_t>(some.task.n), kUnreachable);
      some.task.best = best.data();
      kernels->relax_all(some.task);
      ASSERT_EQ(best, plain);
      ++runs;
    }
    some.add_blocks();
    for (const RelaxKernels* kernels : units) {
      std::vector<double> best(static_cast<std::size_t>(some.task.n), kUnreachable);
      some.task.best = best.data();
      kernels->relax_all(some.task);
      ASSERT_EQ(best, plain) << "with blocks";
      ++runs;
    }
  }
  std::printf("%zu units, %d runs, %d nodes reached, %d not, %d joints a turn further\n",
              units.size(), runs, reached, barred, turned);
  EXPECT_GE(reached, at_least_among(runs / 4 + 1));
  EXPECT_GE(barred, at_least_among(runs / 4 + 1));
  EXPECT_GE(turned, at_least_among(runs / 4 + 1));
}

}  // namespace
}  // namespace swivel
