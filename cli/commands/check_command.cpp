// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands/check_job_command.hpp"
#include "commands/workcell_command.hpp"
#include "options/chosen_problem.hpp"
#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/check_output.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/motions/motion.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"
#include "swivel/planner/verify/complete_rows.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

struct CheckArguments {
  std::string problem, trajectory, certificate;
  std::optional<double> speed;  // m/s
  LatticeOptions lattice;
  EpisodeChoice episode;
};

/// Prints what was proved, and how near it is to failing.
void print_margins(const PathProblem& problem, const Chain& chain, const CheckResult& result) {
  say("tool within %.2g m and %.2g rad of the path at rows", result.worst_position,
      result.worst_angle);
  // Where no row and the next could both be measured, nothing is known of what lies between.
  if (result.largest_step > 0 || result.worst_path_error > 0 || result.worst_path_angle > 0) {
    say(", within %.3f mm", 1e3 * result.worst_path_error);
    if (problem.limits.tool_path_error)
      say(" (allowed %.3f)", 1e3 * *problem.limits.tool_path_error);
    say(" and %.3g rad", result.worst_path_angle);
    if (problem.limits.tool_angle_error) say(" (allowed %.3g)", *problem.limits.tool_angle_error);
    say(" between, joint moves within %s of what is allowed", percent(result.largest_step).c_str());
  }
  if (result.nearest_limit)
    say(", '%s' %.2f deg from its limit at row %zu",
        chain.joint_names[result.nearest_limit->joint].c_str(),
        result.nearest_limit->by * 180 / kPi, result.nearest_limit->row);
  if (result.nearest_slide_limit)
    say(", '%s' %.2f mm from its limit at row %zu",
        chain.joint_names[result.nearest_slide_limit->joint].c_str(),
        1e3 * result.nearest_slide_limit->by, result.nearest_slide_limit->row);
  if (result.min_clearance)
    say(", clearance at least %.3f mm, %.3f mm more than asked", 1e3 * *result.min_clearance,
        1e3 * *result.min_margin);
  print_contact(result);
  say(", cost %.9g\n", result.cost);
  if (!result.motion) return;
  const char* const names[] = {"speed", "acceleration", "jerk"};
  say("motion: %.3f s, tool at most %.6g mm/s and %.4g rad/s", result.motion->duration,
      1e3 * result.motion->tool_speed, result.motion->turn_speed);
  for (std::size_t k = 0; k < 3; ++k)
    say(", %s at most %.2f %% of what '%s' can do", names[k], 100 * result.motion->peaks[k].ratio,
        chain.joint_names[static_cast<std::size_t>(result.motion->peaks[k].joint)].c_str());
  say("\n");
}

/// Returns true if joint j of the chain may be at `value`, rad.
bool within_limit(const Chain& chain, std::size_t j, double value) {
  const JointLimit& limit = chain.limit[j];
  return limit.continuous || (value >= limit.lower && value <= limit.upper);
}

/// Returns true if the joints of all rows are within their limits when read as degrees, while one
/// of them, read as radians, the unit of every file of joints, is outside and beyond a whole turn.
/// Joints in radians that are outside by little are within their limits as degrees, too.
bool look_like_degrees(const Chain& chain, const std::vector<TrajectoryRow>& rows) {
  bool beyond_a_turn = false;
  for (const TrajectoryRow& row : rows)
    for (std::size_t j = 0; j < kDof; ++j) {
      const double value = row.q[static_cast<Eigen::Index>(j)];
      if (!within_limit(chain, j, value / kDegrees)) return false;
      beyond_a_turn |= !within_limit(chain, j, value) && std::abs(value) > 2 * kPi;
    }
  return beyond_a_turn;
}

/// Verifies a certificate and prints the verdict behind `prefix`. Prints nothing where it
/// throws.
int run_on_certificate(const PathProblem& problem, const InfeasibilityCertificate& certificate,
                       const std::string& prefix = {}) {
  catch_interrupts();
  CertificateCheck result;
  std::vector<HeldJoint> held;
  try {
    const Budget budget(std::nullopt, &interrupted);
    const PreparedRobot robot(problem, budget);
    held = robot.arm().held;
    result = verify_certificate(robot, problem, certificate, budget);
  } catch (const Stopped&) {
    say("%sstopped\n", prefix.c_str());
    return kStopped;
  }
  warn_of_held(held);
  if (!result.passed) {
    say("%sfailed: this certificate proves nothing\n  %s\n", prefix.c_str(),
        result.failure.c_str());
    return kNo;
  }
  say("%spassed: no path at this resolution%s%s: nothing leads from s = %.4f to %.4f m: %s; %lld "
      "nodes and %lld edges asked\n",
      prefix.c_str(), with_held(held).c_str(),
      result.complete ? "" : ", among the solutions that were found", result.s[0], result.s[1],
      removed_text(certificate).c_str(), static_cast<long long>(result.nodes),
      static_cast<long long>(result.edges));
  return kOk;
}

/// Throws InputError unless there is either a trajectory or a certificate.
void require_one_file(const CheckArguments& arguments) {
  if (arguments.trajectory.empty() == arguments.certificate.empty())
    throw InputError(
        arguments.certificate.empty()
            ? "trajectory: is missing: allowed is a file, or --certificate FILE"
            : "--certificate: there is a trajectory as well: allowed is one of the two");
}

