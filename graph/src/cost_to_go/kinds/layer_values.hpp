// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <tuple>
#include <vector>

#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {

/// A cost-to-go that keeps the values of all nodes, a list for each layer: what lattices that list their nodes and grids of rolls
/// have in common. How the nodes of a layer meet those of its neighbours is left to the classes derived from it.
class LayerValues : public CostToGo {
 public:
  [[nodiscard]] double at(int layer, int slot) const override {
    return value_[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)];
  }
  [[nodiscard]] double best() const override;
  [[nodiscard]] int deepest_reachable() override;

 protected:
  using Values = std::vector<double>;  // [slot]
  LayerValues(const Lattice& lattice, const Budget& budget);

  /// Replaces `out` by 0 for every node of a layer that exists, infinite elsewhere.
  virtual void begin(int layer, Values& out) = 0;
  /// Replaces `out` by the least edge cost plus value over `others`, for every node of a layer; `step` numbers the step between the
  /// two. Neither removals nor what nodes themselves cost count.
  virtual void relax(int step, int layer, int other_layer, const Values& others, Values& out) = 0;
  /// The same for one node over what is not removed: of the next layer, at(); of the one before.
  [[nodiscard]] virtual double relax_one(int layer, int slot) = 0;
  [[nodiscard]] virtual double relax_one_forward(int layer, int slot, const Values& before) = 0;
  /// What has been solved of a layer is not wanted again soon.
  virtual void done_with(int layer) { static_cast<void>(layer); }

  /// Values of a layer from those of the next, over what is not removed.
  void solve_layer(int layer, Values& out);
  [[nodiscard]] bool removed(int layer, int slot) const { return verdicts_.node(layer, slot) == Verdict::kRemoved; }

  std::vector<Values> value_;  // [layer]

 private:
  void compute(int goal_layer) final;
  void save() final { saved_ = {goal_, value_}; }
  void restore() final { std::tie(goal_, value_) = saved_; }
  void leave_out_removed(int layer, Values& values) const;

  std::tuple<int, std::vector<Values>> saved_;
};

}  // namespace swivel
