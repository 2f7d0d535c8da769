// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// The joints along a path as a function of one coordinate in each layer: the interface of an arm
/// for smooth_minimum().
class LayerSolver {
 public:
  virtual ~LayerSolver() = default;
  /// Returns the number of layers; they are numbered from 0.
  [[nodiscard]] virtual int layers() const = 0;
  /// Returns the joints at a coordinate of a layer, rad, continuous in the coordinate; none where
  /// the arm has none there.
  [[nodiscard]] virtual std::optional<Config> joints(int layer, double coordinate) const = 0;
  /// Returns the travel of a layer, m; it ascends.
  [[nodiscard]] virtual double travel(int layer) const = 0;
  /// Returns a coordinate of a layer for joints in between those of a layer before it, at
  /// coordinate x, and of one after it, at y. By default it is linear in the travel.
  [[nodiscard]] virtual double between(int layer, int before, double x, int after, double y) const {
    const double t = (travel(layer) - travel(before)) / (travel(after) - travel(before));
    return x + t * (y - x);
  }
};

}  // namespace swivel
