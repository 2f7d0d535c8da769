// SPDX-License-Identifier: BSD-3-Clause
// Whole plans of the paper's experiments on a prepared robot: scene / planner / resolution / edge mode / threads. Report stages are
// not timed. Rows of lazy and parallel have counters eager_ms, eager_dp_ms and the speed-ups over both: the eager planners are run
// on the same problem before and after each repetition, in the same process.
//   plan_benchmark --benchmark_filter=^c/lazy    every argument of google-benchmark applies
#include <benchmark/benchmark.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "context.hpp"
#include "settings.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace {

using namespace swivel;

struct Case {
  PlannerKind planner;
  EdgeMode edges;
  int threads;
  bool compare;  ///< with the eager planners
};

PlanOptions options_for(PlannerKind planner, int threads) {
  PlanOptions options;
  options.planner = planner;
  options.threads = threads;
  return options;
}

/// Adds the milliseconds that one eager plan takes, by planner.
struct EagerTimes {
  double eager = 0, eager_dp = 0;
  void measure(const PreparedRobot& robot, const Problem& problem) {
    eager += plan(robot, problem, options_for(PlannerKind::kEager, 1)).time_ms["plan"];
    eager_dp += plan(robot, problem, options_for(PlannerKind::kEagerDp, 1)).time_ms["plan"];
  }
};

void run(benchmark::State& state, Problem problem, const Case& what, const bench::Setting& setting) {
  const PreparedRobot robot(problem);
  // FCL's trees of meshes belong to the robot and are built at its first question.
  bench::set_resolution(problem, bench::kSettings[0]);
  problem.limits.edges = EdgeMode::kNodes;
  static_cast<void>(plan(robot, problem, options_for(PlannerKind::kEagerDp, 1)));
  bench::set_resolution(problem, setting);
  problem.limits.edges = what.edges;
  EagerTimes eager;
  if (what.compare) eager.measure(robot, problem);
  PlanResult result;
  double ms = 0;
  for (auto _ : state) {
    result = plan(robot, problem, options_for(what.planner, what.threads));
    benchmark::DoNotOptimize(result.trajectory.data());
    ms += result.time_ms["plan"];
  }
  const auto nodes = static_cast<double>(result.lattice.nodes);
  state.SetItemsProcessed(state.iterations() * result.lattice.nodes);
  const Counters& work = result.counters;
  for (const auto& [name, value] : {std::pair{"nodes_checked", work.nodes_checked},
                                    {"edges_checked", work.edges_checked},
                                    {"fcl_calls", work.fcl_calls},
                                    {"certified", work.certified_free + work.certified_colliding},
                                    {"expansions", work.expansions},
                                    {"iterations", work.iterations},
                                    {"ik_nodes", work.ik_nodes},
                                    {"edges", work.edges}})
    state.counters[name] = static_cast<double>(value);
  state.counters["nodes"] = nodes;
  state.counters["layers"] = result.lattice.layers;
  state.counters["cost"] = result.cost;
  state.counters["solved"] = result.status == PlanStatus::kSolved;
  if (!what.compare) return;
  eager.measure(robot, problem);
  ms /= static_cast<double>(state.iterations());
  state.counters["eager_ms"] = eager.eager / 2;
  state.counters["eager_dp_ms"] = eager.eager_dp / 2;
  state.counters["speed_up_over_eager"] = eager.eager / 2 / ms;
  state.counters["speed_up_over_eager_dp"] = eager.eager_dp / 2 / ms;
}

std::vector<Case> cases(int setting) {
  const bool paper = setting < bench::kPaperSettings;
  std::vector<Case> all;
  // Eager planners with continuous edges take minutes: every edge of the lattice is swept through FCL.
  if (setting <= bench::kPaperSettings) {
    all.push_back({PlannerKind::kEager, EdgeMode::kNodes, 1, false});
    all.push_back({PlannerKind::kEagerDp, EdgeMode::kNodes, 1, false});
  }
  for (const EdgeMode edges : {EdgeMode::kNodes, EdgeMode::kContinuous}) {
    const bool compare = paper && edges == EdgeMode::kNodes;
    all.push_back({PlannerKind::kLazy, edges, 1, compare});
    for (int threads = 1; threads <= std::max(2, static_cast<int>(std::thread::hardware_concurrency())); threads *= 2)
      all.push_back({PlannerKind::kParallel, edges, threads, compare});
  }
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path problems = std::filesystem::path(SWIVEL_DATA_DIR) / "problems";
  for (const std::string scene : {"a", "b", "c", "c_20k"}) {
    const Problem problem = io::load_problem(problems / ("experiment_" + scene + ".yaml"));
    const int settings = scene == "c" ? static_cast<int>(std::size(bench::kSettings)) : bench::kPaperSettings;
    for (int k = 0; k < settings; ++k) {
      const bench::Setting& setting = bench::kSettings[k];
      for (const Case& what : cases(k)) {
        std::string label = scene + "/" + to_string(what.planner) + "/" + setting.name +
                            (what.edges == EdgeMode::kNodes ? "/nodes" : "/continuous");
        if (what.planner == PlannerKind::kParallel) label += "/threads:" + std::to_string(what.threads);
        benchmark::RegisterBenchmark(label.c_str(), [=](benchmark::State& state) { run(state, problem, what, setting); })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
      }
    }
  }
  for (const auto& [key, value] : bench::context()) benchmark::AddCustomContext(key, value);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
