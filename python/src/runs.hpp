// SPDX-License-Identifier: BSD-3-Clause
// Tables of many plans of one problem: placements and campaigns.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "base/bindings.hpp"
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

}  // namespace swivel::python
