// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "options/chosen_problem.hpp"
#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/check_output.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/problem/given_answer.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

struct CheckArguments {
  std::string problem, trajectory, certificate;
  std::optional<double> speed;  // m/s
  LatticeOptions lattice;
  EpisodeChoice episode;
};

/// Verifies that one run has no path, and prints the verdict behind `prefix`. Prints nothing where
/// it throws.
int verdict_on_run(const PathProblem& problem, const InfeasibilityCertificate& certificate,
                   const std::string& prefix) {
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

/// Verifies that two arms have no plan, and prints the verdict. Prints nothing where it throws.
int verdict_on_two_arms(const Problem& problem, const WorkcellCertificate& certificate) {
  catch_interrupts();
  WorkcellCertificateCheck result;
  try {
    const Budget budget(std::nullopt, &interrupted);
    const PreparedWorkcell prepared(problem, budget);
    for (std::size_t k = 0; k < 2; ++k) warn_of_held(prepared.robot(k).arm().held);
    result = verify_certificate(prepared, certificate, budget);
  } catch (const Stopped&) {
    say("stopped\n");
    return kStopped;
  }
  if (!result.passed) {
    say("failed: this certificate proves nothing\n  %s\n", result.failure.c_str());
    return kNo;
  }
  say("passed: no two paths without conflict at this resolution%s: %lld region%s of conflict, %lld "
      "cut%s; %lld pairs of nodes or motions of both arms, %lld nodes and %lld edges asked\n",
      result.complete ? "" : ", among the solutions that were found",
      static_cast<long long>(result.regions), result.regions == 1 ? "" : "s",
      static_cast<long long>(result.cuts), result.cuts == 1 ? "" : "s",
      static_cast<long long>(result.pairs), static_cast<long long>(result.nodes),
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

/// Returns the stroke of the problem that a certificate is about, which is not reversible. Throws
/// InputError in the name of its file.
std::size_t stroke_of(const InfeasibilityCertificate& certificate, const Problem& problem,
                      const std::string& file) {
  const auto refuse = [&](const std::string& what) { throw InputError(file, what); };
  const std::string& name = certificate.stroke;
  if (is_path(problem)) {
    if (!name.empty())
      refuse("stroke: is of stroke '" + name +
             "' of a job: allowed is a problem file with strokes");
    return 0;
  }
  const auto stroke = find_stroke(problem, name);
  if (!stroke)
    refuse("stroke: '" + name + "' is none of the job: allowed are the names of its strokes");
  if (problem.arm().strokes[*stroke].reversible)
    refuse("stroke: '" + name +
           "' is reversible, and a certificate is of one direction: allowed are strokes that are "
           "not reversible");
  if (certificate.reversed)
    refuse("reversed: stroke '" + name +
           "' is not `reversible`: allowed is a certificate of it forwards");
  return *stroke;
}

/// Verifies the certificate in a file and prints the verdict. Returns the exit code. Throws
/// InputError.
int check_certificate(const Problem& problem, const std::string& file) {
  if (problem.arms.size() == 2)
    return verdict_on_two_arms(problem, io::load_workcell_certificate(file));
  const InfeasibilityCertificate certificate = io::load_certificate(file);
  const std::size_t stroke = stroke_of(certificate, problem, file);
  return verdict_on_run(problem_of_run(problem, {stroke, false}), certificate,
                        is_path(problem) ? "" : "stroke '" + certificate.stroke + "': ");
}

/// Checks the trajectory or the motion in a file and prints the verdict. Returns the exit code.
/// Throws InputError.
int check_rows(const Problem& problem, const CheckArguments& arguments) {
  const std::string& file = arguments.trajectory;
  std::optional<PreparedProblem> prepared(problem);
  for (std::size_t k = 0; k < prepared->arms(); ++k) warn_of_held(prepared->robot(k).arm().held);
  GivenAnswer given = io::load_answer(file, problem, prepared->joint_names());
  if (arguments.speed && !given.has_times())
    throw InputError(file, "has no times: allowed with --speed are motions of jobs");
  if (given.has_times() && prepared->has_two_arms())
    prepared.emplace(with_motion_defaults(problem));
  given = in_the_name_of(file, [&] { return complete_answer(*prepared, std::move(given)); });
  const AnswerCheck check = check_answer(*prepared, given, {.speed = arguments.speed});
  print_check(check, given, *prepared);
  return check.passed ? kOk : kNo;
}

int run(const CheckArguments& arguments) {
  const Problem file = io::load_problem(arguments.problem);
  require_speed_of_job(arguments, file.arms.size() == 1 && !is_path(file));
  require_one_file(arguments);
  const Problem problem = chosen_problem(file, arguments.lattice, arguments.episode);
  return arguments.certificate.empty() ? check_rows(problem, arguments)
                                       : check_certificate(problem, arguments.certificate);
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
