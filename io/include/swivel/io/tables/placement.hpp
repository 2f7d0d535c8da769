// SPDX-License-Identifier: BSD-3-Clause
// Placements out: the table of all. docs/formats.md "Placements".
#pragma once
#include <string>
#include <vector>

#include "swivel/core/study/placement.hpp"

namespace swivel::io {

/// One line a placement, in the order given.
[[nodiscard]] std::string to_csv(const std::vector<PlacementRow>& rows);

}  // namespace swivel::io
