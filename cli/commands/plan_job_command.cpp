// SPDX-License-Identifier: BSD-3-Clause
#include "commands/plan_job_command.hpp"

#include <unistd.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/advice_or_warning.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/motion/job_text.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/robots/urdf_shapes.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/job/job_view.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/advise.hpp"
#include "swivel/report/job_page.hpp"
#include "terminal/progress.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// Returns how long each stage of a job's plan took, in words.
std::string stages_text(const Answer& result) {
  std::string text;
  for (const char* const stage :
       {"load", "lattice", "find", "order", "lift", "report", "check", "time", "check motion"})
    if (const auto found = result.time_ms.find(stage); found != result.time_ms.end())
      text += formatted("%s%s %.1f ms", text.empty() ? "" : ", ", stage, found->second);
  return text;
}

/// Prints the answer, times and work counts of a job; warnings go to standard error.
void print_job(const JobMotionPlan& plan, const Problem& job) {
  const Answer& result = plan.result;
  say_text(answer_text(result, job));
  if (plan.timing) say_text(job_motion_text(*plan.timing, result.arm().parts, job));
  const Counters& c = result.arm().counters;
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

/// What was found out about a job.
struct JobAnswer {
  JobMotionPlan plan;
  std::optional<AdviceOnJob> advice{};              ///< with --advise, where there is no job
  std::optional<InfeasibilityCertificate> proof{};  ///< with --certificate, of a stroke
  std::string certificate{};                        ///< `proof` as JSON
};

/// Proves that a stroke of the job has no path, if one has none, from what the plan found out about
/// it. Adds a warning to the result if none is known to have none, or if the budget ends first.
void find_certificate(const Problem& job, const JobView& view, const Budget& budget,
                      JobAnswer& answer) {
  Answer& result = answer.plan.result;
  const auto run =
      std::find_if(result.arm().runs.begin(), result.arm().runs.end(),
                   [](const RunAnswer& one) { return one.status == PlanStatus::kInfeasible; });
  if (run == result.arm().runs.end()) {
    result.warnings.push_back(result.arm().runs.empty()  // where home is barred
                                  ? "no stroke was planned by itself: there is no certificate"
                                  : "each stroke has a path by itself: there is no certificate");
    return;
  }
  const Stroke& stroke = job.arm().strokes[run->run.stroke];
  if (stroke.reversible) {
    result.warnings.push_back("stroke '" + stroke.name +
                              "' is reversible, and a certificate is of one direction: there is "
                              "none; allowed are strokes that are not reversible");
    return;
  }
  try {
    const auto index = static_cast<std::size_t>(run - result.arm().runs.begin());
    answer.proof = prove_infeasible(view.runs.at(index), budget);
    answer.proof->stroke = stroke.name;
    answer.proof->reversed = run->run.reversed;
    answer.certificate = io::to_json(*answer.proof);
  } catch (const Stopped&) {
    result.warnings.push_back("stopped before the certificate was found: there is none");
  }
}

/// Where there is no job, seeks changes that would help, within --advise and what is left of
/// --timeout, that of `budget`.
void find_advice(const JobRequest& request, const PreparedRobot& robot, const Problem& job,
                 const Budget& budget, JobAnswer& answer) {
  if (!request.advise_s) return;
  PlanOptions trials = request.options;
  trials.timeout_s = std::min(budget.seconds_left().value_or(*request.advise_s), *request.advise_s);
  answer.advice = advice_or_warning(answer.plan.result.warnings, [&] {
    return advise_job(robot, job, answer.plan.result, trials);
  });
}

/// Returns what followed the plan, for the result file. It points into `answer`.
io::JobExtras extras_of(const JobAnswer& answer) {
  const JobMotionPlan& plan = answer.plan;
  return {plan.timing ? &*plan.timing : nullptr, plan.stopped,
          answer.advice ? &*answer.advice : nullptr};
}

JobMotionPlan planned(const JobRequest& request, const PreparedRobot& robot, const Problem& job,
                      JobView* view) {
  if (request.timing) return plan_job_motion(robot, job, request.options, *request.timing, view);
  return {.result = plan_job(robot, job, request.options, view), .timing = {}};
}

/// Returns the page of --report; unset where there is neither a job nor a verdict, or where time is
/// up first, of which a warning tells.
std::optional<std::string> page_of(const JobRequest& request, const PreparedRobot& robot,
                                   const Problem& given, const JobView& view, const Budget& budget,
                                   JobAnswer& answer) {
  const JobMotionPlan& plan = answer.plan;
  const Answer& result = plan.result;
  const Problem job = executed_problem(given, result);
  if (!request.report || (result.arm().parts.empty() && result.status != PlanStatus::kInfeasible))
    return std::nullopt;
  try {
    std::string text = answer_text(result, job);
    if (answer.advice) text += advice_text(*answer.advice);
    if (plan.timing) text += job_motion_text(*plan.timing, result.arm().parts, job);
    const JobMotion* motion = plan.timing && plan.timing->motion ? &*plan.timing->motion : nullptr;
    const io::VisualRobot visual = io::load_visuals(*job.arm().model);
    return to_job_page({robot, job, result, view, motion},
                       io::to_job_json(result, job, extras_of(answer)), budget,
                       {request.which, text, visual.model.get(), visual.left_out});
  } catch (const Stopped&) {
    answer.plan.result.warnings.push_back("stopped before the page was made: there is no report");
    return std::nullopt;
  }
}

/// Gives --out its text: the motion where one is asked for, else the trajectory. Marks an earlier
/// file for removal if there is none.
/// `job` is the one of which the parts of the plan are.
void write_rows(const JobRequest& request, const JobMotionPlan& plan, const Problem& job,
                io::OutputFiles& outputs) {
  const bool motion = plan.timing && plan.timing->motion;
  if (plan.result.arm().parts.empty() || (request.timing && !motion))
    outputs.remove("--out");
  else if (!request.timing)
    outputs.write("--out", io::to_csv(plan.result, job));
  else
    outputs.write_each("--out", [&](const std::filesystem::path& file) {
      return io::job_motion_text(*plan.timing->motion, job, plan.result.arm().joint_names,
                                 job.arm().base_link, file);
    });
}

/// Returns the reason for which earlier files are removed.
const char* reason_of_removal(const JobMotionPlan& plan, const io::OutputFiles& outputs) {
  if (plan.result.status == PlanStatus::kInfeasible) return "there is no job now";
  if (plan.timing && !plan.timing->motion) return "there is no motion now";
  const bool solved = plan.result.status == PlanStatus::kSolved && !plan.stopped;
  if (solved && outputs.wants("--certificate")) return "there is a job now";
  return "the search was stopped";
}

}  // namespace

