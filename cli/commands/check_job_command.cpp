// SPDX-License-Identifier: BSD-3-Clause
#include "commands/check_job_command.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "options/commands.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/motions/job_trajectory.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// Returns the index of the stroke of a part. Throws InputError if the job has no such stroke.
std::size_t stroke_of(const Job& job, const io::JobTrajectoryPart& part, const std::string& file) {
  const auto found = std::find_if(job.strokes.begin(), job.strokes.end(),
                                  [&](const Stroke& one) { return one.name == part.stroke; });
  if (found == job.strokes.end())
    throw InputError(file, "row " + std::to_string(part.first_row) + ": stroke '" + part.stroke +
                               "': allowed are names of the job's strokes");
  return static_cast<std::size_t>(found - job.strokes.begin());
}

/// Says what is wrong with the column `process` of a run; "" if it is 1 just where the tool is on
/// the stroke itself.
std::string fault_of_process(const Job& job, const io::JobTrajectoryPart& part,
                             const StrokeRun& run) {
  const Problem problem = problem_of_run(job, run);
  const ProcessWaypoints process = process_waypoints(job.strokes[run.stroke]);
  double s = 0, first = 0, last = 0;
  for (std::size_t k = 1; k < problem.waypoints.size(); ++k) {
    s += (problem.waypoints[k].position - problem.waypoints[k - 1].position).norm();
    if (k == process.first) first = s;
    if (k == process.last) last = s;
  }
  constexpr double kSame = 1e-6;  // m; waypoints on a straight line are merged
  for (std::size_t k = 0; k < part.rows.size(); ++k) {
    const double at = part.rows[k].s;
    const bool on = k >= part.first_process && k <= part.last_process;
    const bool inside = at > first + kSame && at < last - kSame;
    const bool outside = at < first - kSame || at > last + kSame;
    if ((inside && !on) || (outside && on))
      return formatted(
          "row %zu: process is %d at s = %.6g m: allowed is %d, the stroke is from "
          "%.6g to %.6g m",
          part.first_row + k, on ? 1 : 0, at, on ? 0 : 1, first, last);
  }
  return "";
}

}  // namespace

int check_job_file(const Job& job, const std::string& trajectory) {
  const PreparedRobot robot(problem_of_run(job, {0, false}));
  const Chain& chain = robot.arm().chain;
  warn_of_held(robot.arm().held);
  const io::JobTrajectory file = io::load_job_trajectory(trajectory, chain.joint_names);
  std::vector<JobPart> parts;
  std::vector<std::string> faults;  // of the column `process`
  std::size_t rows = 0;
  for (const io::JobTrajectoryPart& read : file.parts) {
    JobPart& part = parts.emplace_back();
    part.rows = read.rows;
    rows += read.rows.size();
    if (read.stroke.empty()) continue;
    const std::size_t stroke = stroke_of(job, read, trajectory);
    part.run = {stroke, begins_at_last_waypoint(robot, job, stroke, read.rows)};
    if (const std::string fault = fault_of_process(job, read, *part.run); !fault.empty())
      faults.push_back("stroke '" + read.stroke + "': " + fault);
  }
  JobCheckResult result = check_job(robot, job, parts);
  result.failures.insert(result.failures.end(), faults.begin(), faults.end());
  result.failure_count += static_cast<std::int64_t>(faults.size());
  result.passed = result.failure_count == 0;
  say("%s: %zu rows in %zu strokes and %zu transitions", result.passed ? "passed" : "failed", rows,
      static_cast<std::size_t>(std::count_if(parts.begin(), parts.end(),
                                             [](const JobPart& part) { return !!part.run; })),
      static_cast<std::size_t>(std::count_if(parts.begin(), parts.end(),
                                             [](const JobPart& part) { return !part.run; })));
  if (!result.passed)
    say(", %lld failure%s", static_cast<long long>(result.failure_count),
        result.failure_count == 1 ? "" : "s");
  if (!robot.arm().held.empty()) say(", held: %s", words(robot.arm().held).c_str());
  say("; cost %.9g\n", result.cost);
  for (const std::string& failure : result.failures) say("  %s\n", failure.c_str());
  const auto listed = static_cast<std::int64_t>(result.failures.size());
  if (result.failure_count > listed)
    say("  and %lld more\n", static_cast<long long>(result.failure_count - listed));
  return result.passed ? kOk : kNo;
}

}  // namespace swivel::cli
