// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/study/study_failure.hpp"

#include <algorithm>
#include <cmath>

#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/study/placement.hpp"

namespace swivel {

namespace {

/// Fills in what ends every path of one stroke or arm. `who` is its name in words; "" of the only
/// one.
void fill(const Diagnosis& diagnosis, const std::vector<SceneObject>& scene, const std::string& who,
          StudyFailure& failure) {
  failure.reached_s = diagnosis.reached_s;
  if (diagnosis.cause.kind != Cause::Kind::kNone) failure.cause = to_string(diagnosis.cause.kind);
  failure.by = subject_of(diagnosis.cause, scene);
  failure.reason = (who.empty() ? "" : who + ": ") + words(diagnosis.cause);
}

/// Returns where the cheapest paths of two arms meet, and which bodies do.
std::string meeting_words(const Answer& result) {
  std::string text = "each arm has a path by itself, and no two of them keep clear";
  if (const auto given = result.given_arm())
    text = "'" + result.arms[1 - *given].name +
           "' has a path by itself, and none keeps clear of the given motion of '" +
           result.arms[*given].name + "'";
  const auto& conflict = result.pair.conflict;
  if (!conflict) return text;
  return text +
         formatted(": the cheapest meet at s = %.4f m of '%s' and %.4f m of '%s'%s: ",
                   conflict->s[0], result.arms[0].name.c_str(), conflict->s[1],
                   result.arms[1].name.c_str(), conflict->of_motion ? ", on the way on" : "") +
         conflict->bodies[0] + " and " + conflict->bodies[1];
}

StudyFailure failure_of_transition(const NoTransition& none, const ArmAnswer& arm,
                                   const Problem& problem) {
  std::vector<std::string> runs;
  for (const RunAnswer& run : arm.runs) runs.push_back("stroke " + words(run.run, problem));
  Cause bodies;
  if (none.bodies) bodies.bodies = *none.bodies;
  StudyFailure failure;
  failure.cause = "transition";
  failure.by = subject_of(bodies, problem.scene);
  failure.reason = words(none, runs);
  return failure;
}

StudyFailure failure_of_pair(const Answer& answer, const Problem& problem) {
  StudyFailure failure;
  failure.cause = "conflict";
  if (answer.pair.conflict) {
    Cause bodies;
    bodies.bodies = answer.pair.conflict->bodies;
    failure.by = subject_of(bodies, problem.scene);
  }
  failure.reason = meeting_words(answer);
  return failure;
}

}  // namespace

StudyFailure failure_of(const Answer& answer, const Problem& problem) {
  const bool two_arms = answer.arms.size() == 2;
  for (const ArmAnswer& arm : answer.arms)
    for (const RunAnswer& run : arm.runs) {
      if (run.status != PlanStatus::kInfeasible || !run.diagnosis) continue;
      StudyFailure failure;
      fill(*run.diagnosis, problem.scene,
           two_arms           ? "arm '" + arm.name + "'"
           : is_path(problem) ? ""
                              : "stroke " + words(run.run, problem),
           failure);
      return failure;
    }
  if (two_arms) return failure_of_pair(answer, problem);
  const auto& none = answer.arm().no_transition;
  return none ? failure_of_transition(*none, answer.arm(), problem) : StudyFailure();
}

}  // namespace swivel
