// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "answer_order.hpp"
#include "plain_edge_rule.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/problem/hooks.hpp"

namespace swivel::test {

struct BruteForcePath {
  bool solved = false;
  double cost = 0;
  std::vector<int> slots;
  bool chosen = false;  // the start is not the first of the least cost: another costs as much but
                        // for rounding
  int deepest = -1;
  std::vector<int> empty;  // layers without a valid node
  // Of a closed lattice, by slot: the least cost of a path that begins and ends there; infinite
  // where there is none.
  std::vector<double> closed_costs;
};

/// An edge into a node: the slot that it comes from, and its cost.
struct EdgeFrom {
  std::size_t slot;
  double cost;
};

/// Returns for each slot the least cost of a path that begins and ends in it, one dynamic program a
/// slot: `into` has the edges into each slot of each layer, `own` what nodes themselves cost,
/// `exists` whether the nodes of layer 0 and of the last layer exist.
inline std::vector<double> closed_costs_of(
    const std::vector<std::vector<std::vector<EdgeFrom>>>& into,
    const std::function<double(std::size_t layer, std::size_t slot)>& own,
    const std::function<bool(std::size_t layer, std::size_t slot)>& exists) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::vector<double> costs(into.front().size(), kNone);
  for (std::size_t slot = 0; slot < costs.size(); ++slot) {
    if (!exists(0, slot) || !exists(into.size() - 1, slot)) continue;
    std::vector<double> here(costs.size(), kNone);
    here[slot] = own(0, slot);
    for (std::size_t i = 1; i < into.size(); ++i) {
      std::vector<double> next(into[i].size(), kNone);
      for (std::size_t b = 0; b < next.size(); ++b)
        for (const EdgeFrom& edge : into[i][b])
          next[b] = std::min(next[b], here[edge.slot] + edge.cost + own(i, b));
      here.swap(next);
    }
    costs[slot] = here[slot];
  }
  return costs;
}

/// The nodes and edges of a lattice by their definitions, with steps of its own and the plain edge
/// rule. Costs are those of the nodes; all that is tested is tested on the rows, the exact
/// configurations. Hooks are asked about one state or motion at a time.
class PlainLattice {
 public:
  /// `in_window`: whether slots a and b of neighbouring layers may be joined. References must
  /// outlive it.
  PlainLattice(const Lattice& lattice, const World& world, const EdgeRule& rule,
               std::function<bool(int layer, int a, int b)> in_window, Hooks hooks = {})
      : lattice_(lattice),
        query_(world),
        rule_(rule),
        in_window_(std::move(in_window)),
        hooks_(std::move(hooks)),
        nodes_(static_cast<std::size_t>(lattice.layers())),
        rows_(nodes_.size()) {
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      for (int slot = 0; slot < lattice.slots(static_cast<int>(i)); ++slot)
        add_node(static_cast<int>(i), slot);
  }
  [[nodiscard]] const Lattice& lattice() const { return lattice_; }
  /// Returns the joints of the valid nodes by layer and slot.
  [[nodiscard]] const std::vector<std::vector<std::optional<Config>>>& nodes() const {
    return nodes_;
  }
  [[nodiscard]] double own_cost(std::size_t i, std::size_t slot) const {
    double cost = 0;
    if (hooks_.cost) hooks_.cost->costs({&*rows_[i][slot], 1}, {&cost, 1});
    return lattice_.rounded_cost(cost) +
           lattice_.node_cost(static_cast<int>(i), static_cast<int>(slot));
  }
  /// Returns the cost of the edge between two valid nodes, if it is valid.
  [[nodiscard]] std::optional<double> edge(std::size_t i, std::size_t a, std::size_t b) {
    const int layer = static_cast<int>(i), sa = static_cast<int>(a), sb = static_cast<int>(b);
    if (!in_window_(layer, sa, sb)) return std::nullopt;
    return lattice_.has_layers_between() ? edge_of_layers(i, a, b) : edge_of_layer(i, a, b);
  }
  /// Returns the cost of the edge between two valid nodes of a lattice with layers between, whether
  /// or not what lies between is valid; none if they may not be joined, or are too far apart.
  [[nodiscard]] std::optional<double> chord(std::size_t i, std::size_t a, std::size_t b) const {
    if (!in_window_(static_cast<int>(i), static_cast<int>(a), static_cast<int>(b)))
      return std::nullopt;
    const Config delta = lattice_.delta(*nodes_[i][a], *nodes_[i + 1][b]);
    for (int j = 0; j < kDof; ++j)
      if (std::abs(delta[j]) > lattice_.step_bound(static_cast<int>(i))[j]) return std::nullopt;
    return lattice_.edge_cost(delta);
  }

