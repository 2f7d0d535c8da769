// SPDX-License-Identifier: BSD-3-Clause
#include "lazy_ladder_solver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "seed.hpp"

namespace swivel::test {
namespace {

using namespace descartes_light;

constexpr double kNone = std::numeric_limits<double>::infinity();

/// A state with a number of its own, by which the evaluators below know it.
template <typename FloatT>
struct NumberedState : State<FloatT> {
  std::uint64_t number = 0;
};
template <typename FloatT>
std::uint64_t number_of(const State<FloatT>& state) {
  return static_cast<const NumberedState<FloatT>&>(state).number;
}
/// Returns a number in [0, 1) that depends on a few others alone.
double chance(std::uint64_t seed_value, std::uint64_t a, std::uint64_t b = 0) {
  return Random(seed_value * 1'000'003 + a * 7'919 + b).uniform(0, 1);
}

template <typename FloatT>
struct FixedSampler : WaypointSampler<FloatT> {
  std::vector<StateSample<FloatT>> samples;
  std::vector<StateSample<FloatT>> sample() const override { return samples; }
};
/// Refuses some edges and makes others dearer, by their states' numbers. Counts its calls.
template <typename FloatT>
struct ChanceEdge : EdgeEvaluator<FloatT> {
  std::uint64_t seed_value = 0;
  double refused = 0, dearer = 0;
  std::chrono::microseconds time{0};
  mutable std::atomic<std::int64_t> calls = 0;
  std::pair<bool, FloatT> evaluate(const State<FloatT>& from,
                                   const State<FloatT>& to) const override {
    ++calls;
    if (time.count() > 0) std::this_thread::sleep_for(time);
    const double drawn = chance(seed_value, number_of(from), number_of(to));
    if (drawn < refused) return {false, FloatT(0)};
    return {true, drawn < refused + dearer ? FloatT(drawn) : FloatT(0)};
  }
};
template <typename FloatT>
struct CheapChanceEdge : ChanceEdge<FloatT>, CheapEdge {};
template <typename FloatT>
struct ChanceState : StateEvaluator<FloatT> {
  std::uint64_t seed_value = 0;
  std::pair<bool, FloatT> evaluate(const State<FloatT>& state) const override {
    const double drawn = chance(seed_value, number_of(state));
    return {drawn > 0.1, FloatT(drawn)};
  }
};

/// A ladder of random states and what judges it.
template <typename FloatT>
struct Ladder {
  std::vector<typename WaypointSampler<FloatT>::ConstPtr> samplers;
  std::vector<typename EdgeEvaluator<FloatT>::ConstPtr> edges;
  std::vector<typename StateEvaluator<FloatT>::ConstPtr> states;
  std::shared_ptr<ChanceEdge<FloatT>> dear;  // null where all evaluators are cheap or asked eagerly
};

template <typename FloatT>
Ladder<FloatT> random_ladder(Random& random) {
  Ladder<FloatT> ladder;
  const int joints = 3 + random.below(7), rungs = 2 + random.below(12);
  const double empty = random.coin(0.1) ? 0.1 : 0;
  std::uint64_t number = 0;
  for (int i = 0; i < rungs; ++i) {
    auto sampler = std::make_shared<FixedSampler<FloatT>>();
    for (int k = random.coin(empty) ? 0 : 1 + random.below(12); k > 0; --k) {
      auto state = std::make_shared<NumberedState<FloatT>>();
      state->number = ++number;
      state->values.resize(joints);
      for (int j = 0; j < joints; ++j) state->values[j] = FloatT(random.uniform(-1, 1));
      sampler->samples.push_back({state, random.coin(0.2) ? FloatT(random.uniform(0, 1)) : 0});
    }
    ladder.samplers.push_back(sampler);
  }
  const auto chance_edge = [&](auto edge) {
    edge->seed_value = static_cast<std::uint64_t>(random.below(1'000'000));
    edge->refused = random.coin(0.2) ? 0.9 : random.uniform(0, 0.6);
    edge->dearer = random.coin() ? random.uniform(0, 0.3) : 0;
    return edge;
  };
  const auto draw = [&]() -> typename EdgeEvaluator<FloatT>::ConstPtr {
    if (random.coin(0.1)) return chance_edge(std::make_shared<ChanceEdge<FloatT>>());
    if (random.coin(0.1)) return std::make_shared<EuclideanDistanceEdgeEvaluator<FloatT>>();
    auto compound = std::make_shared<CompoundEdgeEvaluator<FloatT>>();
    compound->evaluators.push_back(std::make_shared<EuclideanDistanceEdgeEvaluator<FloatT>>());
    if (random.coin(0.3))
      compound->evaluators.push_back(chance_edge(std::make_shared<CheapChanceEdge<FloatT>>()));
    ladder.dear = chance_edge(std::make_shared<ChanceEdge<FloatT>>());
    compound->evaluators.push_back(ladder.dear);
    return compound;
  };
  if (random.coin())
    ladder.edges.push_back(draw());
  else
    for (int i = 0; i + 1 < rungs; ++i) ladder.edges.push_back(draw());
  if (random.coin(0.3)) {
    auto state = std::make_shared<ChanceState<FloatT>>();
    state->seed_value = static_cast<std::uint64_t>(random.below(1'000'000));
    ladder.states.push_back(state);
  }
  return ladder;
}

/// Asks everything about a ladder, and finds the least cost from the first rung on.
template <typename FloatT>
struct PlainSolver : Solver<FloatT> {
  std::int64_t edges_asked = 0;
  std::vector<double> least;  // to the nodes of the last rung
  SearchResult<FloatT> search() override {
    SearchResult<FloatT> result;
    const auto best = std::min_element(least.begin(), least.end());
    if (best == least.end() || *best == kNone) throw std::runtime_error("none");
    result.cost = static_cast<FloatT>(*best);
    return result;
  }

 protected:
  BuildStatus buildImpl(
      const std::vector<typename WaypointSampler<FloatT>::ConstPtr>& trajectory,
      const std::vector<typename EdgeEvaluator<FloatT>::ConstPtr>& edges,
      const std::vector<typename StateEvaluator<FloatT>::ConstPtr>& states) override {
    BuildStatus status;
    std::vector<StateSample<FloatT>> before;
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
      std::vector<StateSample<FloatT>> nodes;
      const auto samples = trajectory[i]->sample();
      if (samples.empty()) status.failed_vertices.push_back(i);
      for (StateSample<FloatT> sample : samples) {
        const auto [valid, cost] =
            states.empty() ? std::pair(true, FloatT(0)) : states[i]->evaluate(*sample.state);
        sample.cost += cost;
        if (valid) nodes.push_back(sample);
      }
      std::vector<double> here;
      bool any = false;
      for (const auto& node : nodes) {
        double cost = i == 0 ? 0 : kNone;
        for (std::size_t k = 0; k < before.size(); ++k, ++edges_asked) {
          const auto [valid, edge] = edges[i - 1]->evaluate(*before[k].state, *node.state);
          any |= valid;
          if (valid) cost = std::min(cost, least[k] + static_cast<double>(edge));
        }
        here.push_back(cost + static_cast<double>(node.cost));
      }
      if (i > 0 && !any) status.failed_edges.push_back(i - 1);
      least = here;
      before = nodes;
    }
    return status;
  }
};

template <typename FloatT>
std::optional<SearchResult<FloatT>> found(Solver<FloatT>& solver) {
  try {
    return solver.search();
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

template <typename FloatT>
void equals_the_plain_program(const char* name, double tolerance) {
  Random random(seed(name));
  int paths = 0, none = 0, failed = 0;
  std::int64_t dear = 0, all = 0;
  for (int k = trials(500); k > 0; --k) {
    const Ladder<FloatT> ladder = random_ladder<FloatT>(random);
    PlainSolver<FloatT> plain;
    const BuildStatus asked = plain.build(ladder.samplers, ladder.edges, ladder.states);
    const auto expected = found(plain);
    LazyLadderSolver<FloatT> lazy(1), threads(4);
    const BuildStatus status = lazy.build(ladder.samplers, ladder.edges, ladder.states);
    ASSERT_EQ(asked.failed_vertices, status.failed_vertices);
    ASSERT_EQ(asked.failed_edges, status.failed_edges);
    const auto result = found(lazy);
    ASSERT_EQ(expected.has_value(), result.has_value());
    (expected ? paths : none) += 1;
    failed += !status;
    if (expected) {
      ASSERT_NEAR(expected->cost, result->cost, tolerance * (1 + expected->cost));
      ASSERT_EQ(ladder.samplers.size(), result->trajectory.size());
      dear += lazy.counters().dear_edges;
      all += plain.edges_asked;
    }
    threads.build(ladder.samplers, ladder.edges, ladder.states);
    const auto again = found(threads);
    ASSERT_EQ(result.has_value(), again.has_value());
    if (result) {
      ASSERT_EQ(result->cost, again->cost);
      ASSERT_EQ(result->trajectory, again->trajectory);
    }
    ASSERT_EQ(lazy.counters().dear_edges, threads.counters().dear_edges);
  }
  std::printf(
      "%d ladders with a path: %lld of %lld edges asked of dear evaluators; %d without; "
      "%d builds failed\n",
      paths, static_cast<long long>(dear), static_cast<long long>(all), none, failed);
  EXPECT_GE(paths, at_least(250));
  EXPECT_GE(none, at_least(50));
  EXPECT_LT(dear, all / 4);
}

TEST(LazyLadderSolver, EqualsAPlainProgram) {
  equals_the_plain_program<double>("LazyLadderSolver.EqualsAPlainProgram", 1e-12);
}
TEST(LazyLadderSolver, EqualsAPlainProgramInSinglePrecision) {
  equals_the_plain_program<float>("LazyLadderSolver.EqualsAPlainProgramInSinglePrecision", 1e-5);
}

/// A long ladder whose dear evaluator takes 2 ms an edge and refuses nearly all.
Ladder<double> slow_ladder() {
  Random random(1);
  Ladder<double> ladder = random_ladder<double>(random);
  auto compound = std::make_shared<CompoundEdgeEvaluator<double>>();
  compound->evaluators.push_back(std::make_shared<EuclideanDistanceEdgeEvaluator<double>>());
  auto dear = std::make_shared<ChanceEdge<double>>();
  dear->refused = 0.999;
  dear->time = std::chrono::milliseconds(2);
  compound->evaluators.push_back(dear);
  ladder.edges = {compound};
  return ladder;
}

TEST(LazyLadderSolver, StopsAtItsDeadlineAndWhenItIsCancelled) {
  const Ladder<double> ladder = slow_ladder();
  const auto begin = std::chrono::steady_clock::now();
  LazyLadderSolver<double> solver;
  solver.set_deadline(std::chrono::milliseconds(20));
  solver.build(ladder.samplers, ladder.edges, ladder.states);
  EXPECT_THROW(solver.search(), std::runtime_error);
  solver.set_deadline({});
  const std::atomic<bool> cancel = true;
  solver.set_cancel(&cancel);
  solver.build(ladder.samplers, ladder.edges, ladder.states);
  EXPECT_THROW(solver.search(), std::runtime_error);
  EXPECT_EQ(0, solver.counters().dear_edges);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

}  // namespace
}  // namespace swivel::test
