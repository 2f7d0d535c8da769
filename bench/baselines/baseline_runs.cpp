// SPDX-License-Identifier: BSD-3-Clause
// Runs the paper's experiments A and B: the two local methods and the planner from the same start.
//
//   baseline_runs [--rows FOLDER]    write joints and clearance along the path to FOLDER, as CSV
//   for plots
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arguments.hpp"
#include "baselines.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/io/io.hpp"

namespace {

using namespace swivel;

void print(const char* name, const baselines::TrackResult& result, double length) {
  std::printf("  %-18s %-13s at %4.1f %% of the path", name, baselines::to_string(result.reason),
              100 * result.s / length);
  if (!result.blocking.empty()) std::printf(", %s", result.blocking.c_str());
  if (result.reason != baselines::StopReason::kFinished && result.clearance)
    std::printf(", clearance %.2f mm", 1e3 * *result.clearance);
  if (result.projected_gradient)
    std::printf(", projected gradient %.1e m/rad (forth %+.3f, back %+.3f)",
                *result.projected_gradient, result.slopes[0], result.slopes[1]);
  std::printf("\n");
}

/// s, the clearance (m, empty when nothing is near) and the joints of each row.
void write_rows(const std::filesystem::path& file, const PreparedRobot& robot,
                const PathProblem& problem, const std::vector<std::pair<double, Config>>& rows) {
  const World world(robot.world(), problem);
  World::Query query(world);
  std::ostringstream text;
  text.precision(17);
  text << "s,clearance";
  for (const std::string& name : robot.arm().chain.joint_names) text << ',' << name;
  for (const auto& [s, q] : rows) {
    text << '\n' << s << ',';
    if (const auto clearance = query.clearance(q)) text << clearance->distance;
    for (const double joint : q.coordinates()) text << ',' << joint;
  }
  io::write_file(file, text.str() + "\n");
}

/// The rows of a tracker are in equal steps up to result.s.
std::vector<std::pair<double, Config>> rows_of(const baselines::TrackResult& result) {
  std::vector<std::pair<double, Config>> rows;
  const auto steps = static_cast<double>(std::max<std::size_t>(2, result.rows.size()) - 1);
  for (const Config& q : result.rows)
    rows.emplace_back(result.s * static_cast<double>(rows.size()) / steps, q);
  return rows;
}

void run_swivel(const char* name, const PreparedRobot& robot, const PathProblem& problem,
                double length, const std::filesystem::path& rows) {
  PlanOptions options;
  options.check = false;  // the time of planning is measured
  options.planner = PlannerKind::kLazy;
  options.evidence = Evidence::all();
  const PlanResult planned = plan(robot, problem, options);
  std::printf("  %-18s %s", name, to_string(planned.status));
  if (planned.status == PlanStatus::kSolved) {
    std::printf(", cost %.4f, least clearance %.2f mm", planned.cost,
                1e3 * planned.min_clearance.value_or(0));
    std::vector<std::pair<double, Config>> all;
    for (const TrajectoryRow& row : planned.trajectory) all.emplace_back(row.s, row.q);
    if (!rows.empty()) write_rows(rows, robot, problem, all);
  } else if (planned.diagnosis->reached_s) {
    std::printf(": no path goes past %.1f %% of the path: %s",
                100 * *planned.diagnosis->reached_s / length,
                words(planned.diagnosis->cause).c_str());
  }
  std::printf("\n");
}

void run(const char* title, const std::filesystem::path& file, const std::filesystem::path& rows) {
  const PathProblem problem = io::load_path_problem(file);
  const PreparedRobot robot(problem);
  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
  const double length = path.layer(path.size() - 1).s;
  std::printf("%s, %s\n", title, file.filename().c_str());
  const auto jacobian = baselines::track_jacobian(robot, problem),
             null_space = baselines::track_null_space(robot, problem);
  print("Jacobian", jacobian, length);
  print("null space", null_space, length);
  if (!rows.empty()) {
    write_rows(rows / (file.stem().string() + "_jacobian.csv"), robot, problem, rows_of(jacobian));
    write_rows(rows / (file.stem().string() + "_null_space.csv"), robot, problem,
               rows_of(null_space));
  }
  const auto file_of = [&](const char* who) {
    return rows.empty() ? rows : rows / (file.stem().string() + who);
  };
  run_swivel("Swivel, same start", robot, problem, length, file_of("_swivel.csv"));
  PathProblem free = problem;
  free.start.reset();
  run_swivel("Swivel, free start", robot, free, length, file_of("_swivel_free.csv"));
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path problems = std::filesystem::path(SWIVEL_DATA_DIR) / "problems";
  std::filesystem::path rows;
  CLI::App app(
      "Experiments A and B of the paper: what the two local methods and the planner do from the "
      "same start.",
      "baseline_runs");
  app.add_option("--rows", rows, "folder for joints and clearance along the path, CSV")
      ->check(CLI::ExistingDirectory);
  if (const auto code = bench::read_arguments(app, argc, argv)) return *code;
  try {
    run("A, joint limits", problems / "experiment_a_start.yaml", rows);
    run("B, collision", problems / "experiment_b.yaml", rows);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
