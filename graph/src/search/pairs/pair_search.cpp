// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/search/pair_search.hpp"

#include <algorithm>
#include <stdexcept>

#include "search/pairs/known_between.hpp"
#include "search/pairs/product_search.hpp"
#include "search/pairs/region_branching.hpp"
#include "search/pairs/searched_arm.hpp"

namespace swivel {

namespace {

class PairSearch {
 public:
  PairSearch(const std::array<PairArm, 2>& arms, Between& between, const PairSearchOptions& options,
             PairOutcome& outcome)
      : options_(options),
        outcome_(outcome),
        arms_{SearchedArm(arms[0], options.paths), SearchedArm(arms[1], options.paths)},
        between_(between, outcome) {}

  void run() {
    if (!decide_by_arms_alone()) search_in_turns();
  }
  void note_questions() {
    for (std::size_t k = 0; k < 2; ++k) {
      if (options_.noted[k]) arms_[k].validity().write(*options_.noted[k]);
      outcome_.nodes[k] = arms_[k].validity().nodes_asked();
      outcome_.edges[k] = arms_[k].validity().edges_asked();
    }
  }

 private:
  [[nodiscard]] bool decide_by_arms_alone() {
    std::array<SearchOutcome, 2> alone;
    outcome_.solves += 2;
    for_both_arms(options_.work, [&](int arm) {
      const auto k = static_cast<std::size_t>(arm);
      alone[k] = arms_[k].answer_alone();
    });
    outcome_.bound = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      outcome_.alone[k] = alone[k].path;
      if (!alone[k].path.empty()) outcome_.least_costs[k] = arms_[k].cost_to_go().best();
      outcome_.bound += outcome_.least_costs[k];
    }
    for (int arm = 0; arm < 2; ++arm) {
      if (!alone[static_cast<std::size_t>(arm)].path.empty()) continue;
      outcome_.tree.push_back({.arm_without_path = arm});
      outcome_.decided_by = PairSearcher::kArmsAlone;
      return true;
    }
    if (between_.conflict(arms_, outcome_.alone)) return false;
    outcome_.paths = outcome_.alone;
    outcome_.costs = {alone[0].cost, alone[1].cost};
    outcome_.cost = alone[0].cost + alone[1].cost;
    outcome_.decided_by = PairSearcher::kArmsAlone;
    return true;
  }

  void search_in_turns() {
    RegionBranching regions(arms_, between_, options_, outcome_);
    ProductSearch product(arms_, between_, options_, outcome_);
    if (options_.rounds > 0) {
      std::array<SearchOutcome, 2> best;
      outcome_.solves += 2;
      for_both_arms(options_.work, [&](int arm) {
        const auto k = static_cast<std::size_t>(arm);
        best[k] = arms_[k].cheapest();
        outcome_.alone[k] = best[k].path;
      });
      regions.begin(std::move(best));
    }
    for (std::int64_t rounds = options_.rounds, pops = options_.pops;; pops *= options_.growth) {
      const bool regions_alone = pops <= 0 || pops > options_.most_pops;
      if (options_.rounds > 0 && regions.run(regions_alone ? -1 : rounds)) return;
      if (product.run(options_.rounds > 0 ? pops : -1)) return;
      // The cost-to-go of pairs takes less than many rounds of regions.
      if (outcome_.turns == 1 && pops * options_.growth <= options_.most_pops &&
          product.has_few_pairs() && product.run(pops *= options_.growth))
        return;
      rounds *= options_.growth;
    }
  }

  const PairSearchOptions& options_;
  PairOutcome& outcome_;
  std::array<SearchedArm, 2> arms_;
  KnownBetween between_;
};

}  // namespace

void Between::find_barred(int layer, const std::array<std::vector<int>, 2>& slots,
                          const std::array<std::vector<Config>, 2>& q,
                          std::span<std::uint8_t> barred) {
  const std::size_t columns = slots[1].size();
  std::vector<NodePair> open;
  for (std::size_t k = 0; k < barred.size(); ++k)
    if (!barred[k])
      open.push_back({layer,
                      {slots[0][k / columns], slots[1][k % columns]},
                      {q[0][k / columns], q[1][k % columns]}});
  std::vector<std::uint8_t> apart(open.size());
  nodes(open, apart);
  for (std::size_t k = 0, at = 0; k < barred.size(); ++k)
    if (!barred[k]) barred[k] = !apart[at++];
}

PairOutcome search_pair(const std::array<PairArm, 2>& arms, Between& between,
                        const PairSearchOptions& options) {
  if (arms[0].cost_to_go->lattice().layers() != arms[1].cost_to_go->lattice().layers())
    throw std::invalid_argument("search_pair: the arms have different numbers of layers");
  if ((options.rounds <= 0 && options.pops <= 0) || options.growth < 1)
    throw std::invalid_argument("search_pair: no search is allowed");
  PairOutcome outcome;
  PairSearch search(arms, between, options, outcome);
  try {
    search.run();
  } catch (const Stopped&) {
  }
  search.note_questions();
  return outcome;
}

}  // namespace swivel
