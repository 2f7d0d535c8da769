// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <optional>
#include <vector>

#include "swivel/core/motion/layer_solver.hpp"

namespace swivel {

/// Every stride-th layer of another solver, its first and its last included.
class StridedSolver final : public LayerSolver {
 public:
  StridedSolver(const LayerSolver& all, int stride) : all_(&all) {
    for (int i = 0; i + 1 < all.layers(); i += stride) layer_.push_back(i);
    layer_.push_back(all.layers() - 1);
  }
  [[nodiscard]] int layers() const override { return static_cast<int>(layer_.size()); }
  [[nodiscard]] int layer(int k) const { return layer_[static_cast<std::size_t>(k)]; }
  /// Returns the index of the last chosen layer at or before a layer of the other solver.
  [[nodiscard]] int no_later(int layer) const {
    return static_cast<int>(std::upper_bound(layer_.begin(), layer_.end(), layer) -
                            layer_.begin()) -
           1;
  }
  [[nodiscard]] double travel(int k) const override { return all_->travel(layer(k)); }
  [[nodiscard]] std::optional<Config> joints(int k, double angle) const override {
    return all_->joints(layer(k), angle);
  }

 private:
  const LayerSolver* all_;
  std::vector<int> layer_;
};

}  // namespace swivel
