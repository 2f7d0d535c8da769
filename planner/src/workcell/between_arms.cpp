// SPDX-License-Identifier: BSD-3-Clause
#include "workcell/between_arms.hpp"

#include <algorithm>

namespace swivel {

namespace {

/// Nodes of one layer of an arm that have exact joints, in the order of slots, with where the
/// bodies that a region is about are at each.
struct LayerNodes {
  std::vector<int> slots;
  std::vector<Config> rows;
  std::optional<InterArmWorld::Stances> stances;

  LayerNodes(const Lattice& lattice, int layer) {
    std::vector<Lattice::Node> nodes;
    lattice.layer_nodes(layer, nodes);
    for (const Lattice::Node& node : nodes)
      if (const auto row = lattice.exact_config(layer, node.slot, node.q)) {
        slots.push_back(node.slot);
        rows.push_back(*row);
      }
  }
  /// Returns the index of a slot; none where it has no node with exact joints.
  [[nodiscard]] std::optional<std::size_t> find(int slot) const {
    const auto found = std::lower_bound(slots.begin(), slots.end(), slot);
    if (slot < 0 || found == slots.end() || *found != slot) return std::nullopt;
    return static_cast<std::size_t>(found - slots.begin());
  }
};

/// Grows a region of conflict about two nodes. `touch(i, j)` says whether stance i of arm 0 and
/// stance j of arm 1 are too near; it depends on the two alone.
template <class Touch>
class RegionGrowth {
 public:
  RegionGrowth(const std::array<const Lattice*, 2>& lattices, int layer,
               const std::array<LayerNodes, 2>& nodes, const Touch& touch, const Budget& budget)
      : lattices_(lattices), layer_(layer), nodes_(nodes), touch_(touch), budget_(budget) {}

  std::array<std::vector<int>, 2> grow(const std::array<int, 2>& conflict) {
    for (std::size_t arm = 0; arm < 2; ++arm) {
      ends_[arm] = {conflict[arm], conflict[arm]};
      side_[arm].clear();
      stances_[arm].clear();
      add(arm, *nodes_[arm].find(conflict[arm]));
    }
    grow_along_redundancy();
    for (std::size_t arm = 0; arm < 2; ++arm) add_rest(arm);
    std::array<std::vector<int>, 2> slots;
    for (std::size_t arm = 0; arm < 2; ++arm) {
      for (const std::size_t node : side_[arm]) slots[arm].push_back(nodes_[arm].slots[node]);
      std::sort(slots[arm].begin(), slots[arm].end());
    }
    return slots;
  }

 private:
  /// Grows both sides evenly along the redundancy coordinate, as long as all nodes of the one touch
  /// all of the other.
  void grow_along_redundancy() {
    for (bool grown = true; grown;) {
      grown = false;
      for (std::size_t arm = 0; arm < 2; ++arm)
        for (const int by : {-1, 1}) grown = step(arm, by) || grown;
    }
  }
  bool step(std::size_t arm, int by) {
    int& end = ends_[arm][by < 0 ? 0 : 1];
    if (end < 0) return false;
    end = lattices_[arm]->neighbour_in_redundancy(layer_, end, by);
    const auto node = nodes_[arm].find(end);
    if (!node || contains(arm, *node) || !touches_all(arm, stance(arm, *node))) {
      end = -1;  // this way is at its end
      return false;
    }
    add(arm, *node);
    return true;
  }
  /// Adds all other nodes of an arm that touch all of the other arm's side.
  void add_rest(std::size_t arm) {
    std::vector<char> known(nodes_[arm].slots.size());
    for (const std::size_t node : side_[arm]) known[node] = 1;
    std::vector<std::optional<bool>> touches(nodes_[arm].stances->count());
    for (std::size_t node = 0; node < known.size(); ++node) {
      if (known[node]) continue;
      std::optional<bool>& all = touches[stance(arm, node)];
      if (!all) all = touches_all(arm, stance(arm, node));
      if (*all) add(arm, node);
    }
  }
  [[nodiscard]] std::size_t stance(std::size_t arm, std::size_t node) const {
    return nodes_[arm].stances->stance_of(node);
  }
  void add(std::size_t arm, std::size_t node) {
    side_[arm].push_back(node);
    const std::size_t own = stance(arm, node);
    if (std::find(stances_[arm].begin(), stances_[arm].end(), own) == stances_[arm].end())
      stances_[arm].push_back(own);
  }
  [[nodiscard]] bool contains(std::size_t arm, std::size_t node) const {
    return std::find(side_[arm].begin(), side_[arm].end(), node) != side_[arm].end();
  }
  [[nodiscard]] bool touches_all(std::size_t arm, std::size_t own) const {
    budget_.poll();
    const std::vector<std::size_t>& others = stances_[1 - arm];
    // The stances that were added last are the furthest from the conflict.
    return std::all_of(others.rbegin(), others.rend(), [&](std::size_t other) {
      return arm == 0 ? touch_(own, other) : touch_(other, own);
    });
  }

