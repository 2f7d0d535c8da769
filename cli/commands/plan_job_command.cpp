// SPDX-License-Identifier: BSD-3-Clause
#include "commands/plan_job_command.hpp"

#include <unistd.h>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "output/job_output.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "terminal/progress.hpp"
#include "terminal/terminal.hpp"

namespace swivel::cli {

namespace {

/// Prints the answer, times and work counts of a job; warnings go to standard error.
void print_job(const JobResult& result, const Job& job) {
  say_text(job_text(result, job));
  const auto ms = [&](const char* stage) {
    const auto found = result.time_ms.find(stage);
    return found == result.time_ms.end() ? 0.0 : found->second;
  };
  const Counters& c = result.counters;
  say("%s, %d thread%s: load %.1f ms, prepare %.1f ms, plan %.1f ms", result.planner.c_str(),
      result.threads, result.threads == 1 ? "" : "s", ms("load"), ms("prepare"), ms("plan"));
  if (result.checked) say(", checked in %.1f ms", ms("check"));
  say("; %lld nodes and %lld edges checked, %lld FCL calls\n",
      static_cast<long long>(c.nodes_checked), static_cast<long long>(c.edges_checked),
      static_cast<long long>(c.fcl_calls));
  for (const std::string& warning : result.warnings)
    complain("swivel: warning: %s\n", warning.c_str());
}

}  // namespace

int plan_job_file(JobRequest request, io::OutputFiles& outputs) {
  catch_interrupts();
  ProgressLine progress(!request.quiet && isatty(STDERR_FILENO));
  request.options.progress = [&](const Progress& now) { progress.show(now); };
  JobResult result = plan_job(request.job, request.options);
  result.time_ms["load"] = request.load_ms;
  progress.clear();

  if (result.parts.empty())
    outputs.remove("--out");
  else
    outputs.write("--out", io::to_job_csv(result, request.job));
  if (outputs.wants("--json")) outputs.write("--json", io::to_job_json(result, request.job) + "\n");
  const bool infeasible = result.status == PlanStatus::kInfeasible;
  deliver(outputs, infeasible ? "there is no job now" : "the search was stopped", [&] {
    if (!request.quiet && !outputs.takes_standard_output()) print_job(result, request.job);
  });
  if (infeasible) return kNo;
  return result.status == PlanStatus::kSolved ? kOk : kStopped;
}

}  // namespace swivel::cli
