// SPDX-License-Identifier: BSD-3-Clause
#include "search/pairs/known_between.hpp"

#include <algorithm>
#include <stdexcept>

#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

using Arms = std::array<SearchedArm, 2>;
using Paths = std::array<SlotPath, 2>;

NodePair nodes_at(Arms& arms, const Paths& paths, int layer) {
  NodePair pair{.layer = layer};
  for (std::size_t k = 0; k < 2; ++k) {
    pair.slots[k] = paths[k][static_cast<std::size_t>(layer)];
    pair.q[k] = arms[k].cost_to_go().config(layer, pair.slots[k]);
  }
  return pair;
}

MovePair moves_at(Arms& arms, const Paths& paths, int layer) {
  const NodePair from = nodes_at(arms, paths, layer), to = nodes_at(arms, paths, layer + 1);
  MovePair pair{.layer = layer, .from = from.q, .to = to.q};
  for (std::size_t k = 0; k < 2; ++k) pair.moves[k] = {from.slots[k], to.slots[k]};
  return pair;
}

template <class Item>
bool has(const std::vector<Item>& items, const Item& item) {
  return std::find(items.begin(), items.end(), item) != items.end();
}

}  // namespace

std::size_t KnownBetween::Hash::operator()(const Key& key) const {
  auto h = static_cast<std::uint64_t>(key.layer);
  for (const SlotMove& move : key.moves)
    for (const int slot : {move.from, move.to}) {
      h = (h ^ static_cast<std::uint64_t>(slot)) * 0x9e3779b97f4a7c15ull;
      h ^= h >> 29;
    }
  return h;
}

void KnownBetween::ask(const std::vector<NodePair>& questions, std::vector<std::uint8_t>& apart) {
  outcome_.node_pairs += static_cast<std::int64_t>(questions.size());
  between_.nodes(questions, apart);
}

void KnownBetween::ask(const std::vector<MovePair>& questions, std::vector<std::uint8_t>& apart) {
  outcome_.move_pairs += static_cast<std::int64_t>(questions.size());
  between_.moves(questions, apart);
}

template <class Pair>
std::vector<int> KnownBetween::conflicts(const std::vector<Pair>& pairs) {
  std::vector<Pair> open;
  std::vector<int> layers;
  for (const Pair& pair : pairs) {
    const auto found = known(pair).find(key(pair));
    if (found == known(pair).end())
      open.push_back(pair);
    else if (!found->second)
      layers.push_back(pair.layer);
  }
  if (!open.empty()) {
    std::vector<std::uint8_t> apart(open.size());
    ask(open, apart);
    for (std::size_t k = 0; k < open.size(); ++k) {
      known(open[k]).emplace(key(open[k]), apart[k] != 0);
      if (!apart[k]) layers.push_back(open[k].layer);
    }
  }
  std::sort(layers.begin(), layers.end());
  return layers;
}

std::optional<KnownBetween::Conflict> KnownBetween::conflict(Arms& arms, const Paths& paths) {
  const TraceSpan span("between paths");
  const int layers = static_cast<int>(paths[0].size());
  std::vector<NodePair> nodes;
  for (int layer = 0; layer < layers; ++layer) nodes.push_back(nodes_at(arms, paths, layer));
  const std::vector<int> at = conflicts(nodes);
  if (!at.empty()) return Conflict{at[at.size() / 2], false};
  if (!asks_moves()) return std::nullopt;
  std::vector<MovePair> moves;
  for (int layer = 0; layer + 1 < layers; ++layer) moves.push_back(moves_at(arms, paths, layer));
  const std::vector<int> from = conflicts(moves);
  if (!from.empty()) return Conflict{from[from.size() / 2], true};
  return std::nullopt;
}

ConflictRegion KnownBetween::region(Arms& arms, const Paths& paths, const Conflict& conflict,
                                    bool thorough) {
  const TraceSpan span("region");
  ConflictRegion region{.layer = conflict.layer, .of_moves = conflict.of_moves};
  bool whole = true;
  if (conflict.of_moves) {
    const MovePair pair = moves_at(arms, paths, conflict.layer);
    region.moves = between_.region(pair, thorough);
    for (std::size_t k = 0; k < 2; ++k) whole = whole && has(region.moves[k], pair.moves[k]);
  } else {
    const NodePair pair = nodes_at(arms, paths, conflict.layer);
    region.slots = between_.region(pair, thorough);
    for (std::size_t k = 0; k < 2; ++k) whole = whole && has(region.slots[k], pair.slots[k]);
  }
  if (!whole) throw std::logic_error("a region of conflict lacks the conflict that it is about");
  return region;
}

template <class Pair>
bool KnownBetween::is_apart(const Pair& pair) {
  const auto found = known(pair).find(key(pair));
  if (found != known(pair).end()) return found->second;
  std::vector<std::uint8_t> apart(1);
  ask(std::vector{pair}, apart);
  return known(pair).emplace(key(pair), apart.front() != 0).first->second;
}

bool KnownBetween::apart(const NodePair& pair) {
  return is_apart(pair);
}

bool KnownBetween::apart(const MovePair& pair) {
  return is_apart(pair);
}

}  // namespace swivel
