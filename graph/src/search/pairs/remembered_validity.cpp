// SPDX-License-Identifier: BSD-3-Clause
#include "search/pairs/remembered_validity.hpp"

#include <algorithm>

namespace swivel {

std::size_t RememberedValidity::EdgeHash::operator()(const Edge& edge) const {
  std::uint64_t h = static_cast<std::uint64_t>(key(edge.layer, edge.a)) * 0x9e3779b97f4a7c15ull +
                    static_cast<std::uint64_t>(edge.b);
  h = (h ^ (h >> 31)) * 0xbf58476d1ce4e5b9ull;
  return h ^ (h >> 29);
}

const NodeAnswer* RememberedValidity::known(const NodeQuestion& question) const {
  static const NodeAnswer kClear{.valid = true};
  const auto found = node_.find(key(question.layer, question.slot));
  if (found == node_.end()) return nullptr;
  const KnownNode& node = found->second;
  if (node.known) return &node.answer;
  return question.only_scene && node.clear && node.clear_of == question.suspected ? &kClear
                                                                                  : nullptr;
}

void RememberedValidity::note(int layer, int slot, const NodeAnswer& answer) {
  KnownNode& node = node_[key(layer, slot)];
  if (node.known) return;
  node.known = true;
  node.answer = answer;
  nodes_.emplace_back(layer, slot);
}

void RememberedValidity::note(const NodeQuestion& question, const NodeAnswer& answer) {
  if (answer.valid && question.only_scene) {
    KnownNode& node = node_[key(question.layer, question.slot)];
    node.clear = true;
    node.clear_of = question.suspected;
    return;
  }
  note(question.layer, question.slot, answer);
  if (answer.valid || !answer.shared) return;
  lattice_->slots_with_same_body_poses(question.layer, question.slot, answer.groups, same_poses_);
  for (const int slot : same_poses_) note(question.layer, slot, answer);
}

template <class Ask>
void RememberedValidity::ask_nodes(std::span<const NodeQuestion> questions,
                                   std::span<NodeAnswer> answers, const Ask& ask) {
  std::vector<NodeQuestion> open;
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < questions.size(); ++k) {
    if (const NodeAnswer* answer = known(questions[k])) {
      answers[k] = *answer;
    } else {
      open.push_back(questions[k]);
      places.push_back(k);
    }
  }
  nodes_asked_ += static_cast<std::int64_t>(open.size());
  std::vector<NodeAnswer> found(open.size());
  ask(std::span<const NodeQuestion>(open), std::span<NodeAnswer>(found));
  for (std::size_t k = 0; k < open.size(); ++k) {
    answers[places[k]] = found[k];
    note(open[k], found[k]);
  }
}

void RememberedValidity::nodes(std::span<const NodeQuestion> questions,
                               std::span<NodeAnswer> answers) {
  ask_nodes(questions, answers, [&](auto open, auto found) {
    if (!open.empty()) validity_->nodes(open, found);
  });
}

void RememberedValidity::nodes_overlapped(std::span<const NodeQuestion> questions,
                                          std::span<NodeAnswer> answers,
                                          const std::function<void()>& work) {
  ask_nodes(questions, answers, [&](auto open, auto found) {
    if (open.empty()) return work();
    validity_->nodes_overlapped(open, found, work);
  });
}

void RememberedValidity::note(const Edge& edge, bool valid) {
  if (edge_.emplace(edge, valid).second) edges_.push_back(edge);
}

void RememberedValidity::edges(std::span<const EdgeQuestion> questions,
                               std::span<std::uint8_t> answers) {
  std::vector<EdgeQuestion> open;
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < questions.size(); ++k) {
    const auto found = edge_.find({questions[k].layer, questions[k].a, questions[k].b});
    if (found != edge_.end()) {
      answers[k] = found->second;
    } else {
      open.push_back(questions[k]);
      places.push_back(k);
    }
  }
  if (open.empty()) return;
  edges_asked_ += static_cast<std::int64_t>(open.size());
  std::vector<std::uint8_t> found(open.size());
  validity_->edges(open, found);
  for (std::size_t k = 0; k < open.size(); ++k) {
    answers[places[k]] = found[k];
    note(Edge{open[k].layer, open[k].a, open[k].b}, found[k] != 0);
  }
}

