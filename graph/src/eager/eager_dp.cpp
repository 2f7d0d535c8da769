// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "cost_to_go/best_start.hpp"
#include "eager/valid_nodes.hpp"
#include "swivel/graph/eager/eager.hpp"

namespace swivel {

namespace {

bool edge_valid(Validity& validity, int layer, const ValidNodes::Node& a,
                const ValidNodes::Node& b) {
  if (!validity.asks_edges()) return true;
  const EdgeQuestion question{layer, a.slot, b.slot, a.q, b.q};
  std::uint8_t answer = 0;
  validity.edges({&question, 1}, {&answer, 1});
  return answer != 0;
}

int deepest_layer(const Lattice& lattice, const ValidNodes& valid, Validity& validity,
                  const Budget& budget, std::int64_t& compared) {
  std::vector<char> reached(valid.layers[0].size(), 1);
  int deepest = valid.layers[0].empty() ? -1 : 0;
  Successors successors(lattice);
  for (int layer = 0; layer + 1 < lattice.layers() && deepest == layer; ++layer) {
    const auto i = static_cast<std::size_t>(layer);
    const auto& next = valid.layers[i + 1];
    successors.enter(layer, next);
    std::vector<char> ahead(next.size(), 0);
    for (std::size_t a = 0; a < reached.size(); ++a) {
      if (a % 16 == 0) budget.poll();
      if (reached[a])
        successors.for_each(valid.layers[i][a], compared, [&](int b, const Config&) {
          const auto k = static_cast<std::size_t>(b);
          if (!ahead[k] && edge_valid(validity, layer, valid.layers[i][a], next[k])) ahead[k] = 1;
        });
    }
    if (std::find(ahead.begin(), ahead.end(), 1) != ahead.end()) deepest = layer + 1;
    reached.swap(ahead);
  }
  return deepest;
}

}  // namespace

void eager_dp(const Lattice& lattice, Validity& validity, const Budget& budget,
              EagerOutcome& outcome) {
  const ValidNodes valid = find_valid_nodes(lattice, validity, budget, outcome.ik_nodes);
  // best[layer][node] = index of the best successor; smallest slot among equals.
  std::vector<std::vector<int>> best(valid.layers.size());
  std::vector<double> value(valid.layers.back().size(), 0.0), here;
  if (!valid.costs.empty()) value = valid.costs.back();
  struct Candidate {
    double total;
    int b;
  };
  std::vector<Candidate> candidates;
  Successors successors(lattice);
  for (int layer = lattice.layers() - 2; layer >= 0; --layer) {
    const auto i = static_cast<std::size_t>(layer);
    const auto& next = valid.layers[i + 1];
    successors.enter(layer, next);
    here.assign(valid.layers[i].size(), kUnreachable);
    best[i].assign(valid.layers[i].size(), -1);
    for (std::size_t a = 0; a < valid.layers[i].size(); ++a) {
      if (a % 16 == 0) budget.poll();
      candidates.clear();
      successors.for_each(valid.layers[i][a], outcome.edges, [&](int b, const Config& delta) {
        const double rest = value[static_cast<std::size_t>(b)];
        if (rest != kUnreachable) candidates.push_back({lattice.edge_cost(delta) + rest, b});
      });
      std::sort(candidates.begin(), candidates.end(), [](const Candidate& x, const Candidate& y) {
        return x.total != y.total ? x.total < y.total : x.b < y.b;
      });
      for (const Candidate& candidate : candidates)
        if (edge_valid(validity, layer, valid.layers[i][a],
                       next[static_cast<std::size_t>(candidate.b)])) {
          here[a] = valid.cost(i, a) + candidate.total;
          best[i][a] = candidate.b;
          break;
        }
    }
    value.swap(here);
  }
  const double least = value.empty() ? kUnreachable : *std::min_element(value.begin(), value.end());
  int at = best_start(
      lattice, static_cast<int>(value.size()), least,
      [&](int k) { return value[static_cast<std::size_t>(k)]; },
      [&](int k) { return valid.layers[0][static_cast<std::size_t>(k)].q; });
  if (at < 0) {
    try {
      outcome.deepest = deepest_layer(lattice, valid, validity, budget, outcome.edges);
    } catch (const Stopped&) {  // the fact that there is no path stays known
      outcome.deepest.reset();
    }
    return;
  }
  outcome.cost = value[static_cast<std::size_t>(at)];
  for (std::size_t i = 0; i < valid.layers.size(); ++i) {
    outcome.path.push_back(valid.layers[i][static_cast<std::size_t>(at)].slot);
    if (i + 1 < valid.layers.size()) at = best[i][static_cast<std::size_t>(at)];
  }
}

}  // namespace swivel
