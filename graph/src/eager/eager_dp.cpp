// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <map>

#include "cost_to_go/best_start.hpp"
#include "eager/valid_nodes.hpp"
#include "swivel/graph/eager/eager.hpp"
#include "swivel/graph/search/closed_path.hpp"

namespace swivel {

namespace {

/// Asks about edges; of a closed lattice, which is swept again and again, about each only once.
class EdgeVerdicts {
 public:
  EdgeVerdicts(const Lattice& lattice, Validity& validity)
      : validity_(validity), remembers_(lattice.is_closed()) {}
  bool valid(int layer, const ValidNodes::Node& a, const ValidNodes::Node& b) {
    if (!validity_.asks_edges()) return true;
    const std::array<int, 3> edge{layer, a.slot, b.slot};
    if (remembers_)
      if (const auto found = known_.find(edge); found != known_.end()) return found->second;
    const EdgeQuestion question{layer, a.slot, b.slot, a.q, b.q};
    std::uint8_t answer = 0;
    validity_.edges({&question, 1}, {&answer, 1});
    if (remembers_) known_[edge] = answer != 0;
    return answer != 0;
  }

 private:
  Validity& validity_;
  bool remembers_;
  std::map<std::array<int, 3>, bool> known_;  // [layer, slots]
};

int deepest_layer(const Lattice& lattice, const ValidNodes& valid, EdgeVerdicts& verdicts,
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
          if (!ahead[k] && verdicts.valid(layer, valid.layers[i][a], next[k])) ahead[k] = 1;
        });
    }
    if (std::find(ahead.begin(), ahead.end(), 1) != ahead.end()) deepest = layer + 1;
    reached.swap(ahead);
  }
  return deepest;
}

/// The dynamic program: the least cost from the valid nodes of layer 0, and for each valid node the
/// index of its best successor, of several the first.
struct Swept {
  std::vector<double> value;
  std::vector<std::vector<int>> best;
};

/// Sweeps from the nodes of the last layer in a run of slots back to layer 0.
Swept sweep_back(const Lattice& lattice, const ValidNodes& valid, const Lattice::SlotRun& goals,
                 EdgeVerdicts& verdicts, const Budget& budget, std::int64_t& compared) {
  Swept swept;
  swept.best.resize(valid.layers.size());
  std::vector<double>& value = swept.value;
  const std::size_t last = valid.layers.size() - 1;
  for (std::size_t k = 0; k < valid.layers[last].size(); ++k) {
    const int slot = valid.layers[last][k].slot;
    value.push_back(slot >= goals.first && slot < goals.last ? valid.cost(last, k) : kUnreachable);
  }
  struct Candidate {
    double total;
    int b;
  };
  std::vector<Candidate> candidates;
  std::vector<double> here;
  Successors successors(lattice);
  for (int layer = lattice.layers() - 2; layer >= 0; --layer) {
    const auto i = static_cast<std::size_t>(layer);
    const auto& next = valid.layers[i + 1];
    successors.enter(layer, next);
    here.assign(valid.layers[i].size(), kUnreachable);
    swept.best[i].assign(valid.layers[i].size(), -1);
    for (std::size_t a = 0; a < valid.layers[i].size(); ++a) {
      if (a % 16 == 0) budget.poll();
      candidates.clear();
      successors.for_each(valid.layers[i][a], compared, [&](int b, const Config& delta) {
        const double rest = value[static_cast<std::size_t>(b)];
        if (rest != kUnreachable) candidates.push_back({lattice.edge_cost(delta) + rest, b});
      });
      std::sort(candidates.begin(), candidates.end(), [](const Candidate& x, const Candidate& y) {
        return x.total != y.total ? x.total < y.total : x.b < y.b;
      });
      for (const Candidate& candidate : candidates)
        if (verdicts.valid(layer, valid.layers[i][a],
                           next[static_cast<std::size_t>(candidate.b)])) {
          here[a] = valid.cost(i, a) + candidate.total;
          swept.best[i][a] = candidate.b;
          break;
        }
    }
    value.swap(here);
  }
  return swept;
}

/// Returns the best path from the k-th valid node of layer 0; an empty one for k = -1.
SearchOutcome path_from(int k, const ValidNodes& valid, const Swept& swept) {
  if (k < 0) return {};
  SearchOutcome found{{}, swept.value[static_cast<std::size_t>(k)]};
  for (std::size_t i = 0; i < valid.layers.size(); ++i) {
    found.path.push_back(valid.layers[i][static_cast<std::size_t>(k)].slot);
    if (i + 1 < valid.layers.size()) k = swept.best[i][static_cast<std::size_t>(k)];
  }
  return found;
}

/// Returns the index of the valid node of layer 0 in a run of slots from which the cheapest path
/// leads, the first of several; -1 where none does.
int cheapest_in(const Lattice::SlotRun& run, const ValidNodes& valid, const Swept& swept) {
  int best = -1;
  double least = kUnreachable;
  for (std::size_t k = 0; k < swept.value.size(); ++k) {
    const int slot = valid.layers[0][k].slot;
    if (slot >= run.first && slot < run.last && swept.value[k] < least)
      least = swept.value[k], best = static_cast<int>(k);
  }
  return best;
}

/// Returns the best path from the node at which the answer begins; an empty one where there is
/// none.
SearchOutcome best_open(const Lattice& lattice, const ValidNodes& valid, const Swept& swept) {
  const std::vector<double>& value = swept.value;
  const double least = value.empty() ? kUnreachable : *std::min_element(value.begin(), value.end());
  const int at = best_start(
      lattice, static_cast<int>(value.size()), least,
      [&](int k) { return value[static_cast<std::size_t>(k)]; },
      [&](int k) { return valid.layers[0][static_cast<std::size_t>(k)].q; });
  return path_from(at, valid, swept);
}

}  // namespace

void eager_dp(const Lattice& lattice, Validity& validity, const Budget& budget,
              EagerOutcome& outcome) {
  const ValidNodes valid = find_valid_nodes(lattice, validity, budget, outcome.ik_nodes);
  EdgeVerdicts verdicts(lattice, validity);
  const auto sweep = [&](const Lattice::SlotRun& goals) {
    return sweep_back(lattice, valid, goals, verdicts, budget, outcome.edges);
  };
  SearchOutcome found;
  if (lattice.is_closed())
    found = closed_path_first(lattice, budget, [&](const Lattice::SlotRun& run) {
      const Swept swept = sweep(run);
      return path_from(cheapest_in(run, valid, swept), valid, swept);
    });
  else
    found = best_open(lattice, valid, sweep({0, lattice.slots(lattice.layers() - 1)}));
  static_cast<SearchOutcome&>(outcome) = found;
  if (!found.path.empty()) return;
  try {
    outcome.deepest = deepest_layer(lattice, valid, verdicts, budget, outcome.edges);
  } catch (const Stopped&) {  // the fact that there is no path stays known
    outcome.deepest.reset();
  }
}

}  // namespace swivel
