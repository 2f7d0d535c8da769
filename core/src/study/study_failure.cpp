// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/study/study_failure.hpp"

#include <algorithm>
#include <cmath>

#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/study/placement.hpp"

namespace swivel {

namespace {

std::string run_words(const Problem& job, const StrokeRun& run) {
  return "stroke '" + job.arm().strokes[run.stroke].name + "'" + (run.reversed ? " backwards" : "");
}

/// Fills in what ends every path of one stroke or arm. `who` is its name in words.
void fill(const Diagnosis& diagnosis, const std::vector<SceneObject>& scene, const std::string& who,
          StudyFailure& failure) {
  failure.reached_s = diagnosis.reached_s;
  if (diagnosis.cause.kind != Cause::Kind::kNone) failure.cause = to_string(diagnosis.cause.kind);
  failure.by = subject_of(diagnosis.cause, scene);
  failure.reason = who + ": " + words(diagnosis.cause);
}

/// Returns where the cheapest paths of two arms meet, and which bodies do.
std::string meeting_words(const WorkcellResult& result) {
  std::string text = "each arm has a path by itself, and no two of them keep clear";
  if (const auto given = result.given_arm)
    text = "'" + result.names[1 - *given] +
           "' has a path by itself, and none keeps clear of the given motion of '" +
           result.names[*given] + "'";
  const auto& conflict = result.conflict;
  if (!conflict) return text;
  return text +
         formatted(": the cheapest meet at s = %.4f m of '%s' and %.4f m of '%s'%s: ",
                   conflict->s[0], result.names[0].c_str(), conflict->s[1], result.names[1].c_str(),
                   conflict->of_motion ? ", on the way on" : "") +
         conflict->bodies[0] + " and " + conflict->bodies[1];
}

}  // namespace

StudyFailure failure_of(const JobResult& result, const Problem& job) {
  StudyFailure failure;
  const auto failed = std::find_if(result.runs.begin(), result.runs.end(), [](const auto& run) {
    return run.status == PlanStatus::kInfeasible && run.diagnosis;
  });
  if (failed != result.runs.end()) {
    fill(*failed->diagnosis, job.scene, run_words(job, failed->run), failure);
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

StudyFailure failure_of(const WorkcellResult& result, const Problem& cell) {
  StudyFailure failure;
  for (std::size_t k = 0; k < 2; ++k)
    if (!std::isfinite(result.least_costs[k])) {
      fill(result.arms[k].diagnosis, cell.scene, "arm '" + result.names[k] + "'", failure);
      return failure;
    }
  failure.cause = "conflict";
  if (result.conflict) {
    Cause bodies;
    bodies.bodies = result.conflict->bodies;
    failure.by = subject_of(bodies, cell.scene);
  }
  failure.reason = meeting_words(result);
  return failure;
}

}  // namespace swivel
