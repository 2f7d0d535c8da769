// SPDX-License-Identifier: BSD-3-Clause
// The example of README.md: plans a problem file, prints the joints.
#include <iostream>
#include <swivel/io/io.hpp>
#include <swivel/planner/plan/planner.hpp>

int main(int argc, char** argv) {
  const swivel::PathProblem problem =
      swivel::io::load_path_problem(argc > 1 ? argv[1] : "data/problems/experiment_a.yaml");
  const swivel::PlanResult result = swivel::plan(problem);
  if (result.status != swivel::PlanStatus::kSolved)
    return std::cerr << to_string(result.status) << '\n', 1;
  for (const swivel::TrajectoryRow& row : result.trajectory)
    std::cout << row.s << ": " << row.q.coordinates().transpose() << '\n';
}
