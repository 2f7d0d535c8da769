// SPDX-License-Identifier: BSD-3-Clause
// Experiments A and B of the paper: what the two local methods and the planner do from the same start.
#include <cstdio>
#include <exception>
#include <filesystem>

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

void run(const char* title, const std::filesystem::path& file) {
  const Problem problem = io::load_problem(file);
  const PreparedRobot robot(problem);
  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
  const double length = path.layer(path.size() - 1).s;
  std::printf("%s, %s\n", title, file.filename().c_str());
  print("Jacobian", baselines::track_jacobian(robot, problem), length);
  print("null space", baselines::track_null_space(robot, problem), length);
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
  const std::filesystem::path problems = std::filesystem::path(argc > 1 ? argv[1] : SWIVEL_DATA_DIR) / "problems";
  try {
    run("A, joint limits", problems / "experiment_a_start.yaml");
    run("B, collision", problems / "experiment_b.yaml");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
