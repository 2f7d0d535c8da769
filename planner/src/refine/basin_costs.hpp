// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

/// The nodes of one IK solution in one layer, over the circle of arm angles and `window` more on
/// both sides: index window + j belongs to arm angle j.
struct BasinColumn {
  std::array<std::vector<float>, kDof> q;  ///< joints times what the metric weighs them by
  std::vector<float> mask;                 ///< 0 where there is a node, else infinite
};

/// What a change of the joints costs.
struct BasinMetric {
  std::array<float, kDof> period{};  ///< a turn of each continuous joint, weighted; else 0
  /// l2, l1 or max, of the weighted moves
  CostMetric metric = CostMetric::kL2;
};

/// The least costs of paths of one IK solution over a few layers, in which the arm angle changes by
/// at most `window` of its steps from a layer to the next: single precision, since they only tell
/// which ways are worth a closer look.
class BasinCosts {
 public:
  BasinCosts(int layers, int angles, int window);
  /// Computes the costs; columns[k] is that of layer k. Returns false if no path leads to the last
  /// layer. Throws Stopped.
  bool compute(const std::vector<BasinColumn>& columns, const BasinMetric& metric,
               const Budget& budget);
  /// Returns the least cost of a path through arm angle j of layer k, infinite where there is none.
  [[nodiscard]] float through(int k, int j) const {
    return forward_[at(k, j)] + backward_[at(k, j)];
  }
  /// Returns the cheapest path through a node, as the number of its arm angle in each layer; of
  /// several, the one whose arm angle grows most.
  [[nodiscard]] std::vector<int> trace(int k, int j) const;
  /// Returns the number of an arm angle, which may be counted beyond the circle's ends.
  [[nodiscard]] int around(int j) const { return (j % angles_ + angles_) % angles_; }

 private:
  [[nodiscard]] std::size_t at(int k, int j) const {
    return static_cast<std::size_t>(k) * static_cast<std::size_t>(angles_) +
           static_cast<std::size_t>(j);
  }
  /// Returns the costs of the edges from arm angle j + o - window of layer k - 1 to j of layer k,
  /// by j.
  [[nodiscard]] const float* costs(int k, int o) const {
    return cost_.data() + at(k * offsets_ + o, 0);
  }
  void sweep_back(int k);

  int layers_, angles_, window_, offsets_;
  std::vector<float> forward_, backward_, cost_;
  std::vector<float> padded_;  // scratch: a layer's costs, `window` more on both sides
};

}  // namespace swivel
