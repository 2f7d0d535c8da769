// SPDX-License-Identifier: BSD-3-Clause
// Where there is no path, the result says how far one gets and what stops it.
#include <iostream>
#include <swivel/io/io.hpp>
#include <swivel/planner/plan/planner.hpp>

int main(int argc, char** argv) {
  swivel::PathProblem problem =
      swivel::io::load_path_problem(argc > 1 ? argv[1] : "data/problems/experiment_a.yaml");
  swivel::SceneObject& wall = problem.scene.emplace_back();
  wall.name = "wall";
  wall.shape = swivel::Box{{0.3, 0.02, 0.3}};
  wall.pose.translation() = problem.waypoints.front().position + swivel::Vector3d(0, 0.3, 0);

  swivel::PlanOptions options;
  options.evidence.layers = true;  // which layers have no valid node, and why
  const swivel::PlanResult result = swivel::plan(problem, options);
  const swivel::Diagnosis& diagnosis = *result.diagnosis;
  std::cout << to_string(result.status) << ": " << words(diagnosis.cause) << '\n';
  if (diagnosis.reached_s)
    std::cout << "a valid path reaches s = " << *diagnosis.reached_s << " m\n";
  if (diagnosis.without_it_s)
    std::cout << "without that, paths reach s = " << *diagnosis.without_it_s << " m at least\n";
  for (const auto& [cause, count] : diagnosis.removed)
    std::cout << count << " nodes or edges are removed there by " << words(cause) << '\n';
  for (const swivel::EmptyLayers& run : diagnosis.empty_layers)
    std::cout << "layers " << run.first << " to " << run.last
              << " have no valid node: " << words(run.cause) << '\n';
}
