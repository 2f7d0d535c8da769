// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/graph/verdicts/validity.hpp"
#include "validity/asked_hooks.hpp"

namespace swivel {

/// Applies the user's hooks after another validity: the check is called about what that one allows,
/// once for each batch. The cost of a node is the lattice's cost plus the user's.
class HookedValidity final : public Validity {
 public:
  /// Wraps the validity `first`. `lattice` and `first` must outlive it.
  HookedValidity(const Lattice& lattice, Validity& first, const Hooks& hooks, const Budget& budget)
      : lattice_(&lattice),
        first_(&first),
        check_(hooks.check, budget),
        cost_(hooks.cost, lattice, budget) {}

  void nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) override;
  void nodes_overlapped(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers,
                        const std::function<void()>& work) override;
  void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) override;
  [[nodiscard]] bool asks_edges() const override {
    return first_->asks_edges() || check_.checks_motions();
  }
  void costs(std::span<const NodeQuestion> questions, std::span<double> costs) override;
  [[nodiscard]] bool asks_costs() const override { return cost_ || lattice_->has_node_costs(); }

 private:
  void check_layers_between(std::span<const EdgeQuestion> questions,
                            std::span<std::uint8_t> answers);
  /// Returns the state that hooks are given for a node: its exact configuration
  /// (Lattice::exact_config) if it has one of its own, else its joints. The roll is counted as that
  /// of rows is.
  [[nodiscard]] Config state(int layer, int slot, const Config& node) const {
    TrajectoryRow row;
    row.q = lattice_->is_approximate() ? lattice_->exact_config(layer, slot, node).value_or(node)
                                       : node;
    const ToolPath& path = lattice_->path();
    return counted_from_waypoints(lattice_->chain(), path, path.layer(layer).travel, row).q;
  }

  const Lattice* lattice_;
  Validity* first_;
  AskedCheck check_;
  AskedCost cost_;
  std::vector<Config> states_;  // scratch
  std::vector<StateCheck::Motion> motions_;
};

}  // namespace swivel
