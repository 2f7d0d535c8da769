// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>

#include "swivel/core/answer/job_result.hpp"
#include "swivel/core/problem/job.hpp"

namespace swivel {

/// Why a job cannot be planned, as tables of campaigns and placements say it.
struct JobFailure {
  /// Furthest that a valid path of the failed stroke comes, m along its run; none where not even
  /// the first layer has a node, and where a transition failed.
  std::optional<double> reached_s;
  /// to_string(Cause::Kind) of what ends paths there; "transition" where each stroke has a path by
  /// itself and there is no way between two; "" if it is not known.
  std::string cause;
  std::string by;      ///< what the cause is about, see subject_of(); "" where it says it all
  std::string reason;  ///< stroke and cause in words, or the transition that has no way
};
/// Returns why the first stroke that has no path by itself has none, else why there is no
/// transition. `result` is that of an infeasible `job`.
[[nodiscard]] JobFailure failure_of(const JobResult& result, const Job& job);

}  // namespace swivel
