// SPDX-License-Identifier: BSD-3-Clause
// A robot from its URDF and SRDF; path and scene are made here. The tool draws a square in the air.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <swivel/io/io.hpp>
#include <swivel/planner/plan/planner.hpp>

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : "data/robots";
  swivel::PathProblem problem;
  problem.model = swivel::io::load_robot(folder / "iiwa14.urdf", folder / "iiwa14.srdf");
  problem.base_link = "base_link", problem.tip_link = "tool0";
  problem.tool.translation().z() = 0.1;  // the tool's point lies 0.1 m past tool0
  for (const auto& [x, y] :
       {std::pair{0.45, -0.1}, {0.45, 0.1}, {0.65, 0.1}, {0.65, -0.1}, {0.45, -0.1}})
    problem.waypoints.push_back({{x, y, 0.4}, {0, 1, 0, 0}});  // the tool looks down
  problem.limits.joint_margin = 0.05;

  swivel::PlanOptions options;
  options.evidence.postures = true;  // exact clearances of all rows
  const swivel::PlanResult result = swivel::plan(problem, options);
  std::cout << to_string(result.status) << ": " << result.trajectory.size() << " rows";
  if (result.min_clearance) std::cout << ", least clearance " << *result.min_clearance << " m";
  std::cout << '\n';
  for (const std::string& warning : result.warnings) std::cout << "warning: " << warning << '\n';
}
