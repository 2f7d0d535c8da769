// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <optional>
#include <stdexcept>

#include "options/chosen_problem.hpp"
#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/answer_output.hpp"
#include "output/motion_output.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/job/time_job.hpp"
#include "swivel/planner/problem/time_answer.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

struct TimeArguments {
  std::string problem, trajectory;
  std::vector<std::string> out;
  MotionOptions motion;
  LatticeOptions lattice;
  EpisodeChoice episode;
  bool quiet = false, refine = false, no_check = false;
};

/// Returns how the command line asks for a motion of the problem. Throws InputError where there is
/// no speed.
MotionRequest request_of(const TimeArguments& arguments, const Problem& problem) {
  const bool strokes = problem.arms.size() == 1 && !is_path(problem);
  if (!strokes)
    return {.refine = arguments.refine,
            .timing = arguments.motion.timing(limits_of_speeds(problem))};
  const TimingOptions timing = arguments.motion.timing_of_strokes();
  require_speeds(problem, timing);
  return {.refine = arguments.refine, .timing = timing};
}

int run(const TimeArguments& arguments) {
  require_motion_formats(arguments.out);
  std::optional<io::InputFiles> noted(std::in_place);
  const Problem problem =
      chosen_problem(io::load_problem(arguments.problem), arguments.lattice, arguments.episode);
  const MotionRequest asked = request_of(arguments, problem);
  const PreparedProblem prepared(problem.arms.size() == 2 ? with_motion_defaults(problem)
                                                          : problem);
  if (!arguments.quiet)
    for (std::size_t k = 0; k < prepared.arms(); ++k) warn_of_held(prepared.robot(k).arm().held);
  GivenAnswer given = io::load_answer(arguments.trajectory, problem, prepared.joint_names());
  const Problem executed = given.problem;
  io::OutputFiles outputs(noted->files());
  noted.reset();
  for (const std::string& out : arguments.out) outputs.add("--out", out);
  catch_interrupts();
  std::optional<TimedAnswer> timed;
  try {
    timed = in_the_name_of(arguments.trajectory, [&] {
      return time_answer(prepared, std::move(given), asked, !arguments.no_check,
                         Budget(std::nullopt, &interrupted));
    });
  } catch (const Stopped&) {
  } catch (const std::logic_error&) {
    outputs.remove("--out");
    deliver(outputs, "there is no answer now", [] {});
    throw;
  }
  const bool executable = timed && timed->answer.timed() != nullptr && timed->fault.empty();
  if (!executable)
    outputs.remove("--out");
  else
    outputs.write_each("--out", [&](const std::filesystem::path& out) {
      return io::motion_text(timed->answer, executed, out);
    });
  deliver(outputs, timed ? "there is no motion now" : "the work was stopped", [&] {
    if (!timed) return say("stopped\n");
    if (!timed->fault.empty()) return say("not executable: %s\n", timed->fault.c_str());
    const bool quiet = arguments.quiet || outputs.takes_standard_output();
    if (!quiet || !executable) print_timed(timed->answer, executed, quiet);
  });
  return !timed ? kStopped : executable ? kOk : kNo;
}

}  // namespace

void add_time(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("time", "Make a trajectory a motion in time that a controller can run");
  // shared, so that it lives as long as the callback that reads it
  auto arguments = std::make_shared<TimeArguments>();
  command->add_option("problem", arguments->problem, "problem file, job or workcell")->required();
  command->add_option("trajectory", arguments->trajectory, io::kTrajectoryFile)->required();
  arguments->motion.add_to(*command);
  command->add_flag(
      "--refine", arguments->refine,
      "move the rows off the lattice's nodes first: cheaper and smoother, never dearer");
  add_out_option(*command, arguments->out,
                 "motion file: .csv, .json or .yaml (JointTrajectory), .mcap (JointState)");
  arguments->lattice.add_to(*command);
  arguments->episode.add_to(*command);
  command->add_flag("--no-check", arguments->no_check,
                    "leave out the proof of the motion, which `check` would give as well");
  command->add_flag("--quiet", arguments->quiet, "print nothing but errors");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace swivel::cli
