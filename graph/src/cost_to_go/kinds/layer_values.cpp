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

bool LayerValues::lost_best_edge(int layer, int slot, double value) const {
  const auto* edges = verdicts_.removed_edges(layer);
  if (edges == nullptr || value == kUnreachable) return false;
  const auto heads = edges->tails.find(slot);
  return heads != edges->tails.end() &&
         gives(heads->second, value_[static_cast<std::size_t>(layer) + 1], value);
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

void LayerValues::renew_layer(int layer, std::vector<Change>& changed) {
  Values& values = value_[static_cast<std::size_t>(layer)];
  const Values before = values;
  solve_layer(layer, values);
  for (std::size_t slot = 0; slot < values.size(); ++slot)
    if (values[slot] != before[slot]) changed.push_back({static_cast<int>(slot), before[slot]});
}

void LayerValues::relax_some(int layer, const std::vector<int>& slots, Values& out) {
  out.clear();
  for (std::size_t k = 0; k < slots.size(); ++k) {
    if (k % 64 == 0) budget_.poll();
    out.push_back(relax_one(layer, slots[k]));
  }
}

void LayerValues::renew_nodes(int layer, std::vector<int>& stale, std::vector<Change>& changed) {
  Values& values = value_[static_cast<std::size_t>(layer)];
  const double* own = verdicts_.costs(layer);
  std::erase_if(stale, [&](int a) { return values[static_cast<std::size_t>(a)] == kUnreachable; });
  if (stale.empty()) return;
  if (layer == goal_)
    fresh_.assign(stale.size(), 0.0);
  else
    relax_some(layer, stale, fresh_);
  for (std::size_t k = 0; k < stale.size(); ++k) {
    const int slot = stale[k];
    double& value = values[static_cast<std::size_t>(slot)];
    double fresh = removed(layer, slot) ? kUnreachable : fresh_[k];
    if (own) fresh += own[slot];
    if (fresh == value) continue;
    changed.push_back({slot, value});
    value = fresh;
  }
}

void LayerValues::compute_removals() {
  const TraceSpan span("repair");
  std::vector<Change> changed, ahead;  // in this layer, in the next one to repair
  std::vector<int> stale;
  for (int layer = goal_; layer >= 0 && (!ahead.empty() || !verdicts_.pending.empty()); --layer) {
    budget_.poll();
    stale.clear();
    changed.clear();
    if (const auto found = verdicts_.pending.find(layer); found != verdicts_.pending.end()) {
      for (const auto* slots : {&found->second.nodes, &found->second.tails})
        stale.insert(stale.end(), slots->begin(), slots->end());
      for (const auto& raise : found->second.raised) stale.push_back(raise.slot);
      verdicts_.pending.erase(found);
    }
    if (ahead.size() + stale.size() > many(layer)) {
      renew_layer(layer, changed);
    } else {
      find_stale(layer, ahead, stale);
      std::sort(stale.begin(), stale.end());
      stale.erase(std::unique(stale.begin(), stale.end()), stale.end());
      renew_nodes(layer, stale, changed);
    }
    ahead.swap(changed);
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
