// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/lattice.hpp"
#include "swivel/graph/validity.hpp"

namespace swivel {

/// Every valid node of the lattice with its joints, layer by layer in slot order: what both eager planners start from.
struct ValidNodes {
  struct Node {
    int slot = 0;
    Config q;
  };
  std::vector<std::vector<Node>> layers;
};
/// Asks about every node that exists; adds to `ik_nodes` those that were solved. Throws Stopped.
[[nodiscard]] ValidNodes find_valid_nodes(const Lattice& lattice, Validity& validity, const Budget& budget, std::int64_t& ik_nodes);

/// Calls visit(index of b in next, delta) for every node of `next` in the window of `a`, all labels, whose joint steps are allowed.
template <class Visit>
void for_each_successor(const Lattice& lattice, int layer, const ValidNodes::Node& a, const std::vector<ValidNodes::Node>& next,
                        const std::vector<int>& index_of_slot, std::int64_t& compared, const Visit& visit) {
  const int n = lattice.angles();
  const Lattice::Run run = lattice.successors(layer, a.slot);
  for (int label = 0; label < lattice.labels(); ++label)
    for (int k = 0; k < run.count; ++k) {
      const int b = index_of_slot[static_cast<std::size_t>(label * n + (run.first + k) % n)];
      if (b < 0) continue;
      const Config delta = lattice.delta(a.q, next[static_cast<std::size_t>(b)].q);
      ++compared;
      if (lattice.step_allowed(layer, delta)) visit(b, delta);
    }
}
/// slot -> index in nodes, -1 where invalid.
[[nodiscard]] std::vector<int> index_by_slot(const Lattice& lattice, const std::vector<ValidNodes::Node>& nodes);

}  // namespace swivel
