// SPDX-License-Identifier: BSD-3-Clause
// Two arms at one time: one carries a plate, the other runs its tool along the plate's edge. Both
// move by one clock, and keep clear of each other.
#include <iostream>
#include <swivel/core/answer/answer_text.hpp>
#include <swivel/io/io.hpp>
#include <swivel/planner/problem/problem_planner.hpp>

int main(int argc, char** argv) {
  const swivel::Problem cell =
      swivel::io::load_problem(argc > 1 ? argv[1] : "data/problems/sda10f_plate_workcell.yaml");
  swivel::TimingOptions timing;
  timing.speed = 0.05;  // of the faster tool, m/s
  swivel::ProblemPlanner planner(cell, {.timing = timing});
  swivel::PlanOptions options;
  options.evidence = swivel::Evidence::all();
  const swivel::Answer answer = planner.plan(options);
  if (!answer.is_whole()) return std::cerr << whole_text(answer, planner.problem()), 1;

  for (const swivel::ArmAnswer& arm : answer.arms)
    std::cout << arm.name << ": cost " << arm.cost() << ", " << arm.rows().size() << " rows\n";
  if (const auto& nearest = answer.pair.nearest)
    std::cout << "the arms come as near as " << nearest->clearance << " m: " << nearest->bodies[0]
              << ", " << nearest->bodies[1] << '\n';
  const swivel::Motion& motion = *answer.timed();
  std::cout << motion.duration << " s, " << motion.arms[0].rows.size() << " samples of both\n";
}
