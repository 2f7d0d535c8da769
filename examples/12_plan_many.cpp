// SPDX-License-Identifier: BSD-3-Clause
// One path in many scenes, on all cores. What depends on the path alone is computed once; each row
// is that of a plan of its scene alone.
#include <iostream>
#include <swivel/io/problems/problem.hpp>
#include <swivel/planner/study/plan_many.hpp>

int main(int argc, char** argv) {
  const swivel::Problem problem =
      swivel::io::load_problem(argc > 1 ? argv[1] : "data/problems/experiment_c.yaml");
  const auto scene = [&](std::uint64_t number) {  // called by several threads
    swivel::Problem moved = problem;
    for (swivel::SceneObject& object : moved.scene)
      if (object.name == "post")
        object.pose.translation().x() += 0.01 * static_cast<double>(number);
    return moved;
  };
  swivel::ManyOptions options;
  options.timeout_each_s = 10;
  options.plan.evidence.cause = false;  // where there is no path, why is not asked for

  swivel::plan_many(problem, 20, scene, options, [](const swivel::EpisodeRow& row) {
    std::cout << row.episode << ": " << to_string(row.status);
    if (row.cost) std::cout << ", cost " << *row.cost;
    std::cout << '\n';
  });
}
