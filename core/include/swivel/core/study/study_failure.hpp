// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// Why a problem has no answer, as tables of campaigns and placements say it.
struct StudyFailure {
  /// Furthest that a valid path of the failed stroke or arm comes, m along it; none where not even
  /// the first layer has a node, and where the cause is "transition" or "conflict".
  std::optional<double> reached_s;
  /// to_string(Cause::Kind) of what ends paths there; "transition" where each stroke has a path by
  /// itself and there is no way between two; "conflict" where each arm has a path by itself and no
  /// two of them keep clear of each other; "" if it is not known.
  std::string cause;
  std::string by;      ///< what the cause is about, see subject_of(); "" where it says it all
  std::string reason;  ///< stroke or arm and cause in words, or what is barred between two
  /// Fills in the columns of an EpisodeRow or a PlacementRow that say why there is no plan.
  template <class Row>
  void tell(Row& row) const {
    row.failed_s = reached_s;
    row.cause = cause;
    row.by = by;
    row.reason = reason;
  }
};
/// Returns why the first run that has no path by itself has none, else why there is no transition,
/// or where both arms bar each other. `answer` is that of an infeasible `problem`.
[[nodiscard]] StudyFailure failure_of(const Answer& answer, const Problem& problem);

}  // namespace swivel
