// SPDX-License-Identifier: BSD-3-Clause
// From a lattice's path to a motion, on random poses: what refining and timing bring, and what they
// take.
//   motion_benchmark PROBLEM.yaml [EPISODES]
// EPISODES, of seed 1, defaults to 100. A problem without `vary` is planned once.
// One line for each pose, medians and 95th percentiles below.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace {

using namespace swivel;

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

/// What all episodes measured, by name, and how many of them were solved, kinked and failed.
struct Tally {
  std::map<std::string, std::vector<double>> all;
  int solved = 0, kinked = 0, failed = 0;
};

/// Refines a lattice's path with one seed and with two, prints both and returns the second's.
Refined measure_refinement(const PreparedRobot& robot, const PathProblem& problem,
                           const MotionPlan& whole, std::uint64_t episode, Tally& tally) {
  const std::vector<TrajectoryRow>& path = whole.lattice_path;
  auto start = std::chrono::steady_clock::now();
  const Refined one = refine(robot, problem, path, {.second_seed = false});
  const double refine_ms = ms_since(start);
  start = std::chrono::steady_clock::now();
  Refined both = refine(robot, problem, path);
  tally.all["refine ms"].push_back(refine_ms);
  tally.all["refine ms, two seeds"].push_back(ms_since(start));
  tally.all["rounds"].push_back(one.rounds);
  tally.all["nodes"].push_back(static_cast<double>(one.nodes_asked));
  tally.all["cost over lattice"].push_back(one.cost / one.cost_before);
  tally.all["cost over lattice, two seeds"].push_back(both.cost / both.cost_before);
  if (both.bend_before > 400)
    ++tally.kinked, tally.all["smoother, kinked"].push_back(both.bend_before / both.bend);
  const CheckResult check = check_trajectory(robot, problem, both.rows);
  std::printf("%3d: cost %.4f %.4f %.4f, bend %.0f %.0f, %d rounds, %.1f ms%s%s",
              static_cast<int>(episode), one.cost_before, one.cost, both.cost, both.bend_before,
              both.bend, one.rounds, refine_ms, one.refined ? "" : ", NOT REFINED",
              check.passed ? "" : ", CHECK FAILS");
  for (const std::string& warning : whole.result.warnings)
    if (warning.find("branch") != std::string::npos) std::printf(", %s", warning.c_str());
  if (!check.passed) ++tally.failed, std::printf(": %s", check.failures[0].c_str());
  return both;
}

/// Times rows at a tool speed, m/s, checks the motion and prints what came out.
void measure_timing(const PreparedRobot& robot, const PathProblem& problem,
                    const std::vector<TrajectoryRow>& rows, double speed, Tally& tally) {
  const MotionResult timed =
      time_trajectory(robot, problem, rows, {.speed = speed, .turn_speed = {}, .rate = 250});
  const std::string at = " at " + std::to_string(static_cast<int>(1e3 * speed)) + " mm/s";
  tally.all["timing ms" + at].push_back(timed.time_ms);
  tally.all["proof ms" + at].push_back(timed.check_ms);
  if (timed.failure) {
    ++tally.failed;
    std::printf("; %s at %.4f", timed.failure->reason.c_str(), timed.failure->s);
    return;
  }
  const TimedPath& motion = *timed.motion;
  double worst = 0;
  for (const auto& peaks : motion.peaks)
    for (const auto& peak : peaks) worst = std::max(worst, peak.ratio);
  const auto start = std::chrono::steady_clock::now();
  const CheckResult proved = check_motion(robot, problem, motion.rows);
  tally.all["check ms" + at].push_back(ms_since(start));
  if (!proved.passed)
    ++tally.failed, std::printf("; CHECK OF MOTION FAILS: %s", proved.failures[0].c_str());
  tally.all["time over ideal" + at].push_back(motion.duration / motion.ideal);
  tally.all["worst ratio" + at].push_back(worst);
  tally.all["between, um" + at].push_back(1e6 * motion.between_position);
  tally.all["rounds of timing" + at].push_back(motion.rounds);
  std::printf("; %.3f of ideal, %d rounds", motion.duration / motion.ideal, motion.rounds);
}

int run(const std::string& file, std::uint64_t episodes) {
  PathProblem base = io::load_path_problem(file);
  base = with_motion_defaults(base);
  base.limits.joint_acceleration.emplace().fill(10);
  base.limits.joint_jerk.emplace().fill(100);
  const PreparedRobot robot(base);
  Tally tally;
  if (base.vary.empty()) episodes = 1;
  for (std::uint64_t episode = 0; episode < episodes; ++episode) {
    const PathProblem problem = base.vary.empty() ? base : episode_problem(base, 1, episode);
    PlanOptions options;
    options.check = false;  // the time of planning is measured
    options.planner = PlannerKind::kLazy;
    Planner planner(std::shared_ptr<const PreparedRobot>(std::shared_ptr<void>(), &robot), problem);
    const auto start = std::chrono::steady_clock::now();
    const MotionPlan whole = plan_motion(
        planner, options, true, TimingOptions{.speed = 0.05, .turn_speed = {}, .rate = 250});
    if (whole.result.status != PlanStatus::kSolved) continue;
    ++tally.solved;
    tally.all["plan, refine and time ms"].push_back(ms_since(start));
    tally.all["plan ms"].push_back(whole.result.time_ms.at("plan"));
    const Refined refined = measure_refinement(robot, problem, whole, episode, tally);
    for (const double speed : {0.05, 0.25})
      measure_timing(robot, problem, refined.rows, speed, tally);
    std::printf("\n");
  }
  std::printf("%d solved, %d kinked, %d failures\n%-34s %10s %10s %10s\n", tally.solved,
              tally.kinked, tally.failed, "", "median", "95 %", "most");
  for (const auto& [name, values] : tally.all)
    std::printf("%-34s %10.4g %10.4g %10.4g\n", name.c_str(), percentile(values, 0.5),
                percentile(values, 0.95), percentile(values, 1));
  return tally.failed == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  std::string problem;
  std::uint64_t episodes = 100;
  CLI::App app(
      "From a lattice's path to a motion, on random poses: what refining and timing bring, and "
      "what they take.",
      "motion_benchmark");
  app.add_option("problem", problem, "problem file; without `vary` it is planned once")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("episodes", episodes, "poses of seed 1")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  if (const auto code = bench::read_arguments(app, argc, argv)) return *code;
  try {
    return run(problem, episodes);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