  const std::array<const Lattice*, 2>& lattices_;
  int layer_;
  const std::array<LayerNodes, 2>& nodes_;
  const Touch& touch_;
  const Budget& budget_;
  std::array<std::array<int, 2>, 2> ends_{};         // slots, by arm; -1: at the end
  std::array<std::vector<std::size_t>, 2> side_;     // nodes
  std::array<std::vector<std::size_t>, 2> stances_;  // of these nodes, each once
};

}  // namespace

std::optional<std::array<Config, 2>> BetweenArms::rows(int layer, const std::array<int, 2>& slots,
                                                       const std::array<Config, 2>& q) const {
  std::array<Config, 2> rows;
  for (std::size_t arm = 0; arm < 2; ++arm) {
    const auto row = lattices_[arm]->exact_config(layer, slots[arm], q[arm]);
    if (!row) return std::nullopt;
    rows[arm] = *row;
  }
  return rows;
}

std::optional<BodyPair> BetweenArms::barred(const NodePair& question) {
  budget_.poll();
  const auto at = rows(question.layer, question.slots, question.q);
  return at ? query_.find_violating_pair(*at, ClearanceRule::kNode) : std::nullopt;
}

std::optional<BodyPair> BetweenArms::barred(const MovePair& question) {
  budget_.poll();
  const auto from = rows(question.layer, {question.moves[0].from, question.moves[1].from},
                         question.from),
             to = rows(question.layer + 1, {question.moves[0].to, question.moves[1].to},
                       question.to);
  if (!from || !to) return std::nullopt;
  std::array<Config, 2> end = *from;
  for (std::size_t arm = 0; arm < 2; ++arm)
    end[arm] += lattices_[arm]->delta((*from)[arm], (*to)[arm]);
  return query_.find_pair_blocking_motion(radii_, *from, end, 0, budget_);
}

void BetweenArms::nodes(std::span<const NodePair> questions, std::span<std::uint8_t> apart) {
  for (std::size_t k = 0; k < questions.size(); ++k)
    apart[k] = static_cast<std::uint8_t>(!barred(questions[k]));
}

void BetweenArms::moves(std::span<const MovePair> questions, std::span<std::uint8_t> apart) {
  for (std::size_t k = 0; k < questions.size(); ++k)
    apart[k] = static_cast<std::uint8_t>(!barred(questions[k]));
}

void BetweenArms::find_barred(int layer, const std::array<std::vector<int>, 2>& slots,
                              const std::array<std::vector<Config>, 2>&,
                              std::span<std::uint8_t> barred) {
  std::array<std::optional<InterArmWorld::Stances>, 2> stances;
  std::array<std::vector<std::optional<std::size_t>>, 2> stance;  // of a slot with exact joints
  for (std::size_t arm = 0; arm < 2; ++arm) {
    if (slots[arm].empty()) return;
    const LayerNodes nodes(*lattices_[arm], layer);
    stances[arm].emplace(query_.stances(static_cast<int>(arm), -1, nodes.rows));
    for (const int slot : slots[arm]) {
      const auto node = nodes.find(slot);
      stance[arm].push_back(node ? std::optional(stances[arm]->stance_of(*node)) : std::nullopt);
    }
  }
  std::size_t k = 0;
  for (const auto& a : stance[0]) {
    budget_.poll();
    for (const auto& b : stance[1]) {
      if (!barred[k]) barred[k] = !a || !b || query_.any_violates(*stances[0], *a, *stances[1], *b);
      ++k;
    }
  }
}

std::array<std::vector<int>, 2> BetweenArms::region(const NodePair& conflict, bool thorough) {
  std::array<LayerNodes, 2> nodes{LayerNodes(*lattices_[0], conflict.layer),
                                  LayerNodes(*lattices_[1], conflict.layer)};
  const auto at = rows(conflict.layer, conflict.slots, conflict.q);
  const BodyPair pair = *query_.find_deepest_pair(*at);
  for (int arm = 0; arm < 2; ++arm) {
    LayerNodes& of = nodes[static_cast<std::size_t>(arm)];
    of.stances.emplace(query_.stances(arm, thorough ? -1 : arm == 0 ? pair.a : pair.b, of.rows));
  }
  const auto touch = [&](std::size_t i, std::size_t j) {
    return thorough ? query_.any_violates(*nodes[0].stances, i, *nodes[1].stances, j)
                    : query_.violates(pair, *nodes[0].stances, i, *nodes[1].stances, j);
  };
  return RegionGrowth(lattices_, conflict.layer, nodes, touch, budget_).grow(conflict.slots);
}

}  // namespace swivel
