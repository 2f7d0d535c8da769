// SPDX-License-Identifier: BSD-3-Clause
// The data that GridCostToGo works on while it is at a layer.
#pragma once
#include <algorithm>
#include <tuple>

#include "cost_to_go/grid/grid_cost_to_go.hpp"
#include "cost_to_go/kernels/relax.hpp"

namespace swivel {

/// A range of a joint, rad.
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
  /// Takes the range of the joints that have a value; the others need not have been solved.
  JointRange(const double* q, const double* value, int begin, int end) {
    relax_kernels().range(q + begin, value + begin, end - begin, low, high);
  }
  [[nodiscard]] bool empty() const { return low > high; }
  void add(const JointRange& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
  [[nodiscard]] double gap(const JointRange& other) const {
    return std::max(low - other.high, other.low - high);
  }
};

/// A column, eight angles, of one IK solution.
struct GridCostToGo::Tile {
  int solution = 0, column = 0;
  bool live = false;  // holds values
  [[nodiscard]] int begin() const { return column * kTileWidth; }
  [[nodiscard]] int end(int angles) const { return std::min(angles, begin() + kTileWidth); }
  bool operator==(const Tile& o) const { return solution == o.solution && column == o.column; }
  bool operator<(const Tile& o) const {
    return std::tie(solution, column) < std::tie(o.solution, o.column);
  }
};

/// Ranges of the joints that tell the IK solutions of one elbow side apart.
struct GridCostToGo::MiddleRanges {
  static constexpr std::array<int, 2> kJoints{SrsLattice::kMiddleJoints[0],
                                              SrsLattice::kMiddleJoints[1]};
  std::array<JointRange, 2> joint;
};

/// The joints of one elbow side of a layer, from -window to angles + window around the circle,
/// solved by columns when they are wanted.
struct alignas(64) GridCostToGo::LayerJoints {
  int layer = -1;
  LayerNodes nodes;
  ColumnSet solved;
  /// Ranges of the joints that tell IK solutions apart, over what is solved: of each column, and of
  /// all.
  std::vector<MiddleRanges> of_tile, of_layer;  // [solution][column], [solution]
};

/// A layer's values, to relax others against, or being relaxed. While the elbow sides do not meet,
/// each goes through the layers by itself: its solutions may then be at another layer than the
/// others.
struct GridCostToGo::Workspace {
  std::vector<double> row;  // [solution][angle], of the tiles
  // [solution][padded angle]: the row once it is settled, infinite elsewhere
  std::vector<double> value;
  /// The finite values in the window of a column: first and last padded position; none where last <
  /// first.
  struct Window {
    int first = 0, last = -1;
    mutable std::array<MiddleRanges, 2> ranges;  // filled when asked for: [elbow side that asks]
  };
  std::vector<Window> windows;  // [solution][column], of the IK solutions with a finite value
  /// The solutions of one elbow side. One thread writes to it, and to those solutions' part of the
  /// arrays above.
  struct alignas(64) Half {
    int layer = -1;
    LayerJoints* joints = nullptr;  // null where no column is reached
    std::vector<Tile> tiles;        // to be relaxed or holding values, in order
    std::vector<int> solutions;     // with a finite value
    ColumnSet reached;              // columns with any near
    std::vector<int> columns;       // scratch of reach_back
    std::int64_t ik_nodes = 0, edges = 0;
  };
  std::array<Half, 2> halves;  // [elbow side]
  [[nodiscard]] Half& half(int side) { return halves[static_cast<std::size_t>(side)]; }
  [[nodiscard]] const Half& half(int side) const { return halves[static_cast<std::size_t>(side)]; }
  [[nodiscard]] bool find(const SrsLattice& lattice, int slot) const {
    const int solution = lattice.solution_of(slot);
    const std::vector<Tile>& tiles = half(lattice.elbow_side_of(solution)).tiles;
    return std::binary_search(tiles.begin(), tiles.end(),
                              Tile{solution, lattice.angle_of(slot) / kTileWidth});
  }
  [[nodiscard]] bool reaches_any() const {
    return !halves[0].solutions.empty() || !halves[1].solutions.empty();
  }
};

template <class Part>
void GridCostToGo::by_elbow_side(const Part& part) {
  struct CollectsCounts {
    GridCostToGo* grid;
    ~CollectsCounts() { grid->collect_counts(); }
  } const at_end{this};
  if (apart_)
    return work_.for_each(SrsLattice::kElbowSides, [&part](int side, int) { part(side); });
  for (int side = 0; side < SrsLattice::kElbowSides; ++side) part(side);
}

}  // namespace swivel
