// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <tuple>
#include <vector>

#include "swivel/graph/cost_to_go.hpp"

namespace swivel {

/// Cost-to-go of a lattice whose layers list their nodes: every node of a layer against every node of the next, in vector code.
/// Layers are repaired backwards from the last removal for as long as values change. Memory: 64 bytes a node.
class ExplicitCostToGo final : public CostToGo {
 public:
  explicit ExplicitCostToGo(const Lattice& lattice, const Budget& budget = {});

  [[nodiscard]] const Lattice& lattice() const override { return *lattice_; }
  [[nodiscard]] double at(int layer, int slot) const override {
    return value_[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)];
  }
  [[nodiscard]] double best() const override;
  [[nodiscard]] int deepest_reachable() override;
  [[nodiscard]] Config config(int layer, int slot) override;
  void steps(int layer, int slot, double bound, std::vector<Step>& out) override;

 private:
  void compute(int goal_layer) override;
  void compute_removals() override;
  void save() override { saved_ = {goal_, value_}; }
  void restore() override { std::tie(goal_, value_) = saved_; }

  using Values = std::vector<double>;  // [slot]
  /// Least edge cost plus value over `others`, for every node of a layer; `step_layer` numbers the step between the two.
  void relax(int step_layer, int layer, int other_layer, const Values& others, Values& out);
  /// The same for one node, by plain loops over what is not removed. Neither counts what the node itself costs.
  [[nodiscard]] double relax_one(int layer, int slot);
  [[nodiscard]] double relax_one_forward(int layer, int slot, const Values& before);
  /// Values of a layer from those of the next, removals left out.
  void solve_layer(int layer, Values& out);
  [[nodiscard]] bool removed(int layer, int slot) const { return verdicts_.node(layer, slot) == Verdict::kRemoved; }

  const Lattice* lattice_;
  std::vector<std::array<Values, kDof>> joints_;  // [layer][joint][slot]
  std::vector<Values> value_;                     // [layer]
  std::tuple<int, std::vector<Values>> saved_;
};

}  // namespace swivel
