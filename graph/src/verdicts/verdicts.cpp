// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/verdicts/verdicts.hpp"

#include <algorithm>
#include <iterator>

namespace swivel {

Verdicts::Verdicts(const Lattice& lattice) : lattice_(&lattice) {
  first_.reserve(static_cast<std::size_t>(lattice.layers()));
  std::size_t nodes = 0;
  for (int layer = 0; layer < lattice.layers(); ++layer) {
    first_.push_back(nodes);
    nodes += static_cast<std::size_t>(lattice.slots(layer));
  }
  node_ = ZeroedArray<Verdict>(nodes);
  begin_costs();
}

void Verdicts::begin_costs() {
  costs_.clear();
  if (!lattice_->has_node_costs()) return;
  for (int layer = 0; layer < lattice_->layers(); ++layer) {
    std::vector<double>& costs =
        costs_.emplace_back(static_cast<std::size_t>(lattice_->slots(layer)));
    for (int slot = 0; slot < lattice_->slots(layer); ++slot)
      costs[static_cast<std::size_t>(slot)] = lattice_->node_cost(layer, slot);
  }
}

void Verdicts::clear() {
  for (const std::size_t node : known_) node_[node] = Verdict::kUnknown;
  known_.clear();
  begin_costs();
  cost_known_.clear();
  set_last_.clear();
  exit_costs_.clear();
  edge_.clear();
  removed_edges_.clear();
  pending.clear();
  removed_ = 0;
  costs_changed_ = false;
}

Verdicts::Removals Verdicts::removals() const {
  Removals all;
  std::vector<std::size_t> removed;
  std::copy_if(known_.begin(), known_.end(), std::back_inserter(removed),
               [&](std::size_t node) { return node_[node] == Verdict::kRemoved; });
  std::sort(removed.begin(), removed.end());
  // A node that was valid first is listed twice.
  removed.erase(std::unique(removed.begin(), removed.end()), removed.end());
  std::size_t layer = 0;
  for (const std::size_t node : removed) {
    while (layer + 1 < first_.size() && first_[layer + 1] <= node) ++layer;
    all.nodes[static_cast<int>(layer)].push_back(static_cast<int>(node - first_[layer]));
  }
  for (const auto& [at, edges] : removed_edges_) {
    auto& slots = all.edges[at];
    for (const auto& [a, heads] : edges.tails)
      for (const HalfEdge& edge : heads) slots.emplace_back(a, edge.other);
    std::sort(slots.begin(), slots.end());
  }
  return all;
}

void Verdicts::keep_node(int layer, int slot) {
  const std::size_t node = index(layer, slot);
  node_[node] = Verdict::kValid;
  known_.push_back(node);
}

void Verdicts::remove_nodes(int layer, std::span<const int> slots) {
  Pending* news = nullptr;
  for (const int slot : slots) {
    const std::size_t node = index(layer, slot);
    if (node_[node] == Verdict::kRemoved) continue;
    node_[node] = Verdict::kRemoved;
    known_.push_back(node);
    ++removed_;
    if (!news) {
      constexpr std::size_t kUsual = 32;  // most layers that lose one node lose more
      news = &pending[layer];
      if (news->nodes.empty()) news->nodes.reserve(kUsual);
    }
    news->nodes.push_back(slot);
  }
}

Verdict Verdicts::edge(int layer, int a, int b) const {
  if (edge_.empty()) return Verdict::kUnknown;
  const auto found = edge_.find({index(layer, a), b});
  return found == edge_.end() ? Verdict::kUnknown : found->second;
}

void Verdicts::keep_edge(int layer, int a, int b) {
  edge_[{index(layer, a), b}] = Verdict::kValid;
}

void Verdicts::remove_edge(int layer, int a, int b, double cost) {
  edge_[{index(layer, a), b}] = Verdict::kRemoved;
  ++removed_;
  removed_edges_[layer].tails[a].push_back({b, cost});
  removed_edges_[layer].heads[b].push_back({a, cost});
  pending[layer].tails.push_back(a);
}

void Verdicts::take(const Verdicts& others, std::span<const int> layer_here) {
  const auto next_to = [&](std::size_t k) {
    return k + 1 < layer_here.size() && layer_here[k + 1] == layer_here[k] + 1;
  };
  std::vector<int> removed;
  for (std::size_t k = 0; k < layer_here.size(); ++k) {
    const int layer = static_cast<int>(k), here = layer_here[k];
    removed.clear();
    for (int slot = 0; slot < lattice_->slots(here); ++slot) {
      const Verdict known = others.node(layer, slot);
      if (known == Verdict::kValid) keep_node(here, slot);
      if (known == Verdict::kRemoved) removed.push_back(slot);
    }
    remove_nodes(here, removed);
    const RemovedEdges* const edges = next_to(k) ? others.removed_edges(layer) : nullptr;
    if (!edges) continue;
    for (const auto& [a, heads] : edges->tails)
      for (const HalfEdge& edge : heads)
        remove_edge(here, a, edge.other,
                    lattice_->edge_cost(lattice_->delta(*lattice_->node(here, a),
                                                        *lattice_->node(here + 1, edge.other))));
  }
  for (const auto& [edge, verdict] : others.edge_) {
    if (verdict != Verdict::kValid) continue;
    const auto k = static_cast<std::size_t>(
        std::upper_bound(others.first_.begin(), others.first_.end(), edge.node) -
        others.first_.begin() - 1);
    if (next_to(k))
      keep_edge(layer_here[k], static_cast<int>(edge.node - others.first_[k]), edge.b);
  }
}

std::vector<double>& Verdicts::costs_of(int layer) {
  const auto at = static_cast<std::size_t>(layer);
  costs_.resize(first_.size());
  if (costs_[at].empty())
    costs_[at].resize((at + 1 < first_.size() ? first_[at + 1] : node_.size()) - first_[at]);
  return costs_[at];
}

void Verdicts::set_cost(int layer, int slot, double cost) {
  costs_changed_ = true;
  if (cost_known_.empty()) cost_known_.resize(node_.size());
  cost_known_[index(layer, slot)] = 1;
  if (static_cast<std::size_t>(layer) + 1 == first_.size()) {
    set_last_[slot] = cost;
    cost += exit_cost(slot);
  }
  const double before = this->cost(layer, slot);
  if (cost == before) return;
  costs_of(layer)[static_cast<std::size_t>(slot)] = cost;
  pending[layer].raised.push_back({slot, cost - before});
}

void Verdicts::raise_exit_costs(std::span<const double> costs) {
  costs_changed_ = true;
  if (exit_costs_.empty()) exit_costs_.resize(costs.size());
  const int last = static_cast<int>(first_.size()) - 1;
  std::vector<double>* all = nullptr;
  std::vector<Pending::Raise>* raised = nullptr;
  for (std::size_t slot = 0; slot < costs.size(); ++slot) {
    const double by = costs[slot] - exit_costs_[slot];
    if (!(by > 0)) continue;
    if (!all) all = &costs_of(last), raised = &pending[last].raised;
    (*all)[slot] += by;
    exit_costs_[slot] = costs[slot];
    raised->push_back({static_cast<int>(slot), by});
  }
}

void Verdicts::forget_exit_costs() {
  if (exit_costs_.empty()) return;
  const int last = static_cast<int>(first_.size()) - 1;
  std::vector<double>& costs = costs_of(last);
  for (std::size_t slot = 0; slot < costs.size(); ++slot)
    costs[slot] =
        lattice_->has_node_costs() ? lattice_->node_cost(last, static_cast<int>(slot)) : 0.0;
  for (const auto& [slot, cost] : set_last_) costs[static_cast<std::size_t>(slot)] = cost;
  exit_costs_.clear();
  pending.erase(last);
}

const Verdicts::RemovedEdges* Verdicts::removed_edges(int layer) const {
  const auto found = removed_edges_.find(layer);
  return found == removed_edges_.end() ? nullptr : &found->second;
}

}  // namespace swivel