int plan_job_file(JobRequest request, io::OutputFiles& outputs) {
  catch_interrupts();
  ProgressLine progress(!request.quiet && isatty(STDERR_FILENO));
  request.options.progress = [&](const Progress& now) { progress.show(now); };
  const Problem job = request.timing ? with_motion_defaults(request.job) : request.job;
  // This budget covers the certificate, the advice and the page; planning has one of its own.
  const Budget budget = request.options.budget();
  const PreparedRobot robot(problem_of_run(job, {0, false}));
  JobView view;
  const bool keeps_view = request.report || outputs.wants("--certificate");
  JobAnswer answer{planned(request, robot, job, keeps_view ? &view : nullptr)};
  if (answer.plan.result.status == PlanStatus::kInfeasible) {
    if (outputs.wants("--certificate")) find_certificate(job, view, budget, answer);
    find_advice(request, robot, job, budget, answer);
  }
  JobMotionPlan& plan = answer.plan;
  Answer& result = plan.result;
  result.time_ms["load"] = request.load_ms;
  std::optional<std::string> page = page_of(request, robot, job, view, budget, answer);
  progress.clear();

  const Problem executed = executed_problem(request.job, result);
  write_rows(request, plan, executed, outputs);
  const std::size_t certificate_bytes = answer.certificate.size();
  if (answer.proof)
    outputs.write("--certificate", std::move(answer.certificate));
  else
    outputs.remove("--certificate");
  if (page)
    outputs.write("--report", std::move(*page));
  else
    outputs.remove("--report");
  const io::JobExtras extras = extras_of(answer);
  if (outputs.wants("--json"))
    outputs.write("--json", io::to_job_json(result, executed, extras) + "\n");
  const bool infeasible = result.status == PlanStatus::kInfeasible;
  const bool no_motion = plan.timing && !plan.timing->motion;
  deliver(outputs, reason_of_removal(plan, outputs), [&] {
    if (request.quiet || outputs.takes_standard_output()) return;
    print_job(plan, executed);
    if (answer.proof)
      say_text("  stroke '" + answer.proof->stroke +
               (answer.proof->reversed ? "' backwards: " : "': ") +
               certificate_text(*answer.proof, certificate_bytes));
    if (answer.advice) say_text(advice_text(*answer.advice));
  });
  if (infeasible || no_motion) return kNo;
  return result.status == PlanStatus::kSolved && !plan.stopped ? kOk : kStopped;
}

}  // namespace swivel::cli
