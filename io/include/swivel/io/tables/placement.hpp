// SPDX-License-Identifier: BSD-3-Clause
// Writes the table of placements. docs/formats.md "Placements".
#pragma once
#include <string>
#include <vector>

#include "swivel/core/study/placement.hpp"

namespace swivel::io {

/// Returns the CSV table of placements with its header, one line for each, in the given order. All
/// have the same joints held.
[[nodiscard]] std::string to_csv(const std::vector<PlacementRow>& rows);

}  // namespace swivel::io
