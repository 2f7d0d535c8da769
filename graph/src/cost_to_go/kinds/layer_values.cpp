// SPDX-License-Identifier: BSD-3-Clause
#include "cost_to_go/kinds/layer_values.hpp"

#include <algorithm>

#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

/// Returns true if removing one of these edges, to or from nodes with the values `others`, can have
/// changed a node's value.
bool gives(const std::vector<Verdicts::HalfEdge>& edges, const std::vector<double>& others,
           double value) {
  return std::any_of(edges.begin(), edges.end(), [&](const Verdicts::HalfEdge& edge) {
    return edge.cost + others[static_cast<std::size_t>(edge.other)] == value;
  });
}

}  // namespace

LayerValues::LayerValues(const Lattice& lattice, const Budget& budget) : CostToGo(lattice, budget) {
  for (int layer = 0; layer < lattice.layers(); ++layer)
    value_.emplace_back(static_cast<std::size_t>(lattice.slots(layer)), kUnreachable);
}

void LayerValues::leave_out_removed(int layer, Values& values) const {
  for (int slot = 0; slot < static_cast<int>(values.size()); ++slot)
    if (removed(layer, slot)) values[static_cast<std::size_t>(slot)] = kUnreachable;
}

void LayerValues::solve_layer(int layer, Values& out) {
  if (layer == goal_) {
    begin(layer, out);
    leave_out_removed(layer, out);
  } else {
    const Values& next = value_[static_cast<std::size_t>(layer) + 1];
    relax(layer, layer, layer + 1, next, out);
    leave_out_removed(layer, out);
    if (const auto* edges = verdicts_.removed_edges(layer))
      for (const auto& [a, heads] : edges->tails) {
        double& value = out[static_cast<std::size_t>(a)];
        if (value != kUnreachable && gives(heads, next, value)) value = relax_one(layer, a);
      }
  }
  if (const double* own = verdicts_.costs(layer))
    for (double& value : out) value += *own++;
}

void LayerValues::compute(int goal_layer) {
  const TraceSpan span("sweep");
  verdicts_.pending.clear();
  for (int layer = lattice().layers() - 1; layer > goal_layer; --layer) {
    Values& values = value_[static_cast<std::size_t>(layer)];
    std::fill(values.begin(), values.end(), kUnreachable);
  }
  for (int layer = goal_layer; layer >= 0; --layer) {
    budget_.poll(Stage::kSweep, goal_layer - layer, goal_layer);
    solve_layer(layer, value_[static_cast<std::size_t>(layer)]);
    if (layer < goal_layer) done_with(layer + 1);
  }
}

double LayerValues::best() const {
  const Values& first = value_.front();
  return first.empty() ? kUnreachable : *std::min_element(first.begin(), first.end());
}

int LayerValues::deepest_reachable() {
  const TraceSpan span("reach");
  Values before, here;
  for (int layer = 0;; ++layer) {
    budget_.poll();
    if (layer == 0) {
      begin(layer, here);
    } else {
      relax(layer - 1, layer, layer - 1, before, here);
      if (const auto* edges = verdicts_.removed_edges(layer - 1))
        for (const auto& [b, tails] : edges->heads) {
          double& value = here[static_cast<std::size_t>(b)];
          if (value != kUnreachable && gives(tails, before, value))
            value = relax_one_forward(layer, b, before);
        }
    }
    leave_out_removed(layer, here);
    if (std::all_of(here.begin(), here.end(), [](double value) { return value == kUnreachable; }))
      return layer - 1;
    if (layer + 1 == lattice().layers()) return layer;
    before.swap(here);
  }
}

}  // namespace swivel
