// SPDX-License-Identifier: BSD-3-Clause
#include "eager/valid_nodes.hpp"

#include <algorithm>

#include "swivel/core/base/timeline.hpp"

namespace swivel {

ValidNodes find_valid_nodes(const Lattice& lattice, Validity& validity, const Budget& budget,
                            std::int64_t& ik_nodes) {
  const TraceSpan span("all nodes");
  ValidNodes valid;
  valid.layers.resize(static_cast<std::size_t>(lattice.layers()));
  if (validity.asks_costs()) valid.costs.resize(valid.layers.size());
  std::vector<Lattice::Node> nodes;
  std::vector<NodeQuestion> questions;
  std::vector<NodeAnswer> answers;
  for (int layer = 0; layer < lattice.layers(); ++layer) {
    budget.poll(Stage::kSearch, layer, lattice.layers());
    lattice.layer_nodes(layer, nodes);
    ik_nodes += lattice.slots(layer);
    questions.clear();
    for (const Lattice::Node& node : nodes) questions.push_back({layer, node.slot, node.q});
    answers.assign(questions.size(), {});
    validity.nodes(questions, answers);
    valid.layers[static_cast<std::size_t>(layer)].reserve(static_cast<std::size_t>(std::count_if(
        answers.begin(), answers.end(), [](const NodeAnswer& answer) { return answer.valid; })));
    for (std::size_t k = 0; k < questions.size(); ++k)
      if (answers[k].valid)
        valid.layers[static_cast<std::size_t>(layer)].push_back(
            {questions[k].slot, questions[k].q});
    if (valid.costs.empty()) continue;
    questions.clear();
    for (const ValidNodes::Node& node : valid.layers[static_cast<std::size_t>(layer)])
      questions.push_back({layer, node.slot, node.q});
    std::vector<double>& costs = valid.costs[static_cast<std::size_t>(layer)];
    costs.resize(questions.size());
    validity.costs(questions, costs);
  }
  return valid;
}

void Successors::enter(int layer, const std::vector<ValidNodes::Node>& next) {
  layer_ = layer;
  next_ = &next;
  index_of_slot_.assign(static_cast<std::size_t>(lattice_.slots(layer + 1)), -1);
  for (std::size_t k = 0; k < next.size(); ++k)
    index_of_slot_[static_cast<std::size_t>(next[k].slot)] = static_cast<int>(k);
}

}  // namespace swivel
