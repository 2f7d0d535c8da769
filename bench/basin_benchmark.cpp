// SPDX-License-Identifier: BSD-3-Clause
// How near refined paths come to the optimum of their basin, on random poses: their cost over that of a fine lattice about them
// (basin_lattice.hpp).
//   basin_benchmark PROBLEM.yaml [--episodes N] [--first N] [--metric l2|max|time] [--about] [--margins]
// Episodes of seed 1, default 100; a problem without `vary` is planned once. --about: lattices that have the refined path in them;
// --margins: nodes keep what refinement keeps besides. A second a pose, up to a minute near obstacles. One line for each pose,
// median and percentiles below.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "basin_lattice.hpp"
#include "swivel/core/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/motion.hpp"
#include "swivel/planner/refine.hpp"

namespace {

using namespace swivel;

struct Options {
  std::string file;
  std::uint64_t episodes = 100, first = 0;
  std::optional<CostMetric> metric;
  bench::BasinLattice::Rules rules;
};

CostMetric metric_of(const std::string& name) {
  if (name == "l2") return CostMetric::kL2;
  if (name == "max") return CostMetric::kMax;
  if (name == "time") return CostMetric::kTime;
  throw InputError("basin_benchmark: --metric " + name + ": allowed are l2, max, time");
}

Options options_of(int argc, char** argv) {
  Options options;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--about")
      options.rules.about_path = true;
    else if (word == "--margins")
      options.rules.margins = true;
    else if ((word == "--episodes" || word == "--first") && k + 1 < argc)
      (word == "--first" ? options.first : options.episodes) = std::strtoull(argv[++k], nullptr, 10);
    else if (word == "--metric" && k + 1 < argc)
      options.metric = metric_of(argv[++k]);
    else if (options.file.empty() && word[0] != '-')
      options.file = word;
    else
      throw InputError("basin_benchmark: " + word + ": allowed are a problem, --episodes, --first, --metric, --about, --margins");
  }
  if (options.file.empty())
    throw InputError("basin_benchmark PROBLEM.yaml [--episodes N] [--first N] [--metric l2|max|time] [--about] [--margins]");
  return options;
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

void run(const Options& options) {
  Problem base = with_motion_defaults(io::load_problem(options.file));
  if (options.metric) base.cost.metric = *options.metric;
  const PreparedRobot robot(base);
  std::vector<double> ratios;
  for (std::uint64_t episode = options.first; episode < options.first + (base.vary.empty() ? 1 : options.episodes); ++episode) {
    const Problem problem = base.vary.empty() ? base : episode_problem(base, 1, episode);
    PlanOptions lazy;
    lazy.planner = PlannerKind::kLazy;
    const PlanResult found = plan(robot, problem, lazy);
    if (found.status != PlanStatus::kSolved) continue;
    const Refined refined = refine(robot, problem, found.trajectory);
    const ToolPath path = problem_path(problem, robot.arm().chain);
    const auto redundancy = make_redundancy(robot.arm().chain, robot.arm_class(), path, problem, {});
    double sine = 1;
    for (const TrajectoryRow& row : refined.rows) sine = std::min(sine, redundancy->singular_sine(row.q));
    bench::BasinLattice lattice(robot, problem, *redundancy, refined.rows, options.rules);
    const auto best = lattice.solve();
    ratios.push_back(refined.cost / best.cost);
    std::printf(
        "%3d: cost %.5f, refined %.5f, fine lattice %.5f%s, ratio %.5f; at most %.4f rad away; sine %.4f and %.4f; %d rounds\n",
        static_cast<int>(episode), refined.cost_before, refined.cost, best.cost, best.valid ? "" : " (bound)", ratios.back(),
        best.farthest, sine, best.singular_sine, best.rounds);
    std::fflush(stdout);
  }
  if (ratios.empty()) return;
  std::printf("%zu poses, refined over fine lattice: median %.5f, 90 %% %.5f, 95 %% %.5f, most %.5f; %d above 1.001\n",
              ratios.size(), percentile(ratios, 0.5), percentile(ratios, 0.9), percentile(ratios, 0.95), percentile(ratios, 1),
              static_cast<int>(std::count_if(ratios.begin(), ratios.end(), [](double x) { return x > 1.001; })));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(options_of(argc, argv));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
