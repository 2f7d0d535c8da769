// SPDX-License-Identifier: BSD-3-Clause
// A plan ends when its time is over, and when another thread says so.
#include <chrono>
#include <iostream>
#include <stop_token>
#include <swivel/io/io.hpp>
#include <swivel/planner/plan/planner.hpp>
#include <thread>

int main(int argc, char** argv) {
  swivel::PathProblem problem =
      swivel::io::load_path_problem(argc > 1 ? argv[1] : "data/problems/experiment_c.yaml");
  problem.resolution = {.ds = 0.0002, .dphi = 0.0002};  // so fine that an answer takes minutes
  swivel::Planner planner(problem);
  planner.prepare();

  swivel::PlanOptions options;
  options.timeout_s = 0.005;
  std::cout << "5 ms: " << to_string(planner.plan(options).status) << '\n';

  std::stop_source cancel;
  options.timeout_s.reset();
  options.stop = cancel.get_token();
  std::jthread user([&cancel] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    cancel.request_stop();
  });
  std::cout << "another thread: " << to_string(planner.plan(options).status) << '\n';
}
