// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "search/pairs/known_between.hpp"
#include "search/pairs/pair_cost_to_go.hpp"
#include "search/pairs/searched_arm.hpp"
#include "swivel/graph/search/pair_search.hpp"

namespace swivel {

/// A* over pairs of simultaneous nodes. Its heuristic is the sum of what the rest costs each arm by
/// itself, in lattices from which all nodes and edges are removed that are known not to be valid
/// when a turn begins. What is not known is asked when a pair is taken from the queue. Each turn
/// begins anew: the heuristic is nearer to the truth then, and turns grow so fast that the earlier
/// ones add little. From the second turn on, where there are not too many pairs, the heuristic is
/// the cost-to-go of pairs: only moves and what the arms may do by themselves can make paths dearer
/// than it says.
class ProductSearch {
 public:
  /// All arguments must outlive the object.
  ProductSearch(std::array<SearchedArm, 2>& arms, KnownBetween& between,
                const PairSearchOptions& options, PairOutcome& outcome)
      : arms_(arms), between_(between), options_(options), outcome_(outcome) {}

  /// Takes at most `most_pops` pairs from the queue, without end if negative. Returns true once the
  /// search is decided: `outcome` then has the answer. Throws Stopped.
  [[nodiscard]] bool run(std::int64_t most_pops);
  /// Returns whether the next turn begins with the cost-to-go of pairs. Allowed after a turn.
  [[nodiscard]] bool has_few_pairs() const {
    return PairCostToGo::pairs(values()) <= options_.most_pairs;
  }

 private:
  /// A way on for one arm.
  struct Step {
    int slot = 0;
    double rise = 0;  ///< by how much the least cost of the whole path rises that way
    double cost = 0;  ///< of the edge and of the node that it leaves
  };
  /// A node of one arm.
  struct Place {
    Config q = Config::Zero();
    std::optional<bool> valid;
    double dearer = 0;  ///< by what the node costs more than the heuristic says, once known
    std::optional<std::vector<Step>> steps;  ///< by rise, then by slot
  };
  /// An arm with its lattice of a turn.
  struct Side {
    std::unique_ptr<CostToGo> values;
    RememberedValidity::Written written;
    std::unordered_map<std::int64_t, Place> places;
    std::vector<Step> starts;
  };
  /// A pair that has been reached at the least cost, by the first way in the order of slots.
  struct Reached {
    int before = -1;  ///< index of the pair before it; -1 in layer 0
    int layer = 0;
    std::array<int, 2> slots{};
  };
  /// A pair in the queue, to be reached from another one.
  struct Open {
    double cost = 0;  ///< of the cheapest pair of paths through it, as far as it is known
    /// No pair to be reached: from the pair with index ways[0] (-1: before layer 0) ways on are to
    /// be queued, those that cost `cost`. `before` and `slots` are of that pair.
    bool expands = false;
    int before = -1;
    std::array<int, 2> ways{};  ///< indices of both arms' steps
    std::array<int, 2> slots{};
    bool raised = false;  ///< cost includes Place::dearer, and the ways beside it are queued
  };
  struct Pair {
    int layer = 0;
    std::array<int, 2> slots{};
    bool operator==(const Pair&) const = default;
  };
  struct PairHash {
    std::size_t operator()(const Pair& pair) const;
  };

  /// Sorts ways by rise, then by slot.
  static void sort(std::vector<Step>& steps);
  [[nodiscard]] std::array<CostToGo*, 2> values() const {
    return {sides_[0].values.get(), sides_[1].values.get()};
  }
  void begin_turn();
  [[nodiscard]] Place& place(int arm, int layer, int slot);
  [[nodiscard]] const std::vector<Step>& steps(int arm, int before);
  [[nodiscard]] int layer_of(const Open& open) const {
    return open.before < 0 ? 0 : reached_[static_cast<std::size_t>(open.before)].layer + 1;
  }
  [[nodiscard]] bool is_later(const Open& a, const Open& b) const;
  /// Queues the pair reached by two ways on, if there are such ways.
  void push(int before, double cost, const std::array<int, 2>& ways);
  void push(const Open& open);
  [[nodiscard]] Open pop();
  /// Queues the ways on from a reached pair (-1: the begin) that cost `cost` by pair_cost_to_go_,
  /// and one entry for those that cost more. Source: partial expansion, Yoshizumi, Miura and
  /// Ishida 2000.
  void expand(int before, double cost);
  /// Queues the pairs that follow one in the order of their costs.
  void push_beside(const Open& open, double before_cost, bool first_valid);
  /// Takes a pair. Returns true if it is reached by a valid way without conflict, and new.
  [[nodiscard]] bool take(const Open& open);
  [[nodiscard]] bool is_valid(int arm, int layer, int slot);
  [[nodiscard]] bool edge_is_valid(int arm, const Reached& from, int slot);
  [[nodiscard]] bool way_holds(const Open& open, int layer);
  void find(int last);

  std::array<SearchedArm, 2>& arms_;
  KnownBetween& between_;
  const PairSearchOptions& options_;
  PairOutcome& outcome_;
  std::array<Side, 2> sides_;
  std::optional<PairCostToGo> pair_cost_to_go_;
  std::vector<Reached> reached_;
  std::vector<double> reached_cost_;
  std::unordered_set<Pair, PairHash> done_;  // those reached
  std::vector<Open> queue_;                  // a heap
};

}  // namespace swivel
