// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>
#include <utility>

#include "swivel/core/answer/workcell_result.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/core/study/study_failure.hpp"
#include "swivel/planner/plan/plan_options.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "workcell/plan_and_measure.hpp"

namespace swivel {

/// The plan of a workcell of a campaign or of placements.
struct StudiedWorkcell {
  WorkcellResult result;
  /// Where the motion that is given does not keep its limits here: why. `result` says no more then
  /// than that there is no plan.
  std::optional<StudyFailure> fault{};
  [[nodiscard]] StudyFailure failure(const Problem& cell) const {
    return fault ? *fault : failure_of(result, cell);
  }
};

/// Plans a workcell whose objects or paths were moved. Throws as plan_workcell() does, but for a
/// given motion that is barred by an object where it now stands; Stopped.
inline StudiedWorkcell plan_studied(const Problem& cell, const PlanOptions& options,
                                    const Budget& budget) {
  const PreparedWorkcell prepared(cell, budget);
  if (const auto fault = fault_of_given_motion(prepared, budget)) {
    WorkcellResult barred;
    barred.names = {prepared.name(0), prepared.name(1)};
    barred.given_arm = prepared.given_arm();
    const std::string what = "given motion of '" + barred.names[*barred.given_arm] + "'";
    return {
        std::move(barred),
        StudyFailure{
            .reached_s = {}, .cause = "given_motion", .by = what, .reason = what + ": " + *fault}};
  }
  return {plan_workcell(prepared, options)};
}

}  // namespace swivel
