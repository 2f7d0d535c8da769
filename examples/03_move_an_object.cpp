// SPDX-License-Identifier: BSD-3-Clause
// A planner is built once. An object moves a little at a time, and each plan re-uses what the move
// did not change.
#include <iostream>
#include <swivel/io/io.hpp>
#include <swivel/planner/plan/planner.hpp>

int main(int argc, char** argv) {
  swivel::Planner planner(
      swivel::io::load_path_problem(argc > 1 ? argv[1] : "data/problems/experiment_c.yaml"));
  swivel::PlanOptions options;
  options.planner = swivel::PlannerKind::kLazy;  // on one thread

  const swivel::PlanResult first = planner.plan(options);
  std::cout << to_string(first.status) << ", cost " << first.cost << ", "
            << first.counters.nodes_checked << " states asked about clearance\n";
  swivel::Pose rail = planner.problem().scene.back().pose;
  for (int step = 1; step <= 5; ++step) {
    rail.translation().x() += 0.002;
    planner.move("rail", rail);
    const swivel::PlanResult plan = planner.plan(options);
    std::cout << 2 * step << " mm: " << to_string(plan.status) << ", cost " << plan.cost << '\n';
  }
  planner.remove("rail");
  std::cout << "without it: " << to_string(planner.plan(options).status) << '\n';
}
