// SPDX-License-Identifier: BSD-3-Clause
// Answers requests of graph_test.py by the library itself. Reads the name of a file: a line for
// each request, seven joints of the start, and the position and w x y z of each waypoint, in
// hexadecimal. Prints a line for each: ms, fraction, number of points, and all joints of all
// points.
#include <chrono>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include "swivel/io/io.hpp"
#include "swivel/planner/refine/cartesian_path.hpp"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  swivel::Robot robot;
  robot.model = swivel::io::load_robot(argv[2], argv[3]);
  robot.base_link = "base_link", robot.tip_link = "tool0";
  swivel::CartesianPathOptions options;
  options.max_step = 0.01;
  options.timed = true;
  options.rate = 100;
  options.plan.timeout_s = 10;
  swivel::Planner planner(robot);
  planner.prepare();
  std::ifstream in(argv[1]);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::vector<double> numbers;
    for (std::string word; words >> word;) numbers.push_back(std::stod(word));
    const swivel::Config start = swivel::Config::of(numbers.data());
    std::vector<swivel::Waypoint> waypoints;
    for (const double* n = numbers.data() + 7; n < numbers.data() + numbers.size(); n += 7)
      waypoints.push_back({{n[0], n[1], n[2]}, {n[3], n[4], n[5], n[6]}, {}});
    const auto begin = std::chrono::steady_clock::now();
    const swivel::CartesianPath path =
        swivel::compute_cartesian_path(planner, waypoints, start, options);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    const auto print = [](const swivel::Config& q) {
      for (const double one : q.coordinates()) std::printf(" %a", one);
    };
    std::printf("%.4f %a %zu", took.count(), path.fraction,
                path.motion ? path.motion->rows.size() : path.rows.size());
    if (path.motion)
      for (const swivel::TimedRow& row : path.motion->rows) print(row.row.q);
    else
      for (const swivel::TrajectoryRow& row : path.rows) print(row.q);
    std::printf("\n");
  }
}
