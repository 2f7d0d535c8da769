// SPDX-License-Identifier: BSD-3-Clause
// Experiments A and B of the paper: what the two local methods and the planner do from the same start.
//   baseline_runs [--rows FOLDER]    FOLDER gets the joints of every tracker as CSV, for plots
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <sstream>
#include <string_view>

#include "baselines.hpp"
#include "swivel/io/io.hpp"

namespace {

using namespace swivel;

void print(const char* name, const baselines::TrackResult& result, double length) {
  std::printf("  %-11s %-13s at %4.1f %% of the path", name, baselines::to_string(result.reason), 100 * result.s / length);
  if (!result.blocking.empty()) std::printf(", %s", result.blocking.c_str());
  if (result.reason != baselines::StopReason::kFinished && result.clearance)
    std::printf(", clearance %.2f mm", 1e3 * *result.clearance);
  if (result.projected_gradient)
    std::printf(", projected gradient %.1e m/rad (forth %+.3f, back %+.3f)", *result.projected_gradient, result.slopes[0],
                result.slopes[1]);
  std::printf("\n");
}

/// s and the joints of each row; rows are equal steps up to result.s.
void write_rows(const std::filesystem::path& file, const PreparedRobot& robot, const baselines::TrackResult& result) {
  std::ostringstream text;
  text.precision(17);
  text << "s";
  for (const std::string& name : robot.arm().chain.joint_names) text << ',' << name;
  for (std::size_t k = 0; k < result.rows.size(); ++k) {
    text << '\n' << result.s * static_cast<double>(k) / static_cast<double>(std::max<std::size_t>(1, result.rows.size() - 1));
    for (const double q : result.rows[k]) text << ',' << q;
  }
  io::write_file(file, text.str() + "\n");
}

void run(const char* title, const std::filesystem::path& file, const std::filesystem::path& rows) {
  const Problem problem = io::load_problem(file);
  const PreparedRobot robot(problem);
  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
  const double length = path.layer(path.size() - 1).s;
  std::printf("%s, %s\n", title, file.filename().c_str());
  const auto jacobian = baselines::track_jacobian(robot, problem), null_space = baselines::track_null_space(robot, problem);
  print("Jacobian", jacobian, length);
  print("null space", null_space, length);
  if (!rows.empty()) {
    write_rows(rows / (file.stem().string() + "_jacobian.csv"), robot, jacobian);
    write_rows(rows / (file.stem().string() + "_null_space.csv"), robot, null_space);
  }
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  const PlanResult planned = plan(robot, problem, options);
  std::printf("  %-11s %s", "Swivel", to_string(planned.status));
  if (planned.status == PlanStatus::kSolved) {
    std::printf(", cost %.4f, least clearance %.2f mm", planned.cost, 1e3 * planned.min_clearance.value_or(0));
  } else if (planned.diagnosis.reached_s) {
    std::printf(", reached %.1f %% of the path: %s", 100 * *planned.diagnosis.reached_s / length, planned.diagnosis.reason.c_str());
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path problems = std::filesystem::path(SWIVEL_DATA_DIR) / "problems";
  const bool keep = argc == 3 && std::string_view(argv[1]) == "--rows";
  if (argc != 1 && !keep) {
    std::fprintf(stderr, "usage: baseline_runs [--rows FOLDER]\n");
    return 2;
  }
  const std::filesystem::path rows = keep ? argv[2] : "";
  try {
    run("A, joint limits", problems / "experiment_a_start.yaml", rows);
    run("B, collision", problems / "experiment_b.yaml", rows);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
