// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/answer/plan.hpp"

namespace swivel {

/// Returns what ended the paths of a row, for people: its object, its joint, or the cause in words;
/// empty where there is a path. `cause`, `by`, `reason` as in PlacementRow and EpisodeRow.
[[nodiscard]] std::string ended_by(PlanStatus status, const std::string& cause,
                                   const std::string& by, const std::string& reason);

}  // namespace swivel