 private:
  void add_node(int layer, int slot) {
    const auto i = static_cast<std::size_t>(layer);
    nodes_[i].push_back(lattice_.node(layer, slot));
    std::optional<Config>& q = nodes_[i].back();
    if (!q) {
      rows_[i].emplace_back();
      return;
    }
    rows_[i].push_back(lattice_.exact_config(layer, slot, *q));
    const auto& row = rows_[i].back();
    if (!row || lattice_.chain().manipulability(*row) < lattice_.limits().manipulability ||
        query_.find_violating_pair(*row, ClearanceRule::kNode))
      q.reset();
    bool allowed = true;
    if (q && hooks_.check) hooks_.check->states({&*row, 1}, {&allowed, 1});
    if (!allowed) q.reset();
  }
  [[nodiscard]] std::optional<double> edge_of_layers(std::size_t i, std::size_t a, std::size_t b) {
    const auto cost = chord(i, a, b);
    if (!cost) return std::nullopt;
    const Config &row_a = *rows_[i][a], &row_b = *rows_[i + 1][b];
    Lattice::InterpolatedEdge interpolated = lattice_.interpolate_edge(
        static_cast<int>(i), static_cast<int>(a), row_a, static_cast<int>(b), row_b);
    if (interpolated.fault != Lattice::InterpolatedEdge::Fault::kNone) return std::nullopt;
    for (const Config& q : interpolated.rows) {
      if (query_.find_violating_pair(q, ClearanceRule::kNode)) return std::nullopt;
      bool allowed = true;
      if (hooks_.check) hooks_.check->states({&q, 1}, {&allowed, 1});
      if (!allowed) return std::nullopt;
    }
    interpolated.rows.push_back(row_b);
    Config from = row_a;
    for (const Config& row : interpolated.rows) {
      const Config to = from + lattice_.delta(from, row);
      if (!motion_allowed(from, to)) return std::nullopt;
      from = to;
    }
    return cost;
  }
  [[nodiscard]] std::optional<double> edge_of_layer(std::size_t i, std::size_t a, std::size_t b) {
    const int layer = static_cast<int>(i);
    const Config &qa = *nodes_[i][a], &qb = *nodes_[i + 1][b];
    const Config &row_a = *rows_[i][a], &row_b = *rows_[i + 1][b];
    Config delta = qb - qa, row_delta = row_b - row_a;
    for (int j = 0; j < kDof; ++j) {
      for (Config* move : {&delta, &row_delta})
        if (lattice_.continuous()[static_cast<std::size_t>(j)])
          (*move)[j] = std::remainder((*move)[j], kTwoPi);
      const double most =
          lattice_.limits().joint_step * (j == lattice_.chain().slide() ? kSlideForTurn : 1);
      if (std::abs(delta[j]) > most + 2 * lattice_.fit_error()[j] || std::abs(row_delta[j]) > most)
        return std::nullopt;
    }
    if (!lattice_.follows_path(layer, static_cast<int>(a), row_a, static_cast<int>(b), row_b) ||
        !motion_allowed(row_a, row_a + row_delta))
      return std::nullopt;
    return lattice_.edge_cost(delta);
  }
  [[nodiscard]] bool motion_allowed(const Config& from, const Config& to) {
    if (lattice_.limits().edges == EdgeMode::kContinuous &&
        edge_blocked_plain(query_, rule_, from, to))
      return false;
    bool allowed = true;
    const StateCheck::Motion motion{from, to};
    if (hooks_.check && hooks_.check->checks_motions())
      hooks_.check->motions({&motion, 1}, {&allowed, 1});
    return allowed;
  }

