// SPDX-License-Identifier: BSD-3-Clause
// Measures re-planning while an object walks 1 mm a step: a planner that remembers, compared with
// fresh plans on a prepared robot.
//
//   replanning [STEPS] [PROBLEM ...]    default 1000 steps of experiment C
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "settings.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace {

using namespace swivel;

double us_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
      .count();
}
double at(std::vector<double> sorted, double share) {
  std::sort(sorted.begin(), sorted.end());
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

void walk(const PathProblem& problem, const char* setting, const std::string& object, int steps) {
  PlanOptions options;
  options.check = false;  // the time of planning is measured
  options.planner = PlannerKind::kLazy;
  const PreparedRobot robot(problem);
  Planner planner(problem);
  (void)planner.plan(options);
  const auto k =
      static_cast<std::size_t>(std::find_if(problem.scene.begin(), problem.scene.end(),
                                            [&](const auto& o) { return o.name == object; }) -
                               problem.scene.begin());
  PathProblem moved = problem;
  std::mt19937_64 random(7);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1.0p-53 * 2 - 1; };
  std::vector<double> remembered, fresh;
  int solved = 0, unequal = 0;
  for (int step = 0; step < steps; ++step) {
    Vector3d direction(uniform(), uniform(), uniform());
    Pose& pose = moved.scene[k].pose;
    pose.translation() += 0.001 * direction.normalized();
    auto start = std::chrono::steady_clock::now();
    planner.move(object, pose);
    const PlanResult again = planner.plan(options);
    remembered.push_back(us_since(start));
    start = std::chrono::steady_clock::now();
    const PlanResult alone = plan(robot, moved, options);
    fresh.push_back(us_since(start));
    solved += alone.status == PlanStatus::kSolved;
    bool equal = again.status == alone.status && again.cost == alone.cost &&
                 again.trajectory.size() == alone.trajectory.size();
    for (std::size_t i = 0; equal && i < alone.trajectory.size(); ++i)
      equal = again.trajectory[i].q == alone.trajectory[i].q;
    unequal += !equal;
  }
  std::printf(
      "%-4s %-12s %5d steps, %5d solved, %d unequal; us: remembered %7.0f (99 %% %7.0f), fresh "
      "%7.0f (99 %% %7.0f), ratio %.2f\n",
      setting, object.c_str(), steps, solved, unequal, at(remembered, 0.5), at(remembered, 0.99),
      at(fresh, 0.5), at(fresh, 0.99), at(remembered, 0.5) / at(fresh, 0.5));
}

}  // namespace

int main(int argc, char** argv) {
  int steps = 1000;
  std::vector<std::string> files;
  CLI::App app(
      "Re-planning while an object walks 1 mm a step: a planner that remembers beside fresh plans.",
      "replanning");
  app.add_option("steps", steps, "steps of each object")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("problems", files, "problem files of one arm and one path")
      ->default_str("experiment C at two resolutions");
  if (const auto code = bench::read_arguments(app, argc, argv)) return *code;
  for (const std::string& file : files) {
    const PathProblem problem = io::load_path_problem(file);
    std::printf("%s\n", file.c_str());
    for (const SceneObject& object : problem.scene) walk(problem, "", object.name, steps);
  }
  if (!files.empty()) return 0;
  PathProblem problem = io::load_path_problem(SWIVEL_DATA_DIR "/problems/experiment_c.yaml");
  for (const bench::Setting& setting : bench::kSettings) {
    if (setting.name[1] != '1' && setting.name[1] != '4') continue;
    bench::set_resolution(problem, setting);
    for (const char* object : {"rail", "post", "door"}) walk(problem, setting.name, object, steps);
  }
}
