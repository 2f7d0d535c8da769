// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/lattice/lattice.hpp"

namespace swivel {

/// A lattice whose nodes are listed, any number a layer: of arms whose self-motion is no circle of
/// arm angles. Any node may follow any node of the layer before, as far as the joints' steps allow.
class ExplicitLattice : public Lattice {
 public:
  struct Point {
    Config q;
    double phi = 0;  ///< redundancy coordinate, rad
    int branch = 0;  ///< 0..7, for reports
    std::array<int, 2> beside{
        -1, -1};  ///< slots before and after it along its curve of self-motion, -1: none
    std::array<int, 2> along{
        -1, -1};  ///< slots that continue it in the layer before and after, -1: none
  };
  /// Nodes by layer, in the order that settles ties; all must reach the layer's tool pose within
  /// the limits. Throws InputError for limits.step_error, which needs a closed form, and
  /// std::invalid_argument where the layers are not those of the path. `circles`: joints whose
  /// moves are taken on the circle besides the continuous ones.
  ExplicitLattice(const Chain& chain, const ToolPath& path, const Problem& problem,
                  std::vector<std::vector<Point>> layers,
                  const std::array<bool, kDof>& circles = {});

  [[nodiscard]] const Point& point(int layer, int slot) const {
    return points_[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)];
  }
  [[nodiscard]] int slots(int layer) const override {
    return static_cast<int>(points_[static_cast<std::size_t>(layer)].size());
  }
  [[nodiscard]] std::int64_t nodes() const override { return nodes_; }
  [[nodiscard]] std::optional<Config> node(int layer, int slot) const override {
    return point(layer, slot).q;
  }
  void layer_nodes(int layer, std::vector<Node>& out) const override;
  /// Those of the roll, where it is the last joint.
  [[nodiscard]] bool has_node_costs() const override { return chain_->roll && cost_.roll > 0; }
  [[nodiscard]] double node_cost(int layer, int slot) const override {
    return has_node_costs() ? roll_cost(layer, point(layer, slot).q[kDof - 1]) : 0;
  }
  [[nodiscard]] NodeFault fault(int, int) const override { return {}; }
  [[nodiscard]] double phi(int layer, int slot) const override { return point(layer, slot).phi; }
  [[nodiscard]] int branch(int layer, int slot) const override { return point(layer, slot).branch; }
  [[nodiscard]] int neighbour_in_redundancy(int layer, int slot, int by) const override {
    return point(layer, slot).beside[by < 0 ? 0 : 1];
  }
  [[nodiscard]] int neighbour_along_path(int layer, int slot, int by) const override {
    return point(layer, slot).along[by < 0 ? 0 : 1];
  }
  /// The last link and the tool stand where the layer puts them; any other body stands alone.
  [[nodiscard]] bool shares_body_poses(unsigned groups) const override {
    return (groups & ~(1u << kDof)) == 0;
  }
  void slots_with_same_body_poses(int layer, int slot, unsigned groups,
                                  std::vector<int>& out) const override;
  [[nodiscard]] bool in_window(int, int, int) const override { return true; }
  void successors(int layer, int, std::vector<SlotRun>& out) const override {
    out.assign(1, {0, slots(layer + 1)});
  }

 private:
  [[nodiscard]] bool step_error_allowed(int, int, int) const override { return true; }

  std::vector<std::vector<Point>> points_;
  std::int64_t nodes_ = 0;
};

}  // namespace swivel
