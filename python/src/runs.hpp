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

/// Returns what place() and `Problem.placed` move: exactly one of the three. Throws InvalidArgument
/// otherwise.
[[nodiscard]] Movable to_movable(const std::optional<std::string>& object, bool path, bool base);

}  // namespace swivel::python
