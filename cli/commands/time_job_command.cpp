// SPDX-License-Identifier: BSD-3-Clause
#include "commands/time_job_command.hpp"

#include <variant>
#include <vector>

#include "commands/job_rows.hpp"
#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/motion_output.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/motion/job_text.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/complete_job.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/verify/complete_rows.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// Returns the parts of a job in a file, with rows at the layers of each run. `job` has its
/// lift-offs, if it has any. Throws InputError unless they are proved to be the job's.
std::vector<Part> proved_parts(const PreparedRobot& robot, const io::ExecutedJobRows& read,
                               const Budget& budget) {
  const Problem& job = read.job;
  const auto require_check = [&](const Problem& of, const std::vector<Part>& parts) {
    const JobCheckResult check = check_job(robot, of, parts, {.margins = false, .budget = budget});
    if (!check.passed)
      throw InputError(check.failures.front() + ": allowed is a job that passes `swivel check`");
  };
  if (const auto* file = std::get_if<io::JobMotionFile>(&read.rows)) {
    const auto order = runs_of_motion(robot, job, file->strokes, file->motion);
    const ArmMotion motion =
        complete_job_motion(robot, job, order, file->motion, file->stated, budget);
    std::vector<Part> parts = parts_of_motion(robot, job, order, motion, budget);
    // The rows are on the paths as motions follow them.
    require_check(with_motion_defaults(job), parts);
    return parts;
  }
  const auto& file = std::get<io::JobTrajectory>(read.rows);
  std::vector<Part> parts =
      complete_parts(robot, job, parts_of(robot, job, file), file.stated, budget);
  require_check(job, parts);
  for (Part& part : parts)
    if (part.run)
      part.rows = rows_at_layers(robot, problem_of_run(job, *part.run), part.rows, {}, budget);
  return parts;
}

/// Returns the runs among parts of a job.
std::vector<StrokeRun> runs_among(const std::vector<Part>& parts) {
  std::vector<StrokeRun> runs;
  for (const Part& part : parts)
    if (part.run) runs.push_back(*part.run);
  return runs;
}

/// A motion, or why there is none.
struct Timed {
  std::vector<Part> parts;
  MotionTiming timing;
  std::string fault = {};  ///< what the check of the motion found; empty: it is proved
};

Timed timed(const PreparedRobot& robot, const JobTimeRequest& request,
            const io::ExecutedJobRows& read) {
  const Budget budget(std::nullopt, &interrupted);
  const Problem& job = read.job;
  Timed made{proved_parts(robot, read, budget), {}};
  made.timing = time_job(robot, job, made.parts, request.timing, budget);
  if (!made.timing.motion || !request.check) return made;
  // Motions keep more clearance between rows than trajectories do: transitions may lack it.
  const JobCheckResult check =
      check_job_motion(robot, job, runs_among(made.parts), made.timing.motion->arms.front(),
                       {.margins = false, .budget = budget, .speed = request.timing.speed});
  if (!check.passed) made.fault = check.failures.front();
  return made;
}

}  // namespace

int time_job_file(const JobTimeRequest& request, std::optional<io::InputFiles>& noted) {
  const PreparedRobot robot(problem_of_run(request.job, {0, false}));
  if (!request.quiet) warn_of_held(robot.arm().held);
  const io::JointNames& names = robot.arm().chain.joint_names;
  const io::ExecutedJobRows read = io::load_executed_rows(request.trajectory, request.job, names);
  const Problem& job = read.job;
  io::OutputFiles outputs(noted->files());
  noted.reset();
  for (const std::string& file : request.out) outputs.add("--out", file);
  catch_interrupts();
  std::optional<Timed> made;
  try {
    made = in_the_name_of(request.trajectory, [&] { return timed(robot, request, read); });
  } catch (const Stopped&) {
    outputs.remove("--out");
  }
  const bool executable = made && made->timing.motion && made->fault.empty();
  if (!executable)
    outputs.remove("--out");
  else
    outputs.write_each("--out", [&](const std::filesystem::path& file) {
      return io::job_motion_text(made->timing.motion->arms.front(), job, names, job.arm().base_link,
                                 file);
    });
  deliver(outputs, made ? "there is no motion now" : "the work was stopped", [&] {
    if (!made) return say("stopped\n");
    if (!made->fault.empty()) return say("not executable: %s\n", made->fault.c_str());
    if (executable && (request.quiet || outputs.takes_standard_output())) return;
    say_text(job_motion_text(made->timing, made->parts, job));
    if (executable) warn_of(*made->timing.motion);
  });
  return !made ? kStopped : executable ? kOk : kNo;
}

}  // namespace swivel::cli
