// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/cost_to_go.hpp"

#include "explicit_cost_to_go.hpp"
#include "grid_cost_to_go.hpp"

namespace swivel {

void CostToGo::remove_edge(int layer, int a, int b) {
  verdicts_.remove_edge(layer, a, b, lattice().edge_cost(lattice().delta(config(layer, a), config(layer + 1, b))));
}

std::unique_ptr<CostToGo> make_cost_to_go(const Lattice& lattice, Extent extent, const Budget& budget) {
  if (const auto* grid = dynamic_cast<const SrsLattice*>(&lattice)) return std::make_unique<GridCostToGo>(*grid, extent, budget);
  return std::make_unique<ExplicitCostToGo>(lattice, budget);
}

}  // namespace swivel
