// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "swivel/core/base/config.hpp"

namespace swivel {

class ToolPath;

/// The layers of a tool's path at which a lattice has nodes: every one, or its *knots*. Copies
/// share what is never written.
class Knots {
 public:
  /// Takes every layer of a path, which must outlive the knots.
  explicit Knots(const ToolPath& path) : whole_(&path) {}
  /// Takes some layers of a path, in order, the first and the last among them. The path must
  /// outlive the knots.
  Knots(const ToolPath& whole, std::vector<int> layers);
  /// Returns whether every layer is taken, without saying so of each.
  [[nodiscard]] bool are_all() const { return layers_.empty(); }
  /// Returns the path from which the layers are taken.
  [[nodiscard]] const ToolPath& whole() const { return *whole_; }
  /// Returns the path that has these layers alone.
  [[nodiscard]] const ToolPath& path() const { return path_ ? *path_ : *whole_; }
  /// Returns the layers that are taken; none if are_all().
  [[nodiscard]] const std::vector<int>& layers() const { return layers_; }
  /// Returns the layer of whole() that the k-th knot is.
  [[nodiscard]] int layer(int k) const {
    return are_all() ? k : layers_[static_cast<std::size_t>(k)];
  }
  /// Returns knots with one more in the middle of each of some steps, given by the number of the
  /// knot at which they begin; steps without layers between are left out. Returns nothing if all
  /// are.
  [[nodiscard]] std::optional<Knots> halved(const std::set<int>& steps) const;
  /// Returns the steps of each halved() call that led to these knots, the first one first.
  [[nodiscard]] const std::vector<std::set<int>>& halvings() const { return halvings_; }
  /// Returns the largest move of each joint from knot to knot, rad: the sums of those of the path's
  /// steps, which are one for all steps or one for each.
  [[nodiscard]] std::vector<Config> bounds_between(const std::vector<Config>& of_steps) const;

 private:
  const ToolPath* whole_;
  std::vector<int> layers_;
  std::shared_ptr<const ToolPath> path_;  // null if are_all()
  std::vector<std::set<int>> halvings_;
};

/// Returns the layers of a path that are knots at most `length`, m of the path, and 0.2 rad of
/// rotation apart, spread evenly over each stretch between two that must be knots: the first and
/// the last layer, and those at which the path bends. With a length of 0 every layer is a knot.
[[nodiscard]] std::vector<int> knots_along(const ToolPath& path, double length);
/// Returns the layer of a path, between two others, that is nearest to the middle of the way
/// between them.
[[nodiscard]] int middle_layer(const ToolPath& path, int first, int last);

}  // namespace swivel
