// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>

#include "swivel/core/answer/job_result.hpp"
#include "swivel/core/answer/workcell_result.hpp"
#include "swivel/core/base/budget.hpp"

namespace swivel {

/// Returns true if the plan of a job ended within its budget, with its verdict, its evidence and
/// the diagnosis of each stroke that has no path.
inline bool answered(const JobResult& result, const Budget& budget) {
  const bool decided =
      result.status == PlanStatus::kSolved || result.status == PlanStatus::kInfeasible;
  return decided && !budget.spent() && result.time_ms.contains("report") &&
         std::all_of(result.runs.begin(), result.runs.end(), [](const RunResult& run) {
           return !run.diagnosis || run.diagnosis->complete;
         });
}

/// Returns true if the plan of a workcell ended within its budget, with its verdict, its evidence
/// and the diagnosis of each arm that has no path by itself.
inline bool answered(const WorkcellResult& result, const Budget& budget) {
  if (budget.spent() || !result.time_ms.contains("report")) return false;
  if (result.status == PlanStatus::kSolved) return true;
  const auto explained = [&](std::size_t arm) {
    return std::isfinite(result.least_costs[arm]) || result.arms[arm].diagnosis.complete;
  };
  return result.status == PlanStatus::kInfeasible && explained(0) && explained(1);
}

}  // namespace swivel
