// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/verdicts/validity.hpp"

namespace swivel {

/// Every valid node of a lattice with its joints, layer by layer in slot order: what both eager
/// planners start from.
struct ValidNodes {
  using Node = Lattice::Node;
  std::vector<std::vector<Node>> layers;
  /// What the nodes themselves cost; empty where none costs anything.
  std::vector<std::vector<double>> costs;
  /// Returns what the k-th valid node of a layer costs.
  [[nodiscard]] double cost(std::size_t layer, std::size_t k) const {
    return costs.empty() ? 0.0 : costs[layer][k];
  }
};
/// Returns the valid nodes of a lattice: it asks about every node that exists. Adds to `ik_nodes`
/// those whose IK was solved. Throws Stopped.
[[nodiscard]] ValidNodes find_valid_nodes(const Lattice& lattice, Validity& validity,
                                          const Budget& budget, std::int64_t& ik_nodes);

/// Finds the successors of nodes among the valid nodes of the next layer, one layer after the
/// other.
class Successors {
 public:
  explicit Successors(const Lattice& lattice) : lattice_(lattice) {}
  /// Goes to a layer. `next` holds the valid nodes of the layer after it and must live until the
  /// next call.
  void enter(int layer, const std::vector<ValidNodes::Node>& next);
  /// Calls visit(index of b in next, delta) for every node b in the window of `a` whose joint steps
  /// are allowed. Adds the nodes compared to `compared`.
  template <class Visit>
  void for_each(const ValidNodes::Node& a, std::int64_t& compared, const Visit& visit) {
    lattice_.successors(layer_, a.slot, runs_);
    for (const auto& [first, last] : runs_)
      for (int slot = first; slot < last; ++slot) {
        const int b = index_of_slot_[static_cast<std::size_t>(slot)];
        if (b < 0) continue;
        const Config delta = lattice_.delta(a.q, (*next_)[static_cast<std::size_t>(b)].q);
        ++compared;
        if (lattice_.step_allowed(layer_, delta)) visit(b, delta);
      }
  }

 private:
  const Lattice& lattice_;
  int layer_ = 0;
  const std::vector<ValidNodes::Node>* next_ = nullptr;
  std::vector<int> index_of_slot_;  // -1 where invalid
  std::vector<Lattice::SlotRun> runs_;
};
}  // namespace swivel
