// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "swivel/core/lattice.hpp"

namespace swivel {

inline constexpr double kUnreachable = std::numeric_limits<double>::infinity();

/// What is known of a node or edge beyond the closed form.
enum class Verdict : std::uint8_t { kUnknown, kValid, kRemoved };

/// The exact cost from every node to the goal layer over the lattice minus what has been removed from it: a backward layered
/// dynamic program over closed-form nodes, windowed, all label pairs. Repaired, not recomputed, after removals; so it is always the
/// perfect heuristic of the lattice that remains. Memory: 9 bytes a node, and the joints of a layer where it is worth keeping them:
/// lattices of up to a million nodes, and polished arms, whose joints are costly.
class CostToGo {
 public:
  explicit CostToGo(const Lattice& lattice);
  ~CostToGo();

  [[nodiscard]] const Lattice& lattice() const { return *lattice_; }

  /// Cost-to-go with every node of `goal_layer` as a goal; removals are kept. False when `stop`, asked once a layer, said so.
  bool sweep(int goal_layer, const std::function<bool()>& stop = {});
  [[nodiscard]] int goal_layer() const { return goal_; }
  [[nodiscard]] double at(int layer, int slot) const { return g_[index(layer, slot)]; }
  /// Least over layer 0; kUnreachable when no path is left.
  [[nodiscard]] double best() const;

  [[nodiscard]] Verdict node_verdict(int layer, int slot) const { return verdict_[index(layer, slot)]; }
  void keep_node(int layer, int slot) { verdict_[index(layer, slot)] = Verdict::kValid; }
  void remove_node(int layer, int slot);
  /// Removes every node of the layer that agrees with `slot` in what `depends` (see Dependence) names.
  void remove_alike(int layer, int slot, std::uint8_t depends);
  [[nodiscard]] Verdict edge_verdict(int layer, int a, int b) const;
  void keep_edge(int layer, int a, int b);
  void remove_edge(int layer, int a, int b);
  /// Makes at() exact again after removals.
  void repair();

  /// Deepest layer that layer 0 reaches over what remains; -1 when layer 0 is empty.
  [[nodiscard]] int deepest_reachable();

  /// Joints of the nodes j = first ... first + count - 1 of a layer, count <= 2 window + 1; entry k of the run is at
  /// nodes->q(label, joint)[shift + k].
  struct Nodes {
    const LayerNodes* nodes = nullptr;
    int shift = 0;
  };
  [[nodiscard]] Nodes nodes(int layer, int first, int count, LayerNodes& scratch);

  /// Work so far: nodes solved and edges compared, repeats counted.
  [[nodiscard]] std::int64_t ik_nodes() const { return ik_nodes_; }
  [[nodiscard]] std::int64_t edges() const { return edges_; }

 private:
  static constexpr int kChunk = 16;  // angles; the unit of repair and of the label-pair test

  struct Range {
    double low = 0, high = 0;
    [[nodiscard]] double gap(const Range& other) const { return std::max(low - other.high, other.low - high); }
  };
  /// A joint over a chunk, and over the chunk widened by the window on both sides.
  struct ChunkRange {
    Range own, near;
  };
  [[nodiscard]] static Range range(const double* q, int begin, int end);
  /// The joints of one layer, from -window to angles + window around the circle, and their ranges by chunk.
  struct Joints {
    int layer = -1;
    LayerNodes nodes;
    std::vector<ChunkRange> ranges;   // [label][separating joint][chunk]
    std::vector<std::uint8_t> alive;  // [label] has a node at all
  };
  /// One layer ready for relaxation.
  struct Block {
    int layer = -1;
    Joints own;
    const Joints* joints = nullptr;
    std::vector<double> value;  // [label][padded angle]
    [[nodiscard]] const LayerNodes& nodes() const { return joints->nodes; }
  };
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
  struct Pending {
    std::vector<int> nodes;  // removed slots
    std::vector<int> tails;  // slots that lost an edge
  };
  using Marks = std::vector<std::uint8_t>;  // [label][chunk]

  [[nodiscard]] std::size_t index(int layer, int slot) const {
    return static_cast<std::size_t>(layer) * static_cast<std::size_t>(lattice_->width()) + static_cast<std::size_t>(slot);
  }
  [[nodiscard]] std::size_t range_row(int label, std::size_t separating) const {
    return (static_cast<std::size_t>(label) * separating_.size() + separating) * static_cast<std::size_t>(chunks());
  }
  [[nodiscard]] int chunks() const { return (lattice_->angles() + kChunk - 1) / kChunk; }
  void solve(int layer, Joints& joints);
  /// The joints of a layer that are kept, solved at the first call. Only where cache_ is in use.
  [[nodiscard]] const Joints& kept(int layer);
  void load(int layer, Block& block);
  void load_values(const double* row, Block& block) const;
  [[nodiscard]] bool may_connect(int layer, const Block& from, int label, int chunk, const Block& to, int other) const;
  void relax_run(int step_layer, const Block& from, int label, int first, int count, const Block& to, int other, double* best);
  void relax_chunk(int step_layer, const Block& from, int label, int chunk, const Block& to, double* row);
  void relax_layer(int step_layer, const Block& from, const Block& to, double* row);
  [[nodiscard]] double relax_one(int layer, int slot);
  [[nodiscard]] double relax_one_forward(int layer, int slot, const std::vector<double>& value);
  void drop_invalid(const Block& block, double* row) const;
  Marks reached_by(const Marks& changed, int layer, const Block& from, const Block& to) const;

  const Lattice* lattice_;
  int goal_ = 0;
  std::vector<double> g_;
  std::vector<Verdict> verdict_;
  std::unordered_map<EdgeKey, Verdict, EdgeHash> edge_verdict_;
  std::map<int, std::vector<std::pair<int, int>>> removed_edges_;  // layer -> (a, b)
  std::map<int, Pending> pending_;
  std::vector<int> separating_;                 // joints whose intervals tell labels apart
  std::vector<std::unique_ptr<Joints>> cache_;  // by layer; empty where joints are not kept
  Block block_[2];
  std::int64_t ik_nodes_ = 0, edges_ = 0;
};

}  // namespace swivel
