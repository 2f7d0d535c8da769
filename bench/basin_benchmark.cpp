// SPDX-License-Identifier: BSD-3-Clause
// Measures how near refined paths come to the optimum of their basin, on random poses: their cost
// divided by that of a fine lattice about them (basin_lattice.hpp).
//
//   basin_benchmark PROBLEM.yaml [--episodes N] [--first N] [--metric l2|l1|max|time]
//                   [--about] [--margins]
//       --about      use lattices that have the refined path among their nodes
//       --margins    nodes also keep the margins that refinement keeps
//
// Episodes are those of seed 1, by default 100; a problem without `vary` is planned once. A pose
// takes a second, and up to a minute near obstacles. Prints one line for each pose, then median and
// percentiles.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "basin_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/refine/refine.hpp"

namespace {

using namespace swivel;

struct Options {
  std::string file;
  std::uint64_t episodes = 100, first = 0;
  std::optional<CostMetric> metric;
  bench::BasinLattice::Rules rules;
};

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

void run(const Options& options) {
  PathProblem base = with_motion_defaults(io::load_path_problem(options.file));
  if (options.metric) base.cost.metric = *options.metric;
  const PreparedRobot robot(base);
  std::vector<double> ratios;
  for (std::uint64_t episode = options.first;
       episode < options.first + (base.vary.empty() ? 1 : options.episodes); ++episode) {
    const PathProblem problem = base.vary.empty() ? base : episode_problem(base, 1, episode);
    PlanOptions lazy;
    lazy.planner = PlannerKind::kLazy;
    const PlanResult found = plan(robot, problem, lazy);
    if (found.status != PlanStatus::kSolved) continue;
    const Refined refined = refine(robot, problem, found.trajectory);
    const ToolPath path = problem_path(problem, robot.arm().chain);
    const auto redundancy =
        make_redundancy(robot.arm().chain, robot.arm_class(), path, problem, {});
    double sine = 1;
    for (const TrajectoryRow& row : refined.rows)
      sine = std::min(sine, redundancy->singular_sine(row.q));
    bench::BasinLattice lattice(robot, problem, *redundancy, refined.rows, options.rules);
    const auto best = lattice.solve();
    ratios.push_back(refined.cost / best.cost);
    std::printf(
        "%3d: cost %.5f, refined %.5f, fine lattice %.5f%s, ratio %.5f; at most %.4f rad away; "
        "sine %.4f and %.4f; %d rounds\n",
        static_cast<int>(episode), refined.cost_before, refined.cost, best.cost,
        best.valid ? "" : " (bound)", ratios.back(), best.farthest, sine, best.singular_sine,
        best.rounds);
    std::fflush(stdout);
  }
  if (ratios.empty()) return;
  std::printf(
      "%zu poses, refined over fine lattice: median %.5f, 90 %% %.5f, 95 %% %.5f, most %.5f; %d "
      "above 1.001\n",
      ratios.size(), percentile(ratios, 0.5), percentile(ratios, 0.9), percentile(ratios, 0.95),
      percentile(ratios, 1),
      static_cast<int>(
          std::count_if(ratios.begin(), ratios.end(), [](double x) { return x > 1.001; })));
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  const std::map<std::string, CostMetric> metrics{{"l2", CostMetric::kL2},
                                                  {"l1", CostMetric::kL1},
                                                  {"max", CostMetric::kMax},
                                                  {"time", CostMetric::kTime}};
  CLI::App app(
      "How near refined paths come to the optimum of their basin: their cost over that of a fine "
      "lattice about them.",
      "basin_benchmark");
  app.add_option("problem", options.file, "problem file; without `vary` it is planned once")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--episodes", options.episodes, "poses of seed 1")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--first", options.first, "number of the first pose")->capture_default_str();
  app.add_option("--metric", options.metric, "in place of the problem's")
      ->transform(CLI::CheckedTransformer(metrics));
  app.add_flag("--about", options.rules.about_path, "lattices that have the refined path in them");
  app.add_flag("--margins", options.rules.margins, "nodes keep what refinement keeps besides");
  if (const auto code = bench::read_arguments(app, argc, argv)) return *code;
  try {
    run(options);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
