// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/study/job_failure.hpp"

#include <algorithm>

#include "swivel/core/study/placement.hpp"

namespace swivel {

namespace {

std::string run_words(const Job& job, const StrokeRun& run) {
  return "stroke '" + job.strokes[run.stroke].name + "'" + (run.reversed ? " backwards" : "");
}

}  // namespace

JobFailure failure_of(const JobResult& result, const Job& job) {
  JobFailure failure;
  const auto failed = std::find_if(result.runs.begin(), result.runs.end(), [](const auto& run) {
    return run.status == PlanStatus::kInfeasible && run.diagnosis;
  });
  if (failed != result.runs.end()) {
    const Cause& cause = failed->diagnosis->cause;
    failure.reached_s = failed->diagnosis->reached_s;
    if (cause.kind != Cause::Kind::kNone) failure.cause = to_string(cause.kind);
    failure.by = subject_of(cause, job.scene);
    failure.reason = run_words(job, failed->run) + ": " + words(cause);
  } else if (const auto& none = result.no_transition) {
    std::vector<std::string> runs;
    for (const RunResult& run : result.runs) runs.push_back(run_words(job, run.run));
    Cause bodies;
    if (none->bodies) bodies.bodies = *none->bodies;
    failure.cause = "transition";
    failure.by = subject_of(bodies, job.scene);
    failure.reason = words(*none, runs);
  }
  return failure;
}

}  // namespace swivel
