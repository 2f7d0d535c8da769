// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/lattice_graph/implicit_lattice.hpp"

#include <algorithm>

namespace swivel {

BOOST_CONCEPT_ASSERT((boost::IncidenceGraphConcept<ImplicitLattice>));
BOOST_CONCEPT_ASSERT((boost::VertexListGraphConcept<ImplicitLattice>));
BOOST_CONCEPT_ASSERT((boost::ReadablePropertyMapConcept<ImplicitCostMap, ImplicitLattice::Edge>));

ImplicitLattice::ImplicitLattice(CostToGo& cost_to_go, double slack)
    : cost_to_go_(&cost_to_go), slack_(slack) {
  for (int layer = 0; layer < cost_to_go_->lattice().layers(); ++layer)
    width_ = std::max<std::int64_t>(width_, cost_to_go_->lattice().slots(layer));
}

const std::vector<ImplicitLattice::Edge>& ImplicitLattice::expand(Vertex v) const {
  edges_.clear();
  const double bound = cost_to_go(v) + slack_;
  const int layer = layer_of(v);
  if (layer >= cost_to_go_->goal_layer()) return edges_;
  cost_to_go_->steps(layer, slot_of(v), bound, steps_);
  for (const CostToGo::Step& step : steps_)
    edges_.push_back({v, vertex(layer + 1, step.slot), step.cost});
  return edges_;
}

}  // namespace swivel
