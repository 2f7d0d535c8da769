// SPDX-License-Identifier: BSD-3-Clause
// Many plans of one problem: the tables of placements and campaigns.
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
  std::shared_ptr<const std::vector<Row>> rows;  // shared: with arrays
  std::vector<std::string> coordinates;          // of episodes: whose offsets the rows have
};
using Placements = Table<PlacementRow>;
using Episodes = Table<EpisodeRow>;

/// What place() and `Problem.placed` move: exactly one of the three. Throws InvalidArgument.
[[nodiscard]] Movable to_movable(const std::optional<std::string>& object, bool path, bool base);

}  // namespace swivel::python
