// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "swivel/core/lattice.hpp"
#include "swivel/graph/chord_bound.hpp"
#include "swivel/graph/validity.hpp"

namespace swivel {

inline constexpr double kUnreachable = std::numeric_limits<double>::infinity();

/// The cost from the nodes to the goal layer over the lattice minus what has been removed from it: a backward layered dynamic
/// program over closed-form nodes, windowed, all label pairs. Repaired, not recomputed, after removals; so it is always the perfect
/// heuristic of the lattice that remains.
///
/// Extent::kBounded leaves out what cannot matter: nodes that ChordBound proves to lie on no path of cost `limit` or less. best()
/// is exact then as well, and so is at() on every best path: as long as best() <= limit no path that matters is missing, and where
/// it comes to be more, the limit is raised and the sweep repeated. Other nodes may read as unreachable, or as costlier than they
/// are.
///
/// Memory per lattice node: 1.5 bytes, 8 more where it is reached, up to one for the bounds. Joints are solved again where they
/// are wanted again, but for polished arms, whose joints are costly, and after the first repair of a lattice of up to a million
/// nodes: there they are kept, 40 bytes a node of the layers that were visited; up to 64 MB of that stays with the process for the
/// next search.
///
/// Whatever takes long throws Stopped once the budget is spent; verdicts are kept, and at() means nothing then.
class CostToGo {
 public:
  enum class Extent { kWhole, kBounded };
  explicit CostToGo(const Lattice& lattice, Extent extent = Extent::kWhole, const Budget& budget = {});
  ~CostToGo();

  [[nodiscard]] const Lattice& lattice() const { return *lattice_; }
  [[nodiscard]] const Budget& budget() const { return budget_; }

  /// Cost-to-go with every node of `goal_layer` as a goal; removals are kept. Bounded only where the goal is the last layer.
  void sweep(int goal_layer);
  [[nodiscard]] int goal_layer() const { return goal_; }
  [[nodiscard]] double at(int layer, int slot) const {
    const int j = lattice_->angle_of(slot);
    return cells_[cell_[cell_index(layer, lattice_->label_of(slot), j / kChunk)]][static_cast<std::size_t>(j % kChunk)];
  }
  /// Least over layer 0; kUnreachable when no path is left.
  [[nodiscard]] double best() const;

  [[nodiscard]] Verdict node_verdict(int layer, int slot) const { return verdict_[index(layer, slot)]; }
  void keep_node(int layer, int slot) { verdict_[index(layer, slot)] = Verdict::kValid; }
  /// Of every node, [layer][slot].
  [[nodiscard]] std::vector<Verdict> node_verdicts() const { return verdict_; }
  void remove_node(int layer, int slot);
  /// Removes every node of the layer that agrees with `slot` in what `depends` (see Dependence) names.
  void remove_alike(int layer, int slot, std::uint8_t depends);
  [[nodiscard]] Verdict edge_verdict(int layer, int a, int b) const;
  void keep_edge(int layer, int a, int b);
  void remove_edge(int layer, int a, int b);
  /// Nodes and edges removed so far.
  [[nodiscard]] std::int64_t removed() const { return removed_; }
  /// Makes best() exact again after removals.
  void repair();

  /// Deepest layer that layer 0 reaches over what remains; -1 when layer 0 is empty.
  [[nodiscard]] int deepest_reachable();

  /// Joints of the nodes j = first ... first + count - 1 of a layer for the labels of one sign of the elbow, count <= 2 window + 1;
  /// entry k of the run is at nodes->q(label, joint)[shift + k].
  struct Nodes {
    const LayerNodes* nodes = nullptr;
    int shift = 0;
  };
  [[nodiscard]] Nodes nodes(int layer, int elbow, int first, int count, LayerNodes& scratch);
  /// One node's joints.
  [[nodiscard]] Config config(int layer, int slot);

  /// Work so far: nodes solved and edges compared, repeats counted.
  [[nodiscard]] std::int64_t ik_nodes() const { return ik_nodes_; }
  [[nodiscard]] std::int64_t edges() const { return edges_; }

 private:
  static constexpr int kChunk = 8;  // angles: a cache line of costs, one vector of the widest unit