void RememberedValidity::note(const Cost& cost) {
  if (cost_.emplace(key(cost.layer, cost.slot), cost.cost).second) costs_.push_back(cost);
}

void RememberedValidity::costs(std::span<const NodeQuestion> questions, std::span<double> costs) {
  std::vector<NodeQuestion> open;
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < questions.size(); ++k) {
    const auto found = cost_.find(key(questions[k].layer, questions[k].slot));
    if (found != cost_.end()) {
      costs[k] = found->second;
    } else {
      open.push_back(questions[k]);
      places.push_back(k);
    }
  }
  if (open.empty()) return;
  std::vector<double> found(open.size());
  validity_->costs(open, found);
  for (std::size_t k = 0; k < open.size(); ++k) {
    costs[places[k]] = found[k];
    note(Cost{open[k].layer, open[k].slot, found[k]});
  }
}

void RememberedValidity::take(const Verdicts& verdicts) {
  for (int layer = 0; layer < lattice_->layers(); ++layer) {
    const Verdict* const known = verdicts.nodes(layer, 0);
    // Most layers have nothing yet, of which a look at their bytes tells.
    const bool any = verdicts.costs(layer) != nullptr ||
                     std::any_of(known, known + lattice_->slots(layer),
                                 [](Verdict verdict) { return verdict != Verdict::kUnknown; });
    const int slots = any ? lattice_->slots(layer) : 0;
    for (int slot = 0; slot < slots; ++slot) {
      const Verdict verdict = verdicts.node(layer, slot);
      if (verdict != Verdict::kUnknown)
        note(layer, slot, NodeAnswer{.valid = verdict == Verdict::kValid});
      if (verdicts.knows_cost(layer, slot)) note(Cost{layer, slot, verdicts.cost(layer, slot)});
    }
    const auto* removed = verdicts.removed_edges(layer);
    if (!removed) continue;
    for (const auto& [a, edges] : removed->tails)
      for (const Verdicts::HalfEdge& edge : edges) note(Edge{layer, a, edge.other}, false);
  }
}

void RememberedValidity::write(CostToGo& cost_to_go, Written& written) const {
  Verdicts& verdicts = cost_to_go.verdicts();
  for (; written.nodes < nodes_.size(); ++written.nodes) {
    const auto [layer, slot] = nodes_[written.nodes];
    if (verdicts.node(layer, slot) == Verdict::kRemoved) continue;
    if (node_.at(key(layer, slot)).answer.valid)
      verdicts.keep_node(layer, slot);
    else
      verdicts.remove_node(layer, slot);
  }
  for (; written.edges < edges_.size(); ++written.edges) {
    const Edge& edge = edges_[written.edges];
    if (verdicts.edge(edge.layer, edge.a, edge.b) != Verdict::kUnknown) continue;
    if (edge_.at(edge))
      verdicts.keep_edge(edge.layer, edge.a, edge.b);
    else
      cost_to_go.remove_edge(edge.layer, edge.a, edge.b);
  }
  for (; written.costs < costs_.size(); ++written.costs) {
    const Cost& cost = costs_[written.costs];
    if (!verdicts.knows_cost(cost.layer, cost.slot))
      verdicts.set_cost(cost.layer, cost.slot, cost.cost);
  }
}

void RememberedValidity::write(Verdicts& verdicts) const {
  for (const auto& [layer, slot] : nodes_) {
    if (node_.at(key(layer, slot)).answer.valid)
      verdicts.keep_node(layer, slot);
    else
      verdicts.remove_node(layer, slot);
  }
}

}  // namespace swivel
