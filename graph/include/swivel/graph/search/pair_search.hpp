// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/graph/verdicts/parallel_for.hpp"
#include "swivel/graph/verdicts/validity.hpp"

namespace swivel {

// Two arms move at one time: layer i of arm 0 and layer i of arm 1 are simultaneous, and so are
// their moves from layer i to the next. Arms are numbered 0 and 1 in all arrays of two.

/// A move of one arm, from a slot of a layer to a slot of the next.
struct SlotMove {
  int from = 0, to = 0;
  bool operator==(const SlotMove&) const = default;
};
/// A question whether two arms are apart where each stands at a node of one layer.
struct NodePair {
  int layer = 0;
  std::array<int, 2> slots{};
  std::array<Config, 2> q;  ///< joints of the two nodes, rad
};
/// A question whether two arms are apart while both move from a layer to the next.
struct MovePair {
  int layer = 0;
  std::array<SlotMove, 2> moves;
  std::array<Config, 2> from, to;  ///< joints of the nodes, rad
};

/// Answers questions about two arms at once. What an arm by itself may do is not asked here.
class Between {
 public:
  virtual ~Between() = default;
  /// Sets apart[k] to 1 if the arms of questions[k] are apart, else to 0. Both spans have equal
  /// size. Throws Stopped.
  virtual void nodes(std::span<const NodePair> questions, std::span<std::uint8_t> apart) = 0;
  /// Answers like nodes(), about moves whose nodes are apart. Throws Stopped.
  virtual void moves(std::span<const MovePair> questions, std::span<std::uint8_t> apart) = 0;
  /// Sets barred[i * slots[1].size() + j] to 1 where slot i of arm 0 and slot j of arm 1 of a layer
  /// are not apart. Pairs whose entry is 1 already are not asked about; others may be left out
  /// where the answer takes long. `q`: joints of the slots, rad. Throws Stopped.
  virtual void find_barred(int layer, const std::array<std::vector<int>, 2>& slots,
                           const std::array<std::vector<Config>, 2>& q,
                           std::span<std::uint8_t> barred);
  /// Returns false if all moves are apart whose nodes are, so that moves() need not be asked.
  [[nodiscard]] virtual bool asks_moves() const = 0;
  /// Returns for each arm slots of the layer of `conflict`, its own among them, so that no slot of
  /// the one is apart from any slot of the other. The larger both sets are, the sooner a search
  /// ends. `thorough`: more questions may be asked for larger sets. Throws Stopped.
  [[nodiscard]] virtual std::array<std::vector<int>, 2> region(const NodePair& conflict,
                                                               bool thorough) = 0;
  /// Returns for each arm moves from the layer of `conflict`, as region() does slots; the two moves
  /// of `conflict` alone, unless a class knows better.
  [[nodiscard]] virtual std::array<std::vector<SlotMove>, 2> region(const MovePair& conflict,
                                                                    bool thorough) {
    static_cast<void>(thorough);
    return {std::vector{conflict.moves[0]}, std::vector{conflict.moves[1]}};
  }
};

/// One of two arms as their search sees it. Whatever its verdicts say already is taken for known.
struct PairArm {
  CostToGo* cost_to_go = nullptr;
  Validity* validity = nullptr;  ///< asked by one thread at a time
};

/// How search_pair() searches. Where an answer is found, it is the same whatever the options.
struct PairSearchOptions {
  PathFirstOptions paths;  ///< how the paths of each arm are validated
  /// Rounds of regions after which the product search takes its first turn; 0: no regions at all.
  std::int64_t rounds = 16;
  /// Pairs of nodes that the product search takes in its first turn; 0: no product search at all.
  std::int64_t pops = 1 << 13;
  /// By what rounds, counted from the first, and pairs of a turn are multiplied after each turn.
  int growth = 4;
  /// No turn of the product search takes more pairs than so many, for the memory that they need
  /// (some 200 bytes each). After the last turn regions go on alone.
  std::int64_t most_pops = 1 << 22;
  /// Where there are no more pairs of simultaneous nodes than so many, of all layers together, the
  /// second turn of the product search follows the first at once, and it and later ones begin with
  /// the cost-to-go of every pair.
  std::int64_t most_pairs = 1 << 22;
  /// Rounds after which Between is asked for thorough regions.
  std::int64_t quick_rounds = 8;
  ParallelFor work;  ///< shares the two arms among threads; the result is the same
  /// Verdicts of each arm's lattice, empty at the begin: the search writes into them at its end
  /// what it found out about nodes. Null: it does not.
  std::array<Verdicts*, 2> noted{};
};

/// A set of nodes, or of moves, of each arm, no two of which are apart: pairs of paths that have no
/// conflict keep away from the one set or from the other.
struct ConflictRegion {
  int layer = 0;
  bool of_moves = false;                       ///< of moves from `layer`; else of its nodes
  std::array<std::vector<int>, 2> slots;       ///< of each arm; empty if of_moves
  std::array<std::vector<SlotMove>, 2> moves;  ///< of each arm; empty unless of_moves
};
/// A set of pairs of paths in the tree by which all pairs were divided: those that keep away from
/// what was removed on the way from the root.
struct RegionBranch {
  int parent = -1;  ///< index in the tree; -1: the root, which has all pairs
  int arm = -1;     ///< the arm whose side of the parent's region was removed; -1: the root
  /// The arm that has no path then; none where each arm has one.
  std::optional<int> arm_without_path;
  /// The region by which the set was divided in two; none where it was not.
  std::optional<ConflictRegion> region;
};

/// Which search decided.
enum class PairSearcher : std::uint8_t { kNone, kArmsAlone, kRegions, kProduct };

/// A pair of paths that was found, or what is known of it.
struct PairOutcome {
  PairSearcher decided_by = PairSearcher::kNone;  ///< kNone: stopped by the budget
  [[nodiscard]] bool decided() const { return decided_by != PairSearcher::kNone; }
  /// The answer; where none is decided, the cheapest pair known without conflict; else empty.
  std::array<SlotPath, 2> paths;
  double cost = kUnreachable;                                     ///< of both paths together
  std::array<double, 2> costs{kUnreachable, kUnreachable};        ///< of each path
  std::array<double, 2> least_costs{kUnreachable, kUnreachable};  ///< of each arm by itself
  /// The answer of each arm by itself, empty where it has none: where these have a conflict, the
  /// first one among equally cheap paths, with which regions begin.
  std::array<SlotPath, 2> alone;
  /// No pair of valid paths without conflict costs less; kUnreachable: there is none.
  double bound = 0;
  /// Where regions decided that there is no pair: the proof, whose leaves are all without a path.
  /// Else as far as regions came. The root comes first, and parents before children.
  std::vector<RegionBranch> tree;
  std::int64_t rounds = 0;                       ///< regions by which sets were divided
  std::int64_t solves = 0;                       ///< searches for the best path of one arm
  std::int64_t turns = 0, pops = 0;              ///< of the product search
  std::int64_t node_pairs = 0, move_pairs = 0;   ///< asked of Between
  std::array<std::int64_t, 2> nodes{}, edges{};  ///< asked of each arm's Validity
};

/// Finds the cheapest pair of valid paths, one of each arm, without conflict. Where the answers of
/// both arms by themselves (path_first()) have none, these are the answer. Else pairs are ordered
/// by the sum of both costs, then by slots: of arm 0 in layer 0, of arm 1 in layer 0, of arm 0 in
/// layer 1 and so on; the first is the answer. Two exact searches take turns, whose lengths are
/// counted: one divides the set of all pairs by regions of conflict, the other is A* over pairs of
/// nodes. docs/theory.md has the proof. Does not throw Stopped: the outcome then has the cheapest
/// pair known without conflict. Throws std::invalid_argument if the arms differ in the number of
/// layers or if neither search is allowed, std::logic_error if a region lacks its conflict.
[[nodiscard]] PairOutcome search_pair(const std::array<PairArm, 2>& arms, Between& between,
                                      const PairSearchOptions& options);

}  // namespace swivel
