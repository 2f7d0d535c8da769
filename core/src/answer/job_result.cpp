// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/answer/job_result.hpp"

#include <algorithm>

#include "swivel/core/study/placement.hpp"

namespace swivel {

namespace {

std::string words(const Job& job, const StrokeRun& run) {
  return "stroke '" + job.strokes[run.stroke].name + "'" + (run.reversed ? " backwards" : "");
}

}  // namespace

const char* to_string(NoTransition::Where where) {
  switch (where) {
    case NoTransition::Where::kBetween:
      return "between";
    case NoTransition::Where::kHome:
      return "home";
    case NoTransition::Where::kEndBefore:
      return "end";
    case NoTransition::Where::kBegin:
      break;
  }
  return "begin";
}

std::string words(const NoTransition& none, const std::vector<std::string>& runs) {
  const std::string bodies =
      none.bodies ? (*none.bodies)[0] + " - " + (*none.bodies)[1] : std::string("bodies");
  const std::string too_near = bodies + " come nearer to each other than transitions may";
  switch (none.where) {
    case NoTransition::Where::kHome:
      return "at home " + too_near;
    case NoTransition::Where::kEndBefore:
      return "wherever " + runs[none.to - 1] + " may end, " + too_near +
             ": a longer retract would lead away";
    case NoTransition::Where::kBegin:
      return "wherever " + runs[none.to] + " may begin, " + too_near +
             ": a longer approach would begin further away";
    case NoTransition::Where::kBetween:
      break;
  }
  std::string text = "no way leads from " + (none.to == 0 ? "home" : runs[none.to - 1]) + " to " +
                     (none.to < runs.size() ? runs[none.to] : "home");
  if (none.bodies) text += "; " + bodies + " bar the straight one";
  return text;
}

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
    failure.reason = words(job, failed->run) + ": " + words(cause);
  } else if (const auto& none = result.no_transition) {
    std::vector<std::string> runs;
    for (const RunResult& run : result.runs) runs.push_back(words(job, run.run));
    Cause bodies;
    if (none->bodies) bodies.bodies = *none->bodies;
    failure.cause = "transition";
    failure.by = subject_of(bodies, job.scene);
    failure.reason = words(*none, runs);
  }
  return failure;
}

}  // namespace swivel