  struct Joints;
  class Spare;
  struct Interval;
  struct Part;
  struct Middles;
  struct Block;
  using Cell = std::array<double, kChunk>;
  using Marks = std::vector<std::uint8_t>;  // [chunk]

  struct EdgeKey {
    std::int64_t node;
    int b;
    bool operator==(const EdgeKey&) const = default;
  };
  struct EdgeHash {
    std::size_t operator()(const EdgeKey& key) const {
      std::uint64_t h = static_cast<std::uint64_t>(key.node) * 0x9e3779b97f4a7c15ull + static_cast<std::uint64_t>(key.b);
      h = (h ^ (h >> 31)) * 0xbf58476d1ce4e5b9ull;
      return h ^ (h >> 29);
    }
  };
  struct HalfEdge {
    int other;  // slot
    double cost;
  };
  struct RemovedEdges {
    std::map<int, std::vector<HalfEdge>> tails, heads;  // by slot
  };
  struct Pending {
    std::vector<int> nodes;  // removed slots
    std::vector<int> tails;  // slots that lost an edge
  };

  [[nodiscard]] std::size_t index(int layer, int slot) const {
    return static_cast<std::size_t>(layer) * static_cast<std::size_t>(lattice_->width()) + static_cast<std::size_t>(slot);
  }
  [[nodiscard]] int chunks() const { return (lattice_->angles() + kChunk - 1) / kChunk; }
  [[nodiscard]] std::size_t mark(int label, int chunk) const {
    return static_cast<std::size_t>(label) * static_cast<std::size_t>(chunks()) + static_cast<std::size_t>(chunk);
  }
  [[nodiscard]] std::size_t cell_index(int layer, int label, int chunk) const {
    return static_cast<std::size_t>(layer) * static_cast<std::size_t>(lattice_->labels() * chunks()) + mark(label, chunk);
  }
  double& cell_value(int layer, int slot);  // makes the cell

  Joints& joints(int layer, Block& block);
  void want(Joints& joints, int elbow, int first, int last);  // chunks
  void clear(int layer, Block& block);
  void start_from(int layer, Block& block);  // every node at cost 0
  void relax_run(int step_layer, const Block& from, int label, int first, int count, const Block& to, int other, double* best);
  void relax(int step_layer, Block& from, const Block& to);
  void range(Joints& joints, int elbow, int chunk) const;
  [[nodiscard]] bool may_meet(int step_layer, const Middles& a, const Middles& b) const;
  [[nodiscard]] bool may_connect(int step_layer, const Block& from, int label, int chunk, const Block& to, int other) const;
  [[nodiscard]] bool elbows_may_connect(int step_layer, int layer, int elbow, int other_layer, int other) const;
  void mark_reach(int step_layer, const Block& to, Block& from);
  /// Chunks of the circle that lie in the windows of these.
  [[nodiscard]] Marks widened(const Marks& columns) const;
  void bar(Block& block) const;
  void cut(Block& block) const;
  void settle(Block& block);
  void store(const Block& block);
  void load(int layer, const Marks& columns, Block& block);
  [[nodiscard]] double relax_one(int layer, int slot);
  [[nodiscard]] double relax_one_forward(int layer, int slot, const Block& before);
  void relax_removed(Block& block);
  void forget();  // everything is unreachable
  void sweep_once();
  void raise_limit();
  void make_exact();
  void repair_once();

  const Lattice* lattice_;
  Budget budget_;
  bool bounded_;
  std::unique_ptr<ChordBound> chords_;  // made by the first bounded sweep
  double limit_ = kUnreachable;
  int goal_ = 0;
  std::vector<std::uint32_t> cell_;  // [layer][label][chunk] -> cells_; 0: unreachable
  std::vector<Cell> cells_;
  std::vector<Verdict> verdict_;
  std::unordered_map<EdgeKey, Verdict, EdgeHash> edge_verdict_;
  std::map<int, RemovedEdges> removed_edges_;  // by layer of the tail
  std::map<int, Pending> pending_;
  std::vector<std::unique_ptr<Joints>> cache_;  // by layer; empty where joints are not kept
  std::array<std::unique_ptr<Block>, 2> block_;
  std::vector<int> columns_;  // scratch of mark_reach
  LayerNodes scratch_;
  std::int64_t ik_nodes_ = 0, edges_ = 0, removed_ = 0;
};

}  // namespace swivel
