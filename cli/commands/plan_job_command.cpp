// SPDX-License-Identifier: BSD-3-Clause
#include "commands/plan_job_command.hpp"

#include <unistd.h>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/job_output.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "terminal/progress.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// Returns how long each stage of a job's plan took, in words.
std::string stages_text(const JobResult& result) {
  std::string text;
  for (const char* const stage :
       {"load", "lattice", "find", "order", "report", "check", "time", "check motion"})
    if (const auto found = result.time_ms.find(stage); found != result.time_ms.end())
      text += formatted("%s%s %.1f ms", text.empty() ? "" : ", ", stage, found->second);
  return text;
}

/// Prints the answer, times and work counts of a job; warnings go to standard error.
void print_job(const JobMotionPlan& plan, const Job& job) {
  const JobResult& result = plan.result;
  say_text(job_text(result, job));
  if (plan.timing) say_text(job_motion_text(*plan.timing, result.parts, job));
  const Counters& c = result.counters;
  say("%s, %d thread%s: %s; %lld nodes and %lld edges checked, %lld FCL calls\n",
      result.planner.c_str(), result.threads, result.threads == 1 ? "" : "s",
      stages_text(result).c_str(), static_cast<long long>(c.nodes_checked),
      static_cast<long long>(c.edges_checked), static_cast<long long>(c.fcl_calls));
  for (const std::string& warning : result.warnings)
    complain("swivel: warning: %s\n", warning.c_str());
  if (!plan.timing || !plan.timing->motion) return;
  for (const std::string& warning : plan.timing->motion->warnings)
    complain("swivel: warning: %s\n", warning.c_str());
}

JobMotionPlan planned(const JobRequest& request) {
  if (!request.timing) return {.result = plan_job(request.job, request.options), .timing = {}};
  const PreparedRobot robot(problem_of_run(with_motion_defaults(request.job), {0, false}));
  return plan_job_motion(robot, request.job, request.options, *request.timing);
}

/// Gives --out its text: the motion where one is asked for, else the trajectory. Marks an earlier
/// file for removal if there is none.
void write_rows(const JobRequest& request, const JobMotionPlan& plan, io::OutputFiles& outputs) {
  const bool motion = plan.timing && plan.timing->motion;
  if (plan.result.parts.empty() || (request.timing && !motion))
    outputs.remove("--out");
  else if (!request.timing)
    outputs.write("--out", io::to_job_csv(plan.result, request.job));
  else if (outputs.wants("--out"))
    outputs.write("--out",
                  io::job_motion_text(*plan.timing->motion, request.job, plan.result.joint_names,
                                      request.job.base_link, request.out));
}

}  // namespace

int plan_job_file(JobRequest request, io::OutputFiles& outputs) {
  catch_interrupts();
  ProgressLine progress(!request.quiet && isatty(STDERR_FILENO));
  request.options.progress = [&](const Progress& now) { progress.show(now); };
  JobMotionPlan plan = planned(request);
  JobResult& result = plan.result;
  result.time_ms["load"] = request.load_ms;
  progress.clear();

  write_rows(request, plan, outputs);
  const io::JobExtras extras{plan.timing ? &*plan.timing : nullptr, plan.stopped};
  if (outputs.wants("--json"))
    outputs.write("--json", io::to_job_json(result, request.job, extras) + "\n");
  const bool infeasible = result.status == PlanStatus::kInfeasible;
  const bool no_motion = plan.timing && !plan.timing->motion;
  deliver(outputs,
          infeasible  ? "there is no job now"
          : no_motion ? "there is no motion now"
                      : "the search was stopped",
          [&] {
            if (!request.quiet && !outputs.takes_standard_output()) print_job(plan, request.job);
          });
  if (infeasible || no_motion) return kNo;
  return result.status == PlanStatus::kSolved && !plan.stopped ? kOk : kStopped;
}

}  // namespace swivel::cli
