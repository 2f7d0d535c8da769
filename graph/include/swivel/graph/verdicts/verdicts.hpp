// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "swivel/core/base/zeroed_array.hpp"
#include "swivel/core/lattice/lattice.hpp"

namespace swivel {

/// What is known of a node or edge beyond the closed form: nothing, that it is valid, or that it is
/// removed.
enum class Verdict : std::uint8_t { kUnknown, kValid, kRemoved };  // zeroed memory is kUnknown

/// What the Validity has answered about the nodes and edges of a lattice: which of them are
/// removed, and what nodes themselves cost. Memory: a byte a node, and 9 more where a cost is known
/// in its layer.
class Verdicts {
 public:
  explicit Verdicts(const Lattice& lattice);
  /// Forgets everything. The less is known, the less time it takes.
  void clear();

  /// Returns what is known of a node.
  [[nodiscard]] Verdict node(int layer, int slot) const { return node_[index(layer, slot)]; }
  /// Returns the verdicts of a layer's slots, from `slot` on.
  [[nodiscard]] const Verdict* nodes(int layer, int slot) const {
    return node_.data() + index(layer, slot);
  }
  /// Returns the verdicts of all nodes, layer by layer in slot order.
  [[nodiscard]] std::span<const Verdict> nodes() const { return {node_.data(), node_.size()}; }
  /// Notes that a node is valid.
  void keep_node(int layer, int slot);
  /// Removes a node.
  void remove_node(int layer, int slot) { remove_nodes(layer, {&slot, 1}); }
  /// Removes nodes of a layer. Those removed already are left out. A removal makes stale the
  /// cost-to-go of the nodes of earlier layers whose best paths led through one of these;
  /// CostToGo::repair() makes it exact again. Verdicts about other nodes stay.
  void remove_nodes(int layer, std::span<const int> slots);

  /// Returns what is known of the edge from slot a of `layer` to slot b of the next.
  [[nodiscard]] Verdict edge(int layer, int a, int b) const;
  /// Notes that an edge is valid.
  void keep_edge(int layer, int a, int b);
  /// Removes an edge with its cost.
  void remove_edge(int layer, int a, int b, double cost);

  /// Takes what `others` say of another lattice whose layers are also layers of this one, with the
  /// same slots and joints: layer k there is layer `layer_here[k]` here. Of edges those are taken
  /// whose layers are neighbours here too. CostToGo::sweep() must follow.
  void take(const Verdicts& others, std::span<const int> layer_here);

  /// Returns the number of nodes and edges removed so far.
  [[nodiscard]] std::int64_t removed() const { return removed_; }

  /// The nodes and edges that are removed, by layer and in the order of slots.
  struct Removals {
    std::map<int, std::vector<int>> nodes;                  ///< slots
    std::map<int, std::vector<std::pair<int, int>>> edges;  ///< slots of tail and head
  };
  [[nodiscard]] Removals removals() const;

  /// Returns what a node costs besides the edges to and from it: by the lattice alone
  /// (Lattice::node_cost()) until the Validity has said more; exit costs included.
  [[nodiscard]] double cost(int layer, int slot) const {
    const double* costs = this->costs(layer);
    return costs ? costs[slot] : 0;
  }
  /// Returns the costs of all slots of a layer, null where all are 0.
  [[nodiscard]] const double* costs(int layer) const {
    return costs_.empty() || costs_[static_cast<std::size_t>(layer)].empty()
               ? nullptr
               : costs_[static_cast<std::size_t>(layer)].data();
  }
  /// Returns true if set_cost() has been called for the node.
  [[nodiscard]] bool knows_cost(int layer, int slot) const {
    return !cost_known_.empty() && cost_known_[index(layer, slot)] != 0;
  }
  /// Returns whether set_cost() or raise_exit_costs() was called since the last clear().
  [[nodiscard]] bool costs_changed() const { return costs_changed_; }
  /// Sets what a node costs, at most once for each node. It must not be less than by the lattice
  /// alone.
  void set_cost(int layer, int slot, double cost);

  /// Returns what must be paid for going on from a node of the last layer; 0 at first.
  [[nodiscard]] double exit_cost(int slot) const {
    return exit_costs_.empty() ? 0 : exit_costs_[static_cast<std::size_t>(slot)];
  }
  /// Returns true if raise_exit_costs() has been called.
  [[nodiscard]] bool has_exit_costs() const { return !exit_costs_.empty(); }
  /// Raises exit costs: they count like costs of the last layer's nodes. `costs` has one for each
  /// slot, a multiple of 2^-40 Lattice::cost_unit() or infinite, not less than before. Values
  /// follow at the next CostToGo::repair() or sweep().
  void raise_exit_costs(std::span<const double> costs);
  /// Sets all exit costs to 0 again; other verdicts, and what set_cost() has set, stay.
  /// CostToGo::sweep() must follow.
  void forget_exit_costs();

  /// A removed edge as one of its nodes sees it.
  struct HalfEdge {
    int other = 0;  ///< slot of the other node
    double cost = 0;
  };
  /// The edges removed between a layer and the next, by the slots of their tails and of their
  /// heads.
  struct RemovedEdges {
    std::map<int, std::vector<HalfEdge>> tails, heads;
  };
  /// Returns the edges removed between a layer and the next, null where there are none.
  [[nodiscard]] const RemovedEdges* removed_edges(int layer) const;

  /// What has changed in a layer since the cost-to-go was last repaired.
  struct Pending {
    std::vector<int> nodes;  ///< slots removed
    std::vector<int> tails;  ///< slots that lost an edge
    /// A slot that costs more than it did.
    struct Raise {
      int slot = 0;
      double by = 0;
    };
    std::vector<Raise> raised;
  };
  std::map<int, Pending> pending;

 private:
  struct EdgeKey {
    std::size_t node;
    int b;
    bool operator==(const EdgeKey&) const = default;
  };
  struct EdgeHash {
    std::size_t operator()(const EdgeKey& key) const {
      std::uint64_t h = key.node * 0x9e3779b97f4a7c15ull + static_cast<std::uint64_t>(key.b);
      h = (h ^ (h >> 31)) * 0xbf58476d1ce4e5b9ull;
      return h ^ (h >> 29);
    }
  };
  [[nodiscard]] std::size_t index(int layer, int slot) const {
    return first_[static_cast<std::size_t>(layer)] + static_cast<std::size_t>(slot);
  }

  void begin_costs();
  /// Returns the costs of a layer's slots, to be changed.
  [[nodiscard]] std::vector<double>& costs_of(int layer);

  const Lattice* lattice_;
  std::vector<std::size_t> first_;  // of each layer
  ZeroedArray<Verdict> node_;
  // indices of nodes, in the order in which they became known
  std::vector<std::size_t> known_;
  std::vector<std::vector<double>> costs_;    // [layer][slot], empty where all are 0
  std::vector<std::uint8_t> cost_known_;      // of every node; empty where none is
  std::unordered_map<int, double> set_last_;  // what set_cost() has set in the last layer, by slot
  std::vector<double> exit_costs_;            // by slot of the last layer; empty where all are 0
  std::unordered_map<EdgeKey, Verdict, EdgeHash> edge_;
  std::map<int, RemovedEdges> removed_edges_;  // by layer of the tail
  std::int64_t removed_ = 0;
  bool costs_changed_ = false;
};

}  // namespace swivel
