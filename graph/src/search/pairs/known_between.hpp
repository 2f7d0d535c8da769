// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "search/pairs/searched_arm.hpp"
#include "swivel/graph/search/pair_search.hpp"

namespace swivel {

/// What a Between has answered: no pair of nodes or moves is asked about twice.
class KnownBetween {
 public:
  /// Both arguments must outlive the object. Counts questions in `outcome`.
  KnownBetween(Between& between, PairOutcome& outcome) : between_(between), outcome_(outcome) {}

  /// A conflict of two paths: at a layer, or on the moves from it to the next.
  struct Conflict {
    int layer = 0;
    bool of_moves = false;
  };
  /// Returns a conflict of two valid paths, none if they have none: of their conflicting layers the
  /// middle one, or else of their conflicting moves. Throws Stopped.
  [[nodiscard]] std::optional<Conflict> conflict(std::array<SearchedArm, 2>& arms,
                                                 const std::array<SlotPath, 2>& paths);
  /// Returns the region of a conflict of two paths. Throws Stopped, and std::logic_error if the
  /// region lacks the conflict.
  [[nodiscard]] ConflictRegion region(std::array<SearchedArm, 2>& arms,
                                      const std::array<SlotPath, 2>& paths,
                                      const Conflict& conflict, bool thorough);

  /// Returns whether two nodes are apart. Throws Stopped.
  [[nodiscard]] bool apart(const NodePair& pair);
  /// Returns whether two moves are apart whose nodes are. Throws Stopped.
  [[nodiscard]] bool apart(const MovePair& pair);
  [[nodiscard]] bool asks_moves() const { return between_.asks_moves(); }
  /// Returns the Between itself, for questions of another form; nothing is counted of them.
  [[nodiscard]] Between& between() { return between_; }

 private:
  /// A pair of nodes, whose `to` are 0, or of moves.
  struct Key {
    int layer = 0;
    std::array<SlotMove, 2> moves;
    bool operator==(const Key&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  using Known = std::unordered_map<Key, bool, Hash>;
  static Key key(const NodePair& pair) {
    return {pair.layer, {SlotMove{pair.slots[0], 0}, SlotMove{pair.slots[1], 0}}};
  }
  static Key key(const MovePair& pair) { return {pair.layer, pair.moves}; }
  Known& known(const NodePair&) { return nodes_; }
  Known& known(const MovePair&) { return moves_; }
  void ask(const std::vector<NodePair>& questions, std::vector<std::uint8_t>& apart);
  void ask(const std::vector<MovePair>& questions, std::vector<std::uint8_t>& apart);
  /// Asks about those of the pairs that are not known. Returns the layers of those not apart.
  template <class Pair>
  [[nodiscard]] std::vector<int> conflicts(const std::vector<Pair>& pairs);
  template <class Pair>
  [[nodiscard]] bool is_apart(const Pair& pair);

  Between& between_;
  PairOutcome& outcome_;
  Known nodes_, moves_;
};

}  // namespace swivel
