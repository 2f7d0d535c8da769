// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <memory>

#include "commands.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/check.hpp"
#include "swivel/planner/planner.hpp"

namespace swivel::cli {

namespace {

struct CheckArguments {
  std::string problem, trajectory;
  EpisodeChoice episode;
};

int run(const CheckArguments& arguments) {
  const Problem problem = arguments.episode.apply(io::load_problem(arguments.problem));
  const PreparedRobot robot(problem);
  const auto rows = io::load_trajectory(arguments.trajectory, robot.arm().chain.joint_names);
  const CheckResult result = check_trajectory(problem, rows);
  for (const std::string& failure : result.failures) std::printf("%s\n", failure.c_str());
  std::printf("%s: %zu rows, tool within %.2g m and %.2g rad of the path at rows, within %.3f mm between, cost %.9g",
              result.passed ? "passed" : "failed", rows.size(), result.worst_position, result.worst_angle,
              1e3 * result.worst_path_error, result.cost);
  if (result.min_clearance) std::printf(", clearance at least %.3f mm", 1e3 * *result.min_clearance);
  std::printf("\n");
  return result.passed ? kOk : kNo;
}

}  // namespace

void add_check(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("check", "Verify a trajectory, independently of the planners");
  auto arguments = std::make_shared<CheckArguments>();  // shared: lives as long as the callback that reads it
  command->add_option("problem", arguments->problem, "problem file")->required();
  command->add_option("trajectory", arguments->trajectory, "trajectory file (CSV)")->required();
  arguments->episode.add_to(*command);
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace swivel::cli
