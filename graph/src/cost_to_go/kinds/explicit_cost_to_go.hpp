// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "cost_to_go/kinds/layer_values.hpp"

namespace swivel {

/// The cost-to-go of a lattice whose layers list their nodes: every node of a layer against every
/// node of the next, in vector code. Removals are repaired backwards from the last one, layer by
/// layer, for as long as values change. Memory: 64 bytes a node.
class ExplicitCostToGo final : public LayerValues {
 public:
  explicit ExplicitCostToGo(const Lattice& lattice, const Budget& budget = {});

  [[nodiscard]] const Lattice& lattice() const override { return *lattice_; }
  [[nodiscard]] Config config(int layer, int slot) override;
  void steps(int layer, int slot, double bound, std::vector<Step>& out) override;

 private:
  void compute_removals() override;
  void begin(int layer, Values& out) override {
    out.assign(static_cast<std::size_t>(lattice_->slots(layer)), 0.0);
  }
  void relax(int step, int layer, int other_layer, const Values& others, Values& out) override;
  /// Computes one node's cost-to-go by plain loops.
  [[nodiscard]] double relax_one(int layer, int slot) override;
  [[nodiscard]] double relax_one_forward(int layer, int slot, const Values& before) override;

  const Lattice* lattice_;
  std::vector<std::array<Values, kDof>> joints_;  // [layer][joint][slot]
};

}  // namespace swivel
