// SPDX-License-Identifier: BSD-3-Clause
// What GridCostToGo works with while it is at a layer.
#pragma once
#include <algorithm>
#include <tuple>

#include "grid_cost_to_go.hpp"
#include "kernels/relax.hpp"

namespace swivel {

/// A range of a joint.
struct GridCostToGo::JointRange {
  double low = kUnreachable, high = -kUnreachable;
  JointRange() = default;
  JointRange(const double* q, int count) {
    const auto of = [&](const auto& values) {
      low = values.minCoeff();
      high = values.maxCoeff();
    };
    if (count == kTileWidth)
      of(Eigen::Map<const Eigen::Array<double, kTileWidth, 1>>(q));
    else
      of(Eigen::Map<const Eigen::ArrayXd>(q, count));
  }
  /// Of those that have a value; the others need not have been solved.
  JointRange(const double* q, const double* value, int begin, int end) {
    relax_kernels().range(q + begin, value + begin, end - begin, low, high);
  }
  [[nodiscard]] bool empty() const { return low > high; }
  void add(const JointRange& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
  [[nodiscard]] double gap(const JointRange& other) const { return std::max(low - other.high, other.low - high); }
};

/// A column of a sheet.
struct GridCostToGo::Tile {
  int sheet = 0, column = 0;
  bool live = false;  // holds values
  [[nodiscard]] int begin() const { return column * kTileWidth; }
  [[nodiscard]] int end(int angles) const { return std::min(angles, begin() + kTileWidth); }
  bool operator==(const Tile& o) const { return sheet == o.sheet && column == o.column; }
  bool operator<(const Tile& o) const { return std::tie(sheet, column) < std::tie(o.sheet, o.column); }
};

/// Ranges of the joints that tell the sheets of a family apart.
struct GridCostToGo::MiddleRanges {
  static constexpr std::array<int, 2> kJoints{SrsLattice::kMiddleJoints[0], SrsLattice::kMiddleJoints[1]};
  std::array<JointRange, 2> joint;
};

/// The joints of one layer, from -window to angles + window around the circle, solved by columns as they are wanted.
struct GridCostToGo::LayerJoints {
  int layer = -1;
  LayerNodes nodes;
  enum : std::uint8_t { kOpen, kAhead, kWanted };   // kAhead: solved before anyone asked
  std::array<std::vector<std::uint8_t>, 2> solved;  // [family][column]
  /// Ranges of the joints that tell sheets apart, over what is solved: of each column, and of all.
  std::vector<MiddleRanges> of_tile, of_layer;  // [sheet][column], [sheet]
};

/// A layer's values, ready to be relaxed against or being relaxed.
struct GridCostToGo::Workspace {
  int layer = -1;
  LayerJoints* joints = nullptr;
  std::vector<double> row;    // [sheet][angle], of the tiles
  std::vector<Tile> tiles;    // to be relaxed or holding values, in order
  std::vector<double> value;  // [sheet][padded angle]: the row once it is settled, infinite elsewhere
  std::vector<int> sheets;    // with a finite value
  /// The finite values in the window of a column: first and last padded position, none where last < first.
  struct Window {
    int first = 0, last = -1;
    mutable MiddleRanges ranges;  // filled when asked for
  };
  std::vector<Window> windows;       // [sheet][column], of the sheets with a finite value
  std::array<ColumnSet, 2> reached;  // [family]: columns with any near
  [[nodiscard]] const LayerNodes& nodes() const { return joints->nodes; }
  [[nodiscard]] bool find(int sheet, int column) const {
    return std::binary_search(tiles.begin(), tiles.end(), Tile{sheet, column});
  }
};

}  // namespace swivel
