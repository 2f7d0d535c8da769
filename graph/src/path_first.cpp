// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/path_first.hpp"

#include <algorithm>
#include <numeric>

namespace swivel {

namespace {

/// Layers in the order in which they are worth asking about: where failures were found lately first, then along the path.
class FailFirst {
 public:
  explicit FailFirst(int layers) : score_(static_cast<std::size_t>(layers), 0.0) {}
  void failed(int layer) {
    // An obstacle blocks a stretch of layers, so its neighbours are suspects too.
    for (int i = std::max(0, layer - 2); i <= std::min(static_cast<int>(score_.size()) - 1, layer + 2); ++i)
      score_[static_cast<std::size_t>(i)] += i == layer ? 1.0 : 0.5;
  }
  void next_round() {
    for (double& score : score_) score *= 0.8;
  }
  template <class T>
  void order(std::vector<T>& questions) const {
    std::stable_sort(questions.begin(), questions.end(), [&](const T& a, const T& b) {
      return score_[static_cast<std::size_t>(a.layer)] > score_[static_cast<std::size_t>(b.layer)];
    });
  }

 private:
  std::vector<double> score_;
};

/// Asks batch by batch until one holds a failure; true when all are valid.
template <class Question, class Ask, class Keep, class Remove>
bool validate(std::vector<Question>& questions, int batch, const Validity& validity, const Ask& ask, const Keep& keep, const Remove& remove) {
  std::vector<std::uint8_t> answers;
  for (std::size_t first = 0; first < questions.size() && !validity.stopped(); first += static_cast<std::size_t>(batch)) {
    const std::size_t count = std::min(static_cast<std::size_t>(batch), questions.size() - first);
    answers.assign(count, 0);
    ask(std::span<const Question>(questions.data() + first, count), std::span<std::uint8_t>(answers));
    bool all = true;
    for (std::size_t k = 0; k < count; ++k) {
      const Question& question = questions[first + k];
      if (answers[k])
        keep(question);
      else
        remove(question);
      all = all && answers[k];
    }
    if (!all) return false;
  }
  return !validity.stopped();
}

}  // namespace

SearchOutcome path_first(CostToGo& togo, Validity& validity, const PathFirstOptions& options, SearchCounters& counters) {
  const Lattice& lattice = togo.lattice();
  FailFirst fail_first(lattice.layers());
  SearchOutcome outcome;
  LayerNodes scratch;
  for (;;) {
    if (validity.stopped()) {
      outcome.stopped = true;
      return outcome;
    }
    const SlotPath path = best_path(togo, counters.expansions);
    if (path.empty()) return outcome;
    ++counters.iterations;

    std::vector<Config> q(path.size());
    for (int i = 0; i < static_cast<int>(path.size()); ++i) {
      const int slot = path[static_cast<std::size_t>(i)];
      const CostToGo::Nodes nodes = togo.nodes(i, lattice.angle_of(slot), 1, scratch);
      q[static_cast<std::size_t>(i)] = nodes.nodes->config(lattice.label_of(slot), nodes.shift);
    }
    std::vector<NodeQuestion> nodes;
    for (int i = 0; i < static_cast<int>(path.size()); ++i)
      if (togo.node_verdict(i, path[static_cast<std::size_t>(i)]) == Verdict::kUnknown)
        nodes.push_back({i, path[static_cast<std::size_t>(i)], q[static_cast<std::size_t>(i)]});
    fail_first.next_round();
    fail_first.order(nodes);
    bool valid = validate(
        nodes, options.batch, validity, [&](auto questions, auto answers) { validity.nodes(questions, answers); },
        [&](const NodeQuestion& x) { togo.keep_node(x.layer, x.slot); },
        [&](const NodeQuestion& x) {
          togo.remove_node(x.layer, x.slot);
          fail_first.failed(x.layer);
        });
    if (valid && validity.asks_edges()) {
      std::vector<EdgeQuestion> edges;
      for (int i = 0; i + 1 < static_cast<int>(path.size()); ++i) {
        const auto k = static_cast<std::size_t>(i);
        if (togo.edge_verdict(i, path[k], path[k + 1]) == Verdict::kUnknown) edges.push_back({i, path[k], path[k + 1], q[k], q[k + 1]});
      }
      fail_first.order(edges);
      valid = validate(
          edges, options.batch, validity, [&](auto questions, auto answers) { validity.edges(questions, answers); },
          [&](const EdgeQuestion& x) { togo.keep_edge(x.layer, x.a, x.b); },
          [&](const EdgeQuestion& x) {
            togo.remove_edge(x.layer, x.a, x.b);
            fail_first.failed(x.layer);
          });
    }
    if (validity.stopped()) continue;
    if (valid) {
      outcome.path = path;
      outcome.cost = togo.best();
      return outcome;
    }
    togo.repair();
  }
}

std::optional<int> deepest_valid_layer(CostToGo& togo, Validity& validity, const PathFirstOptions& options, SearchCounters& counters) {
  for (;;) {
    const int optimistic = togo.deepest_reachable();
    if (optimistic < 0) return -1;
    togo.sweep(optimistic);
    const SearchOutcome outcome = path_first(togo, validity, options, counters);
    if (outcome.stopped) return std::nullopt;
    if (!outcome.path.empty()) return optimistic;
  }
}

}  // namespace swivel
