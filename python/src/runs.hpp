// SPDX-License-Identifier: BSD-3-Clause
// Tables of many plans of one problem: placements and campaigns.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/core/study/placement.hpp"

namespace swivel::python {

template <class Row>
struct Table {
  std::shared_ptr<const std::vector<Row>> rows;  // shared with arrays
  std::vector<std::string> coordinates;          // for episodes: names of the offsets in the rows
};
using Placements = Table<PlacementRow>;
using Episodes = Table<EpisodeRow>;

/// Returns what place() and `Problem.placed` move: exactly one of the three, or where joints alone
/// are held elsewhere (`only_held`) none. Throws InvalidArgument otherwise, and for an arm whose
/// path is not moved.
[[nodiscard]] Movable to_movable(const std::optional<std::string>& object, bool path, bool base,
                                 bool only_held = false,
                                 const std::optional<std::string>& arm = {});

/// Returns a problem, a job or a workcell with joints held elsewhere. Throws InvalidArgument.
template <class Planned>
Planned held_as(Planned planned, const HeldPositions& positions) {
  hold_joints(planned, positions);
  return planned;
}

}  // namespace swivel::python
