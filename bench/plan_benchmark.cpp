// SPDX-License-Identifier: BSD-3-Clause
// Whole plans of the paper's experiments on a prepared robot: planner x resolution x edge mode. Report stages are not timed.
//   plan_benchmark --benchmark_filter=c/lazy    every argument of google-benchmark applies
#include <benchmark/benchmark.h>

#include <filesystem>
#include <map>
#include <string>

#include "swivel/core/isa.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/planner.hpp"

namespace {

using namespace swivel;

struct Setting {
  const char* name;
  double ds, dphi;
};
constexpr Setting kSettings[] = {{"#1", 0.02, 0.2}, {"#2", 0.005, 0.2}, {"#3", 0.02, 0.05}, {"#4", 0.005, 0.05}};

void run(benchmark::State& state, Problem problem, PlannerKind planner, const Setting& setting, EdgeMode edges) {
  problem.resolution.ds = setting.ds;
  problem.resolution.dphi = setting.dphi;
  problem.limits.edges = edges;
  const PreparedRobot robot(problem);
  PlanOptions options;
  options.planner = planner;
  options.threads = 1;
  options.report = false;
  PlanResult result;
  for (auto _ : state) {
    result = plan(robot, problem, options);
    benchmark::DoNotOptimize(result.trajectory.data());
  }
  state.SetItemsProcessed(state.iterations() * result.lattice.nodes);
  state.counters["cost"] = result.cost;
  state.counters["nodes"] = static_cast<double>(result.lattice.nodes);
  state.counters["nodes_checked"] = static_cast<double>(result.counters.nodes_checked);
  state.counters["fcl_calls"] = static_cast<double>(result.counters.fcl_calls);
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path problems = std::filesystem::path(SWIVEL_DATA_DIR) / "problems";
  for (const char* name : {"a", "b", "c", "c_20k"}) {
    const Problem problem = io::load_problem(problems / (std::string("experiment_") + name + ".yaml"));
    for (const PlannerKind planner : {PlannerKind::kEager, PlannerKind::kEagerDp, PlannerKind::kLazy, PlannerKind::kParallel})
      for (const Setting& setting : kSettings)
        for (const EdgeMode edges : {EdgeMode::kNodes, EdgeMode::kContinuous}) {
          const bool eager = planner == PlannerKind::kEager || planner == PlannerKind::kEagerDp;
          if (eager && edges == EdgeMode::kContinuous) continue;  // minutes each: every edge of the lattice swept through FCL
          const std::string label = std::string(name) + "/" + to_string(planner) + "/" + setting.name +
                                    (edges == EdgeMode::kNodes ? "/nodes" : "/continuous");
          benchmark::RegisterBenchmark(label.c_str(), [=](benchmark::State& state) {
            run(state, problem, planner, setting, edges);
          })->Unit(benchmark::kMillisecond);
        }
  }
  benchmark::AddCustomContext("vector_unit", to_string(active_isa()));
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