  const Lattice& lattice_;
  World::Query query_;
  const EdgeRule& rule_;
  std::function<bool(int, int, int)> in_window_;
  Hooks hooks_;
  std::vector<std::vector<std::optional<Config>>> nodes_, rows_;
};

/// Plans by the definition: asks about every pair of nodes of neighbouring layers, then runs a
/// dynamic program and applies the order of answers. Parameters as of PlainLattice.
inline BruteForcePath brute_force(const Lattice& lattice, const World& world, const EdgeRule& rule,
                                  const std::function<bool(int layer, int a, int b)>& in_window,
                                  const Hooks& hooks = {}) {
  PlainLattice plain(lattice, world, rule, in_window, hooks);
  const auto& nodes = plain.nodes();
  const auto layers = nodes.size();
  const auto own_cost = [&](std::size_t i, std::size_t slot) { return plain.own_cost(i, slot); };
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::vector<std::vector<double>> g(layers);
  std::vector<std::vector<int>> next(layers);
  std::vector<std::vector<std::vector<EdgeFrom>>> into(layers);
  for (std::size_t i = 0; i < layers; ++i) {
    g[i].assign(nodes[i].size(), kNone);
    next[i].assign(nodes[i].size(), -1);
    into[i].resize(nodes[i].size());
  }
  for (std::size_t slot = 0; slot < nodes.back().size(); ++slot)
    if (nodes.back()[slot]) g.back()[slot] = own_cost(layers - 1, slot);
  for (std::size_t i = layers - 1; i-- > 0;)
    for (std::size_t a = 0; a < nodes[i].size(); ++a) {
      if (!nodes[i][a]) continue;
      const double own = own_cost(i, a);
      for (std::size_t b = 0; b < nodes[i + 1].size(); ++b) {
        if (!nodes[i + 1][b]) continue;
        const auto cost = plain.edge(i, a, b);
        if (!cost) continue;
        into[i + 1][b].push_back({a, *cost});
        if (own + *cost + g[i + 1][b] < g[i][a]) {
          g[i][a] = own + *cost + g[i + 1][b];
          next[i][a] = static_cast<int>(b);
        }
      }
    }
  BruteForcePath answer;
  if (lattice.is_closed())
    answer.closed_costs = closed_costs_of(into, own_cost, [&](std::size_t i, std::size_t slot) {
      return nodes[i][slot].has_value();
    });
  int slot =
      first_of_answer(lattice, g[0], [&](int k) { return *nodes[0][static_cast<std::size_t>(k)]; });
  answer.solved = slot >= 0;
  answer.cost = answer.solved ? g[0][static_cast<std::size_t>(slot)] : kNone;
  if (answer.solved) {
    answer.chosen = slot != std::min_element(g[0].begin(), g[0].end()) - g[0].begin();
    for (std::size_t i = 0; i < layers; ++i) {
      answer.slots.push_back(slot);
      slot = next[i][static_cast<std::size_t>(slot)];
    }
    return answer;
  }
  for (std::size_t i = 0; i < layers; ++i)
    if (std::none_of(nodes[i].begin(), nodes[i].end(),
                     [](const auto& node) { return node.has_value(); }))
      answer.empty.push_back(static_cast<int>(i));
  std::vector<char> reached(nodes[0].size(), 0);
  for (std::size_t first = 0; first < reached.size(); ++first)
    reached[first] = nodes[0][first].has_value();
  for (std::size_t i = 0;
       i < layers && std::find(reached.begin(), reached.end(), 1) != reached.end(); ++i) {
    answer.deepest = static_cast<int>(i);
    if (i + 1 == layers) break;
    std::vector<char> ahead(nodes[i + 1].size(), 0);
    for (std::size_t b = 0; b < ahead.size(); ++b)
      for (const EdgeFrom& from : into[i + 1][b]) ahead[b] |= reached[from.slot];
    reached.swap(ahead);
  }
  return answer;
}

}  // namespace swivel::test
