// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// The joints of a path as a function of one coordinate in each layer: what smooth optimisation knows of an arm.
class LayerSolver {
 public:
  virtual ~LayerSolver() = default;
  /// Layers, numbered from 0.
  [[nodiscard]] virtual int layers() const = 0;
  /// Joints at a coordinate of a layer, continuous in it; none where there are none. rad.
  [[nodiscard]] virtual std::optional<Config> joints(int layer, double coordinate) const = 0;
  /// Of a layer, ascending; m.
  [[nodiscard]] virtual double travel(int layer) const = 0;
  /// A coordinate of a layer for joints in between those of a layer before it, at x, and of one after it, at y.
  [[nodiscard]] virtual double between(int layer, int before, double x, int after, double y) const {
    const double t = (travel(layer) - travel(before)) / (travel(after) - travel(before));
    return x + t * (y - x);
  }
};

}  // namespace swivel
