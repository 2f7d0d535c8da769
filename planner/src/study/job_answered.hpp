// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>

#include "swivel/core/answer/job_result.hpp"
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

}  // namespace swivel
