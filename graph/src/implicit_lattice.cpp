// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/implicit_lattice.hpp"

#include <algorithm>

namespace swivel {

BOOST_CONCEPT_ASSERT((boost::IncidenceGraphConcept<ImplicitLattice>));
BOOST_CONCEPT_ASSERT((boost::VertexListGraphConcept<ImplicitLattice>));
BOOST_CONCEPT_ASSERT((boost::ReadablePropertyMapConcept<ImplicitCostMap, ImplicitLattice::Edge>));

const std::vector<ImplicitLattice::Edge>& ImplicitLattice::expand(Vertex v) const {
  const Lattice& lattice = togo_->lattice();
  edges_.clear();
  const double bound = cost_to_go(v) + slack_;
  if (v == root()) {
    for (int slot = 0; slot < lattice.width(); ++slot)
      if (togo_->at(0, slot) != kUnreachable && togo_->at(0, slot) <= bound) edges_.push_back({v, vertex(0, slot), 0.0});
    return edges_;
  }
  const int layer = layer_of(v), slot = slot_of(v), n = lattice.angles();
  if (layer >= togo_->goal_layer()) return edges_;
  // A best path's vertices are expanded one after the other, each among the successors of the last.
  const int offset = (lattice.angle_of(slot) - solved_.run.first + n) % n;
  const bool known =
      solved_.layer == layer && solved_.elbow == lattice.elbow_of(lattice.label_of(slot)) && offset < solved_.run.count;
  const Config q =
      known ? solved_.nodes.nodes->config(lattice.label_of(slot), solved_.nodes.shift + offset) : togo_->config(layer, slot);
  const Lattice::Run run = lattice.successors(layer, slot);
  for (int elbow = 0; elbow < 2; ++elbow) {
    CostToGo::Nodes next;
    for (int label = 0; label < lattice.labels(); ++label)
      for (int k = 0; lattice.elbow_of(label) == elbow && k < run.count; ++k) {
        const int b = label * n + (run.first + k) % n;
        const double rest = togo_->at(layer + 1, b);
        if (rest == kUnreachable || rest > bound) continue;
        if (!next.nodes) {
          next = togo_->nodes(layer + 1, elbow, run.first, run.count, next_);
          solved_ = {layer + 1, elbow, run, next};
        }
        const Config delta = lattice.delta(q, next.nodes->config(label, next.shift + k));
        if (!lattice.step_allowed(layer, delta)) continue;
        const double cost = lattice.edge_cost(delta);
        if (cost + rest <= bound && togo_->edge_verdict(layer, slot, b) != Verdict::kRemoved)
          edges_.push_back({v, vertex(layer + 1, b), cost});
      }
  }
  return edges_;
}

}  // namespace swivel