int run_on_job(const CheckArguments& arguments, const Problem& job) {
  if (arguments.certificate.empty())
    return check_job_file(job, arguments.trajectory, arguments.speed);
  const InfeasibilityCertificate certificate = io::load_certificate(arguments.certificate);
  const auto stroke = find_stroke(job, certificate.stroke);
  if (!stroke)
    throw InputError(arguments.certificate, "stroke: '" + certificate.stroke +
                                                "' is none of the job: allowed are the names of "
                                                "its strokes");
  if (job.arm().strokes[*stroke].reversible)
    throw InputError(arguments.certificate,
                     "stroke: '" + certificate.stroke +
                         "' is reversible, and a certificate is of one direction: allowed are "
                         "strokes that are not reversible");
  if (certificate.reversed && !job.arm().strokes[*stroke].reversible)
    throw InputError(arguments.certificate, "reversed: stroke '" + certificate.stroke +
                                                "' is not `reversible`: allowed is a certificate "
                                                "of it forwards");
  const PathProblem problem = problem_of_run(job, {*stroke, certificate.reversed});
  return run_on_certificate(
      problem, certificate,
      "stroke '" + certificate.stroke + (certificate.reversed ? "' backwards: " : "': "));
}

int run_on_workcell(const CheckArguments& arguments, const Problem& cell) {
  if (!arguments.certificate.empty()) return check_workcell_proof(cell, arguments.certificate);
  return check_workcell_file(cell, arguments.trajectory);
}

/// Throws InputError for a --speed that is no speed, or is not of the motion of a job.
void require_speed_of_job(const CheckArguments& arguments, bool is_job) {
  if (!arguments.speed) return;
  positive(*arguments.speed, "--speed");
  if (!arguments.certificate.empty())
    throw InputError("--speed: is of motions: allowed without --certificate");
  if (!is_job)
    throw InputError(
        "--speed: is of a motion of a job, in place of the speeds in its file: "
        "allowed are jobs; elsewhere `limits.tool_speed` bounds the speed");
}

int run(const CheckArguments& arguments) {
  const Problem file = io::load_problem(arguments.problem);
  require_speed_of_job(arguments, file.arms.size() == 1 && !is_path(file));
  require_one_file(arguments);
  const Problem chosen = chosen_problem(file, arguments.lattice, arguments.episode);
  if (chosen.arms.size() == 2) return run_on_workcell(arguments, chosen);
  if (!is_path(chosen)) return run_on_job(arguments, chosen);
  const PathProblem problem = problem_of_run(chosen, {0, false});
  if (!arguments.certificate.empty()) {
    const InfeasibilityCertificate certificate = io::load_certificate(arguments.certificate);
    if (!certificate.stroke.empty())
      throw InputError(arguments.certificate, "stroke: is of stroke '" + certificate.stroke +
                                                  "' of a job: allowed is a problem file with "
                                                  "strokes");
    return run_on_certificate(problem, certificate);
  }
  const PreparedRobot robot(problem);
  const Chain& chain = robot.arm().chain;
  const std::vector<HeldJoint>& held = robot.arm().held;
  warn_of_held(held);
  const io::TrajectoryFile read = io::load_trajectory_file(arguments.trajectory, chain.joint_names);
  const auto& rows = read.rows;
  const auto complete = [&](const auto& work) {
    return in_the_name_of(arguments.trajectory, work);
  };
  const CheckResult result =
      read.timed.empty()
          ? check_trajectory(robot, problem, complete([&] {
                               return complete_rows(robot, problem, rows, read.stated);
                             }))
          : check_motion(robot, problem, complete([&] {
                           return complete_motion(robot, problem, read.timed, read.stated);
                         }));
  say("%s: %zu rows", result.passed ? "passed" : "failed", rows.size());
  if (!result.passed)
    say(", %lld failure%s", static_cast<long long>(result.failure_count),
        result.failure_count == 1 ? "" : "s");
  if (result.rounded) say(", on the path as motions follow it, its corners rounded");
  if (!held.empty()) say(", held: %s", words(held).c_str());
  say("; ");
  const bool all = result.rows_examined == static_cast<std::int64_t>(rows.size());
  if (result.rows_examined == 0 && result.worst_position == 0) {
    say("no row could be measured\n");
  } else {
    if (!all) say("of the rows that could be measured: ");
    print_margins(problem, chain, result);
  }
  const bool asks_speed = problem.limits.tool_speed || problem.limits.tool_turn_speed;
  if (read.timed.empty() && asks_speed) say("%s", kSpeedsNotChecked);
  if (look_like_degrees(chain, rows))
    say("  joints would be within their limits as degrees: allowed are radians\n");
  print_failures(result.failures, result.failure_count);
  return result.passed ? kOk : kNo;
}

}  // namespace

void add_check(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "check", "Verify a trajectory, or that there is none, independently of the planners");
  // shared, so that it lives as long as the callback that reads it
  auto arguments = std::make_shared<CheckArguments>();
  command->add_option("problem", arguments->problem, "problem file, job or workcell")->required();
  command->add_option("trajectory", arguments->trajectory, io::kTrajectoryFile);
  command->add_option(
      "--certificate", arguments->certificate,
      "instead of a trajectory: what `plan --certificate` wrote, that there is no path");
  command->add_option("--speed", arguments->speed,
                      "of motions of jobs: speed of the tool along strokes, m/s, instead of those "
                      "of the file, as `plan --speed`");
  arguments->lattice.add_to(*command);
  arguments->episode.add_to(*command);
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace swivel::cli
