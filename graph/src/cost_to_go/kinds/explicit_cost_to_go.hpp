// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "cost_to_go/kernels/relax_task.hpp"
#include "cost_to_go/kinds/layer_values.hpp"

namespace swivel {

/// The cost-to-go of a lattice whose layers list their nodes: every node of a layer against every
/// node of the next, in vector code. Memory: 64 bytes a node.
class ExplicitCostToGo final : public LayerValues {
 public:
  explicit ExplicitCostToGo(const Lattice& lattice, Pruning pruning = Pruning::kNone,
                            const Budget& budget = {});

  [[nodiscard]] const Lattice& lattice() const override { return *lattice_; }
  [[nodiscard]] Config config(int layer, int slot) override;
  void steps(int layer, int slot, double bound, std::vector<Step>& out) override;

 private:
  /// The joints of some nodes, by joint.
  using Joints = std::array<Values, kDof>;

  void begin(int layer, Values& out) override {
    out.assign(static_cast<std::size_t>(lattice_->slots(layer)), 0.0);
  }
  void relax(int step, int layer, int other_layer, const Values& others, Values& out) override;
  /// Computes one node's cost-to-go by plain loops.
  [[nodiscard]] double relax_one(int layer, int slot) override;
  [[nodiscard]] double relax_one_forward(int layer, int slot, const Values& before) override;

  void find_stale(int layer, const std::vector<Change>& ahead, std::vector<int>& stale) override;
  [[nodiscard]] std::size_t many(int layer) const override;
  void relax_some(int layer, const std::vector<int>& slots, Values& out) override;
  /// Replaces `out` by the joints of some nodes of a layer.
  void gather(int layer, const std::vector<int>& slots, Joints& out);
  /// Lowers `out`, for nodes with joints `from` of the layer before `step`, to the least of edge
  /// cost plus value over nodes with joints `to`, whose values are `others`, and which lie in
  /// `blocks`, if given.
  void relax_between(int step, const Joints& from, const Joints& to, const RelaxBlocks* blocks,
                     const Values& others, Values& out);

  /// What the kernels read of the nodes of a layer.
  struct Nodes {
    Joints joints;
    RelaxBlocks blocks;
  };
  /// Returns those of a layer. They are gathered when they are first asked for.
  [[nodiscard]] const Nodes& nodes_of(int layer);
  [[nodiscard]] const Joints& joints_of(int layer) { return nodes_of(layer).joints; }
  void share_nodes(LayerValues& coarser, std::span<const int> layer_here) override;

  const Lattice* lattice_;
  std::vector<std::shared_ptr<const Nodes>> nodes_;  // [layer], null where none was asked for
  // What a repair works with, kept for the next one.
  Joints some_, reached_;
  Values changed_from_, least_, raised_, least_of_blocks_;
  std::vector<int> slots_;
  std::vector<Lattice::Node> listed_;
};

}  // namespace swivel
