// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <deque>
#include <set>
#include <span>
#include <vector>

#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/verdicts/validity.hpp"

namespace swivel {

/// A path: one slot in each layer 0 ... goal.
using SlotPath = std::vector<int>;

/// Best paths found before in one cost-to-go, between sweeps to a goal, while ever more was removed
/// or came to cost more. The best path follows an earlier one from any node of it whose cost-to-go
/// is what it was, as long as that path still costs as little: removals leave fewer ways to keep a
/// cost, so the first path in slot order stays the first. That needs sums of costs to be exact:
/// paths of kExact units (Lattice::cost_unit()) and more are not followed.
class PathCache {
 public:
  // costs are multiples of 2^-40 of a unit, and a double has 53 bits
  static constexpr double kExact = 0x1p13;

  /// Adds a best path of a cost-to-go that has been repaired. Empty paths are left out.
  void add(const SlotPath& path, const CostToGo& cost_to_go);
  /// Returns the earlier path that the best path follows from a node on, valid until the next
  /// add(); null where there is none.
  [[nodiscard]] const SlotPath* from(int layer, int slot, const CostToGo& cost_to_go);

 private:
  struct Earlier {
    SlotPath path;
    std::vector<double> values;  // cost-to-go of its nodes
    // the deepest layer found to cost more, or to be cut off from the next: up to there it is not
    // followed
    int deepest_changed_layer = -1;
  };
  [[nodiscard]] static bool still_optimal_from(int layer, Earlier& earlier,
                                               const CostToGo& cost_to_go);
  static constexpr std::size_t kMost = 4;
  std::deque<Earlier> earlier_;  // the last one first
};

/// Returns the best path from layer 0 to the goal layer over what the cost-to-go has not removed:
/// from CostToGo::first_slot() on the least cost, the smallest slots first among equals; empty when
/// there is none. It is Boost.Graph's A* with the perfect heuristic, which expands one vertex a
/// layer until it meets an earlier path, where such are given. Adds to `expansions`.
[[nodiscard]] SlotPath best_path(CostToGo& cost_to_go, std::int64_t& expansions,
                                 PathCache* earlier = nullptr);
/// Returns the best path from a slot of layer 0, the smallest slots first among equals; empty when
/// there is none. The cost-to-go must be whole (Pruning::kNone). Adds to `expansions`.
[[nodiscard]] SlotPath best_path_from(int first_slot, CostToGo& cost_to_go,
                                      std::int64_t& expansions, PathCache* earlier = nullptr);

/// What a search found.
struct SearchOutcome {
  SlotPath path;  ///< empty: no path exists
  double cost = 0;
};

/// What a search says of the steps from knot to knot of a lattice that can halve them
/// (Lattice::can_halve()); the other steps are *short*. Let p_0 be the first path of valid nodes
/// and valid short edges, in the order of answers, and p_j the first one without the invalid edges
/// of p_0 ... p_(j-1), up to the answer. All of this depends on the lattice and on what is valid
/// alone, not on the order of questions.
struct KnotSearch {
  /// The search ends without an answer after `patience` p_j in a row at which no new step turns out
  /// to be narrow, once one is, and before a p_j that costs `most` or more.
  int patience = 8, idle = 0;
  double most = kUnreachable;
  /// The least cost of a path of valid nodes and valid short edges, p_0's but for ties;
  /// kUnreachable: there is none. No valid path through the knots' nodes costs less.
  double bound = kUnreachable;
  /// What the first of those paths cost that turned out to have an invalid edge.
  double from = kUnreachable;
  /// The steps at which a p_j has an invalid edge that is not short, by layer of their beginning.
  std::set<int> narrow;
};

/// How path_first() searches. Changes the work, never the answer.
struct PathFirstOptions {
  /// Questions asked at once; answers, not their timing, decide what follows. search_lazily()
  /// (planner/src/plan/search.cpp) sets 8, 16 or 32; decisions 0098, 0109 and 0052 give reasons.
  int batch = 1;
  /// A path that has failed is asked about further until the round has asked so many questions,
  /// which take about as long as a repair and the next path.
  int min_questions_per_iteration = 64;
  /// Most questions in a round about the neighbours of failed nodes: `region_questions`, and one
  /// more for every `nodes_per_region_question` nodes of the lattice, since an obstacle blocks more
  /// nodes of a finer lattice, and a round costs more.
  int region_questions = 64, nodes_per_region_question = 64;
  /// True: neighbours are asked about on other threads while the caller takes the answers about
  /// those before them.
  bool overlap_region_questions = false;
  /// Where to note what the search says of steps between knots; null: nowhere. Of edges that are
  /// not short only those of the p_j are asked about then, all of each p_j.
  KnotSearch* knots = nullptr;
};

/// The work of a search.
struct SearchCounters {
  std::int64_t expansions = 0, iterations = 0;
  SlotPath candidate;  ///< the path tried last
};
/// What failed in an earlier search of the same lattice, and is likely to fail again.
struct PriorFailures {
  std::vector<NodeQuestion> nodes;
  std::vector<EdgeQuestion> edges;
};

/// A node that failed in the search of another lattice like this one, whose path lay a little
/// elsewhere.
struct FailureHint {
  int layer = 0, slot = 0;
  FailureId suspected = kNoFailure;
};

/// Path-first search (LazySP: Dellin & Srinivasa 2016): take the best path of the optimistic
/// lattice, validate it where failures were found before, remove what fails and the failing region
/// around it, repair the cost-to-go, and repeat. What nodes themselves cost counts as 0 until a
/// path through them is the best, and then raises their cost-to-go. Returns the first path found
/// valid, the first in the order of answers (docs/model.md); an empty path when none is left or a
/// layer has no node left: what is removed then proves that none exists, though the cost-to-go may
/// not have followed yet. `first` is asked about before the first path, all at once; it changes the
/// work, never the answer. Throws Stopped.
[[nodiscard]] SearchOutcome path_first(CostToGo& cost_to_go, Validity& validity,
                                       const PathFirstOptions& options, SearchCounters& counters,
                                       const PriorFailures& first = {});

/// Asks about nodes before the first sweep and removes those that fail, so that neither sweep nor
/// search begins with what failed a moment ago. It ends where fewer than half fail. Changes the
/// work, never the answer. Throws Stopped.
void check_failure_hints(CostToGo& cost_to_go, Validity& validity,
                         std::span<const FailureHint> failure_hints);

/// Returns the deepest layer that a valid path from layer 0 reaches, once path_first() has found
/// none; -1 when layer 0 has no valid node. The cost-to-go then has that layer as its goal, and
/// `counters` the best valid path there, in the order of answers, as its candidate: whatever was
/// asked before. With PathFirstOptions::knots, whose `narrow` is then that of the way there, it
/// ends with -1 where steps turn out to be narrow before a path is found. Throws Stopped.
[[nodiscard]] int deepest_valid_layer(CostToGo& cost_to_go, Validity& validity,
                                      const PathFirstOptions& options, SearchCounters& counters);

}  // namespace swivel
