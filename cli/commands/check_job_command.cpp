// SPDX-License-Identifier: BSD-3-Clause
#include "commands/check_job_command.hpp"

#include <algorithm>
#include <optional>
#include <variant>
#include <vector>

#include "commands/job_rows.hpp"
#include "options/commands.hpp"
#include "output/check_output.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/complete_job.hpp"
#include "swivel/planner/job/time_job.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// Returns what the column `process` of a file says of each row, by part.
std::vector<std::vector<bool>> process_of(const io::JobTrajectory& read) {
  std::vector<std::vector<bool>> process;
  for (const io::JobTrajectoryPart& part : read.parts) {
    std::vector<bool>& rows = process.emplace_back(part.rows.size());
    for (std::size_t row = 0; row < rows.size(); ++row)
      rows[row] = row >= part.first_process && row <= part.last_process;
  }
  return process;
}

/// Returns what all runs of a job show together.
CheckResult summary_of(const JobCheckResult& result) {
  CheckResult all;
  bool measured = true;
  const auto lower = [](std::optional<double>& least, const std::optional<double>& value) {
    if (value && (!least || *value < *least)) least = value;
  };
  for (const CheckResult& run : result.runs) {
    all.worst_position = std::max(all.worst_position, run.worst_position);
    all.worst_angle = std::max(all.worst_angle, run.worst_angle);
    all.worst_path_error = std::max(all.worst_path_error, run.worst_path_error);
    all.worst_path_angle = std::max(all.worst_path_angle, run.worst_path_angle);
    lower(all.min_clearance, run.min_clearance);
    lower(all.min_margin, run.min_margin);
    if (run.deepest_contact &&
        (!all.deepest_contact || run.deepest_contact->depth > all.deepest_contact->depth))
      all.deepest_contact = run.deepest_contact;
    measured &= run.deepest_contact_status != Known::kNotMeasured;
    if (!run.motion) continue;
    if (!all.motion) all.motion.emplace();
    all.motion->tool_speed = std::max(all.motion->tool_speed, run.motion->tool_speed);
    all.motion->turn_speed = std::max(all.motion->turn_speed, run.motion->turn_speed);
  }
  all.deepest_contact_status = known(measured, all.deepest_contact.has_value());
  return all;
}

/// Prints the verdict and what was proved of `rows` rows, whose last is at `duration`, s. `job` has
/// a stroke for each of the `runs` of a stroke with lift-offs.
void print_verdict(const JobCheckResult& result, const Problem& job,
                   const std::vector<HeldJoint>& held, std::size_t runs, std::size_t rows,
                   double duration) {
  const std::size_t strokes = runs - std::min(runs, lift_off_count(job));
  say("%s: %zu stroke%s", result.passed ? "passed" : "failed", strokes, strokes == 1 ? "" : "s");
  if (runs > strokes) say(" in %zu runs", runs);
  say(", %zu rows", rows);
  if (!result.passed)
    say(", %lld failure%s", static_cast<long long>(result.failure_count),
        result.failure_count == 1 ? "" : "s");
  if (!held.empty()) say(", held: %s", words(held).c_str());
  if (result.runs.empty()) {
    say("; no stroke could be measured\n");
  } else {
    const CheckResult all = summary_of(result);
    say("; on strokes tool within %.2g m and %.2g rad of the path at rows, within %.3f mm and "
        "%.3g rad between",
        all.worst_position, all.worst_angle, 1e3 * all.worst_path_error, all.worst_path_angle);
    if (all.min_clearance)
      say(", clearance at least %.3f mm, %.3f mm more than asked", 1e3 * *all.min_clearance,
          1e3 * *all.min_margin);
    print_contact(all);
    say(", cost %.9g\n", result.cost);
    if (all.motion)
      say("motion: %.3f s, tool on strokes at most %.6g mm/s and %.4g rad/s\n", duration,
          1e3 * all.motion->tool_speed, all.motion->turn_speed);
  }
  print_failures(result.failures, result.failure_count);
}

}  // namespace

int check_job_file(const Problem& given, const std::string& trajectory,
                   std::optional<double> speed) {
  const PreparedRobot robot(problem_of_run(given, {0, false}));
  const std::vector<HeldJoint>& held = robot.arm().held;
  warn_of_held(held);
  const io::ExecutedJobRows executed =
      io::load_executed_rows(trajectory, given, robot.arm().chain.joint_names);
  const Problem& job = executed.job;
  const auto& file = executed.rows;
  JobCheckResult result;
  if (const auto* read = std::get_if<io::JobTrajectory>(&file)) {
    if (speed)
      throw InputError(trajectory, "has no times: allowed with --speed are motions of jobs");
    const std::vector<Part> parts = in_the_name_of(trajectory, [&] {
      return complete_parts(robot, job, parts_of(robot, job, *read), read->stated);
    });
    result = check_job(robot, job, parts);
    check_process(job, parts, process_of(*read), result);
    std::size_t runs = 0, rows = 0;
    for (const Part& part : parts) {
      runs += part.run.has_value();
      rows += part.rows.size();
    }
    print_verdict(result, job, held, runs, rows, 0);
    say("%s", kSpeedsNotChecked);
  } else {
    const auto& timed = std::get<io::JobMotionFile>(file);
    const auto order = runs_of_motion(robot, job, timed.strokes, timed.motion);
    const ArmMotion motion = in_the_name_of(trajectory, [&] {
      return complete_job_motion(robot, job, order, timed.motion, timed.stated);
    });
    result = check_job_motion(robot, job, order, motion, {.speed = speed});
    print_verdict(result, job, held, timed.strokes.size(), timed.motion.rows.size(),
                  timed.motion.duration);
  }
  return result.passed ? kOk : kNo;
}

}  // namespace swivel::cli
