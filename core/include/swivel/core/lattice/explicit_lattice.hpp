// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "swivel/core/lattice/lattice.hpp"

namespace swivel {

/// A lattice whose nodes are given as a list for each layer, of any length. It serves arms whose
/// self-motion is no circle of arm angles. Any node may follow any node of the layer before, as far
/// as the bounds on joint steps allow.
class ExplicitLattice : public Lattice {
 public:
  struct Point {
    Config q;
    double phi = 0;  ///< redundancy coordinate, rad
    int branch = 0;  ///< 0..7, for reports
    std::array<int, 2> beside{
        /// The slots before and after the node along its curve of self-motion; -1: none.
        -1, -1};
    std::array<int, 2> along{
        /// The slots that continue the node in the layers before and after; -1: none.
        -1, -1};
  };
  /// Takes the nodes of each layer, in the order that settles ties. Each must reach the layer's
  /// tool pose within the limits; this is not checked. `circles`: joints whose moves are taken on
  /// the circle, as those of continuous joints are. Throws InputError for limits.step_error, which
  /// needs a closed form, and std::invalid_argument if the number of layers is not that of the
  /// path.
  ExplicitLattice(const Chain& chain, const ToolPath& path, const PathProblem& problem,
                  std::vector<std::vector<Point>> layers,
                  const std::array<bool, kDof>& circles = {});

  [[nodiscard]] const Point& point(int layer, int slot) const {
    return (*points_[static_cast<std::size_t>(layer)])[static_cast<std::size_t>(slot)];
  }
  [[nodiscard]] int slots(int layer) const override {
    return static_cast<int>(points_[static_cast<std::size_t>(layer)]->size());
  }
  [[nodiscard]] std::int64_t nodes() const override { return nodes_; }
  [[nodiscard]] std::optional<Config> node(int layer, int slot) const override {
    return point(layer, slot).q;
  }
  void layer_nodes(int layer, std::vector<Node>& out) const override;
  /// Nodes cost something if the chain's last joint is the roll and the roll has a cost.
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
  /// All nodes of a layer place the last link and the tool alike. Of any other body they share no
  /// pose.
  [[nodiscard]] bool shares_body_poses(unsigned groups) const override {
    return (groups & ~(1u << kDof)) == 0;
  }
  void slots_with_same_body_poses(int layer, int slot, unsigned groups,
                                  std::vector<int>& out) const override;
  [[nodiscard]] bool in_window(int, int, int) const override { return true; }
  void successors(int layer, int, std::vector<SlotRun>& out) const override {
    out.assign(1, {0, slots(layer + 1)});
  }

 protected:
  /// The nodes of each layer; lattices share those of layers that are alike.
  using Layers = std::vector<std::shared_ptr<const std::vector<Point>>>;
  ExplicitLattice(const Chain& chain, Knots knots, const PathProblem& problem, Layers layers,
                  const std::array<bool, kDof>& circles);
  [[nodiscard]] static Layers shared(std::vector<std::vector<Point>> layers);
  [[nodiscard]] const Layers& all_points() const { return points_; }

 private:
  [[nodiscard]] bool step_error_allowed(int, int, int) const override { return true; }

  Layers points_;
  std::int64_t nodes_ = 0;
};

}  // namespace swivel
