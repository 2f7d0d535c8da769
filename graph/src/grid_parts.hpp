// SPDX-License-Identifier: BSD-3-Clause
// What GridCostToGo works with while it is at a layer.
#pragma once
#include <algorithm>
#include <tuple>

#include "grid_cost_to_go.hpp"

namespace swivel {

/// A range of a joint.
struct GridCostToGo::Interval {
  double low = kUnreachable, high = -kUnreachable;
  Interval() = default;
  Interval(const double* q, int count) {
    const Eigen::Map<const Eigen::ArrayXd> values(q, count);
    low = values.minCoeff();
    high = values.maxCoeff();
  }
  /// Of those that have a value; the others need not have been solved.
  Interval(const double* q, const double* value, int begin, int end) {
    for (int k = begin; k < end; ++k)
      if (value[k] != kUnreachable) add(q[k]);
  }
  [[nodiscard]] bool empty() const { return low > high; }
  void add(double q) {
    low = q < low ? q : low;
    high = q > high ? q : high;
  }
  void add(const Interval& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
  [[nodiscard]] double gap(const Interval& other) const { return std::max(low - other.high, other.low - high); }
};

/// A chunk of a label.
struct GridCostToGo::Part {
  int label = 0, chunk = 0;
  bool live = false;  // holds values
  [[nodiscard]] int begin() const { return chunk * kChunk; }
  [[nodiscard]] int end(int angles) const { return std::min(angles, begin() + kChunk); }
  bool operator==(const Part& o) const { return label == o.label && chunk == o.chunk; }
  bool operator<(const Part& o) const { return std::tie(label, chunk) < std::tie(o.label, o.chunk); }
};

/// Ranges of the joints that tell the labels of a family apart.
struct GridCostToGo::Middles {
  static constexpr std::array<int, 2> kJoints{SrsLattice::kMiddleJoints[0], SrsLattice::kMiddleJoints[1]};
  std::array<Interval, 2> joint;
};

/// The joints of one layer, from -window to angles + window around the circle, solved by chunks as they are wanted.
struct GridCostToGo::Joints {
  int layer = -1;
  LayerNodes nodes;
  std::array<std::vector<std::uint8_t>, 2> solved;  // [family][chunk]
  /// Ranges of the joints that tell labels apart, over what is solved: of each chunk, and of all.
  std::vector<Middles> of_chunk, of_layer;  // [label][chunk], [label]
};

/// A layer's values, ready to be relaxed against or being relaxed.
struct GridCostToGo::Block {
  int layer = -1;
  Joints own;
  Joints* joints = nullptr;
  std::vector<double> row;    // [label][angle], of the parts
  std::vector<Part> parts;    // to be relaxed or holding values, in order
  std::vector<double> value;  // [label][padded angle]: the row once it is settled, infinite elsewhere
  std::vector<int> labels;    // with a finite value
  /// The finite values in the window of a chunk: first and last padded position, none where last < first.
  struct Near {
    int first = 0, last = -1;
    mutable Middles middles;  // filled when asked for
  };
  std::vector<Near> near;        // [label][chunk], of the labels with a finite value
  std::array<Marks, 2> reached;  // [family]: chunks with any near
  [[nodiscard]] const LayerNodes& nodes() const { return joints->nodes; }
  [[nodiscard]] bool find(int label, int chunk) const { return std::binary_search(parts.begin(), parts.end(), Part{label, chunk}); }
};

}  // namespace swivel
