// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <optional>
#include <stdexcept>

#include "commands/time_job_command.hpp"
#include "commands/workcell_command.hpp"
#include "options/chosen_problem.hpp"
#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/motion_output.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"
#include "swivel/planner/verify/complete_rows.hpp"
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

/// Returns a path's rows after refinement, which moves them off the nodes of the lattice, on the
/// path that the motion follows.
std::vector<TrajectoryRow> refined(const PreparedRobot& robot, const PathProblem& problem,
                                   const std::vector<TrajectoryRow>& rows, bool quiet) {
  const PathProblem smoothed = with_motion_defaults(problem);
  const Refined result = refine(robot, smoothed, rows_on_path(robot, smoothed, rows), {},
                                Budget(std::nullopt, &interrupted));
  if (!quiet) print_refined(result);
  return result.rows;
}

int run_on_job(const TimeArguments& arguments, const Problem& job,
               std::optional<io::InputFiles>& noted) {
  refuse_options(job, job.source,
                 {{arguments.refine, "--refine"}, {arguments.motion.chord.has_value(), "--chord"}});
  JobTimeRequest request{.job = job,
                         .timing = arguments.motion.job_timing(),
                         .trajectory = arguments.trajectory,
                         .out = arguments.out,
                         .quiet = arguments.quiet,
                         .check = !arguments.no_check};
  require_speeds(request.job, request.timing);
  return time_job_file(request, noted);
}

int run_on_workcell(const TimeArguments& arguments, const Problem& cell,
                    std::optional<io::InputFiles>& noted) {
  const WorkcellTimeRequest request{.timing = arguments.motion.timing(limits_of_speeds(cell)),
                                    .cell = cell,
                                    .trajectory = arguments.trajectory,
                                    .out = arguments.out,
                                    .refine = arguments.refine,
                                    .quiet = arguments.quiet,
                                    .check = !arguments.no_check};
  return time_workcell_file(request, noted);
}

int run(const TimeArguments& arguments) {
  require_motion_formats(arguments.out);
  std::optional<io::InputFiles> noted(std::in_place);
  const Problem chosen =
      chosen_problem(io::load_problem(arguments.problem), arguments.lattice, arguments.episode);
  if (chosen.arms.size() == 2) return run_on_workcell(arguments, chosen, noted);
  if (!is_path(chosen)) return run_on_job(arguments, chosen, noted);
  const PathProblem problem = problem_of_run(chosen, {0, false});
  const TimingOptions options = arguments.motion.timing(problem.limits);
  const PreparedRobot robot(problem);
  if (!arguments.quiet) warn_of_held(robot.arm().held);
  const io::JointNames& names = robot.arm().chain.joint_names;
  const io::TrajectoryFile file = io::load_trajectory_file(arguments.trajectory, names);
  io::OutputFiles outputs(noted->files());
  noted.reset();
  for (const std::string& out : arguments.out) outputs.add("--out", out);
  catch_interrupts();
  std::optional<MotionResult> timed;
  try {
    timed = in_the_name_of(arguments.trajectory, [&] {
      const Budget budget(std::nullopt, &interrupted);
      // The rows of a motion are at points of the path with rounded corners.
      const PathProblem of_rows = file.timed.empty() ? problem : with_motion_defaults(problem);
      std::vector<TrajectoryRow> rows =
          rows_at_layers(robot, of_rows, file.rows, file.stated, budget);
      if (arguments.refine)
        rows = refined(robot, problem, rows, arguments.quiet || outputs.takes_standard_output());
      MotionResult result = time_trajectory(robot, problem, rows, options, budget);
      if (result.motion && !arguments.no_check)
        require_passed(check_motion(robot, problem, result.motion->rows,
                                    {.margins = false, .budget = budget}));
      return result;
    });
  } catch (const Stopped&) {
    outputs.remove("--out");
  } catch (const std::logic_error&) {
    outputs.remove("--out");
    outputs.stage();
    report_removed(outputs.commit(), "there is no answer now");
    throw;
  }
  if (timed && timed->motion) {
    outputs.write_each("--out", [&](const std::filesystem::path& out) {
      return io::motion_text(*timed->motion, names, problem.base_link, out);
    });
  } else {
    outputs.remove("--out");
  }
  outputs.stage();
  if (!timed)
    say("stopped\n");
  else if (timed->failure)
    say("not executable: s = %.4f m: %s\n", timed->failure->s, timed->failure->reason.c_str());
  else if (!arguments.quiet && !outputs.takes_standard_output())
    print_motion(*timed->motion, names);
  flush_standard_output();
  report_removed(outputs.commit(), !timed ? "the work was stopped" : "there is no motion now");
  return !timed ? kStopped : timed->motion ? kOk : kNo;
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
