// SPDX-License-Identifier: BSD-3-Clause
// Measures the first plan of a process beside the next ones of the same problem, which find code
// and memory that the first one had to touch first.
//
//   first_plan PROBLEM    such as data/problems/experiment_c.yaml
//
// One line is printed: ms to load the file, to prepare the robot, of the first plan and of the
// median of the next 20, with `lazy` and one thread, and the page faults of the first and of all
// of the next ones.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace {

using namespace swivel;

/// Returns the page faults of this process so far that needed no disk.
long page_faults() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_minflt;
}

/// Returns how long a call takes, ms.
template <class Call>
double ms_of(const Call& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

}  // namespace

int main(int argc, char** argv) {
  constexpr int kNext = 20;
  std::string file;
  CLI::App app("The first plan of a process beside the next ones.", "first_plan");
  app.add_option("problem", file, "problem file with one path")->required();
  if (const auto code = bench::read_arguments(app, argc, argv)) return *code;
  PathProblem problem;
  const double load = ms_of([&] { problem = io::load_path_problem(file); });
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.threads = 1;
  std::optional<PreparedRobot> robot;
  const double prepare = ms_of([&] { robot.emplace(problem); });
  const auto plan_once = [&] { static_cast<void>(plan(*robot, problem, options)); };
  const long before = page_faults();
  const double first = ms_of(plan_once);
  const long between = page_faults();
  std::vector<double> next;
  for (int k = 0; k < kNext; ++k) next.push_back(ms_of(plan_once));
  std::nth_element(next.begin(), next.begin() + kNext / 2, next.end());
  std::printf("load=%.3f prepare=%.3f first=%.3f next=%.3f faults=%ld next_faults=%ld\n", load,
              prepare, first, next[kNext / 2], between - before, page_faults() - between);
}
