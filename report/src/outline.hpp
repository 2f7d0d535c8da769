// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <vector>

namespace swivel::detail {

/// A corner of the lines between the cells of a grid: column c and row r is at the lower left of
/// the cell of that column and row.
struct GridCorner {
  int column = 0, row = 0;
  bool operator==(const GridCorner&) const = default;
};

/// Returns the outlines of the cells of a grid of which `inside`, called with row and column, is
/// true: closed loops of corners, whose sides are horizontal and vertical alternately, the
/// first one horizontal. A cell is inside where a ray from its middle crosses the loops an odd
/// number of times.
[[nodiscard]] std::vector<std::vector<GridCorner>> outlines(
    int rows, int columns, const std::function<bool(int, int)>& inside);

}  // namespace swivel::detail
