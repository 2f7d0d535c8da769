// SPDX-License-Identifier: BSD-3-Clause
// Measures how late a plan ends after its time-out, in processor time of its thread, on experiments
// of several sizes, solved and infeasible.
//
//   deadlines [TIMES]    default 100, for each size and deadline
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "arguments.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace {

using namespace swivel;

double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace

int main(int argc, char** argv) {
  int times = 100;
  CLI::App app("How late a plan ends whose time is over, in time of its thread's processor.",
               "deadlines");
  app.add_option("times", times, "plans of each size and deadline")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  if (const auto code = bench::read_arguments(app, argc, argv)) return *code;
  struct Size {
    double ds, dphi;
  };
  for (const char* name : {"experiment_c", "experiment_a_start"})
    for (const Size& size : {Size{0.005, 0.05}, Size{0.001, 0.01}, Size{0.0005, 0.003}}) {
      PathProblem problem =
          io::load_path_problem(std::string(SWIVEL_DATA_DIR "/problems/") + name + ".yaml");
      problem.resolution.ds = size.ds;
      problem.resolution.dphi = size.dphi;
      for (const double deadline : {0.002, 0.005, 0.020}) {
        PlanOptions options;
        options.planner = PlannerKind::kLazy;
        options.timeout_s = deadline;
        std::vector<double> late;
        int stopped = 0, partial = 0;
        std::int64_t nodes = 0;
        for (int k = 0; k < times; ++k) {
          Planner planner(problem);
          planner.prepare();
          const double start = cpu_ms();
          const PlanResult result = planner.plan(options);
          late.push_back(cpu_ms() - start - 1e3 * deadline);
          stopped += result.status == PlanStatus::kTimeout;
          partial += !result.partial.empty();
          nodes = std::max(nodes, result.lattice.nodes);
        }
        std::sort(late.begin(), late.end());
        std::printf(
            "%-19s %9lld nodes, %2.0f ms: %3d of %d stopped, %3d with rows; late by %6.2f ms "
            "(median), %6.2f (99 %%)\n",
            name, static_cast<long long>(nodes), 1e3 * deadline, stopped, times, partial,
            late[late.size() / 2],
            late[static_cast<std::size_t>(0.99 * static_cast<double>(late.size() - 1))]);
      }
    }
}
