// SPDX-License-Identifier: BSD-3-Clause
#include "cost_to_go/grid/grid_cost_to_go.hpp"
#include "cost_to_go/kinds/explicit_cost_to_go.hpp"
#include "cost_to_go/kinds/knot_grid_cost_to_go.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {

std::unique_ptr<CostToGo> make_cost_to_go(const Lattice& lattice, Pruning pruning,
                                          const Budget& budget,
                                          std::unique_ptr<CostToGo> recycled) {
  if (const auto* grid = dynamic_cast<const SrsLattice*>(&lattice))
    return std::make_unique<GridCostToGo>(*grid, pruning, budget,
                                          dynamic_cast<GridCostToGo*>(recycled.get()));
  if (const auto* rolls = dynamic_cast<const KnotGrid*>(&lattice))
    return std::make_unique<KnotGridCostToGo>(*rolls, budget);
  return std::make_unique<ExplicitCostToGo>(lattice, pruning, budget);
}

}  // namespace swivel
