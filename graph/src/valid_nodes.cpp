// SPDX-License-Identifier: BSD-3-Clause
#include "valid_nodes.hpp"
#include "swivel/core/timeline.hpp"

namespace swivel {

ValidNodes find_valid_nodes(const Lattice& lattice, Validity& validity, const Budget& budget, std::int64_t& ik_nodes) {
  const Span span("all nodes");
  ValidNodes valid;
  valid.layers.resize(static_cast<std::size_t>(lattice.layers()));
  LayerNodes nodes;
  std::vector<NodeQuestion> questions;
  std::vector<NodeAnswer> answers;
  for (int layer = 0; layer < lattice.layers(); ++layer) {
    budget.poll();
    lattice.solve(layer, nodes);
    ik_nodes += lattice.width();
    questions.clear();
    for (int slot = 0; slot < lattice.width(); ++slot)
      if (nodes.valid(lattice.label_of(slot), lattice.angle_of(slot)))
        questions.push_back({layer, slot, nodes.config(lattice.label_of(slot), lattice.angle_of(slot))});
    answers.assign(questions.size(), {});
    validity.nodes(questions, answers);
    for (std::size_t k = 0; k < questions.size(); ++k)
      if (answers[k].valid) valid.layers[static_cast<std::size_t>(layer)].push_back({questions[k].slot, questions[k].q});
  }
  return valid;
}

std::vector<int> index_by_slot(const Lattice& lattice, const std::vector<ValidNodes::Node>& nodes) {
  std::vector<int> index(static_cast<std::size_t>(lattice.width()), -1);
  for (std::size_t k = 0; k < nodes.size(); ++k) index[static_cast<std::size_t>(nodes[k].slot)] = static_cast<int>(k);
  return index;
}

}  // namespace swivel
