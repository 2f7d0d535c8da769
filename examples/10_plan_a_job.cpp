// SPDX-License-Identifier: BSD-3-Clause
// A job: several strokes, from home and back, in the order and the directions that cost least. It
// is refined, timed and written as a motion for a controller.
#include <fstream>
#include <iostream>
#include <swivel/core/answer/answer_text.hpp>
#include <swivel/io/io.hpp>
#include <swivel/planner/problem/problem_planner.hpp>

int main(int argc, char** argv) {
  swivel::Problem job =
      swivel::io::load_problem(argc > 1 ? argv[1] : "data/problems/ur5e_deburr_plate_job.yaml");
  job.arm().order = swivel::StrokeOrder::kBest;
  swivel::TimingOptions timing;
  timing.rate =
      100;  // samples a second; along strokes the tool has the speed that the file asks for
  swivel::ProblemPlanner planner(job, {.refine = true, .timing = timing});
  const swivel::Answer answer = planner.plan({});
  if (!answer.is_whole()) return std::cerr << whole_text(answer, planner.problem()), 1;

  for (const swivel::RunAnswer& run : answer.arm().runs)
    std::cout << words(run.run, planner.problem()) << '\n';
  std::cout << "cost " << answer.lattice_cost << ", refined " << answer.cost << '\n';
  for (const swivel::ProcessEvent& event : answer.timed()->arms.front().events)
    std::cout << event.t << " s: process " << (event.on ? "on" : "off") << '\n';
  if (argc > 2)
    std::ofstream(argv[2]) << swivel::io::motion_text(
        answer, executed_problem(planner.problem(), answer), argv[2]);
}
