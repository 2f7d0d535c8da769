// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/eager/eager_validity.hpp"

#include <algorithm>

#include "eager/valid_nodes.hpp"
#include "swivel/core/base/timeline.hpp"

namespace swivel {

EagerValidity::EagerValidity(const Lattice& lattice, Validity& first, bool edges,
                             const Budget& budget)
    : first_(&first), valid_(static_cast<std::size_t>(lattice.layers())) {
  std::int64_t ik_nodes = 0, compared = 0;
  const ValidNodes all = find_valid_nodes(lattice, first, budget, ik_nodes);
  for (std::size_t layer = 0; layer < valid_.size(); ++layer) {
    valid_[layer].assign(static_cast<std::size_t>(lattice.slots(static_cast<int>(layer))), 0);
    for (const ValidNodes::Node& node : all.layers[layer])
      valid_[layer][static_cast<std::size_t>(node.slot)] = 1;
  }
  if (!edges || !first.asks_edges()) return;
  const TraceSpan span("all edges");
  edges_.resize(valid_.size());
  Successors successors(lattice);
  std::vector<EdgeQuestion> questions;
  std::vector<std::uint8_t> answers;
  for (int layer = 0; layer + 1 < lattice.layers(); ++layer) {
    budget.poll(Stage::kSearch, layer, lattice.layers());
    const auto i = static_cast<std::size_t>(layer);
    successors.enter(layer, all.layers[i + 1]);
    questions.clear();
    for (const ValidNodes::Node& a : all.layers[i])
      successors.for_each(a, compared, [&](int index, const Config&) {
        const ValidNodes::Node& b = all.layers[i + 1][static_cast<std::size_t>(index)];
        questions.push_back({layer, a.slot, b.slot, a.q, b.q});
      });
    answers.assign(questions.size(), 0);
    first.edges(questions, answers);
    for (std::size_t k = 0; k < questions.size(); ++k)
      if (answers[k] != 0) edges_[i].push_back(key(questions[k].a, questions[k].b));
    std::sort(edges_[i].begin(), edges_[i].end());
  }
}

void EagerValidity::nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) {
  for (std::size_t k = 0; k < questions.size(); ++k) {
    answers[k] = {};
    answers[k].valid = valid_[static_cast<std::size_t>(questions[k].layer)]
                             [static_cast<std::size_t>(questions[k].slot)] != 0;
  }
}

void EagerValidity::edges(std::span<const EdgeQuestion> questions,
                          std::span<std::uint8_t> answers) {
  if (edges_.empty()) return first_->edges(questions, answers);
  for (std::size_t k = 0; k < questions.size(); ++k) {
    const std::vector<std::uint64_t>& known = edges_[static_cast<std::size_t>(questions[k].layer)];
    answers[k] =
        std::binary_search(known.begin(), known.end(), key(questions[k].a, questions[k].b)) ? 1 : 0;
  }
}

}  // namespace swivel
