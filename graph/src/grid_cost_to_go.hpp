// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "chord_bound.hpp"
#include "swivel/core/srs_lattice.hpp"
#include "swivel/graph/cost_to_go.hpp"

namespace swivel {

/// Cost-to-go of a grid in vector code, windowed, all label pairs.
///
/// Extent::kBounded leaves out what cannot matter: nodes that ChordBound proves to lie on no path of cost `limit` or less. best()
/// is exact then as well, and so is at() on every best path: as long as best() <= limit no path that matters is missing, and where
/// it comes to be more, the limit is raised and the sweep repeated. Bounded only where the goal is the last layer.
///
/// Memory per lattice node: 1.5 bytes, 8 more where it is reached, up to one for the bounds. Joints are solved again where they
/// are wanted again, but after the first repair of a lattice of up to a million nodes: there they are kept, 40 bytes a node of the
/// layers that were visited.
class GridCostToGo final : public CostToGo {
 public:
  /// Takes over what `retired` had allocated; null is allowed.
  explicit GridCostToGo(const SrsLattice& lattice, Extent extent = Extent::kWhole, const Budget& budget = {},
                        GridCostToGo* retired = nullptr);
  ~GridCostToGo() override;

  [[nodiscard]] const SrsLattice& lattice() const override { return *lattice_; }
  [[nodiscard]] double at(int layer, int slot) const override {
    const int j = lattice_->angle_of(slot);
    return cells_[cell_[cell_index(layer, lattice_->label_of(slot), j / kChunk)]][static_cast<std::size_t>(j % kChunk)];
  }
  [[nodiscard]] double best() const override;
  [[nodiscard]] int deepest_reachable() override;
  [[nodiscard]] Config config(int layer, int slot) override;
  void steps(int layer, int slot, double bound, std::vector<Step>& out) override;

 private:
  static constexpr int kChunk = 8;  // angles: a cache line of costs, one vector of the widest unit

  void compute(int goal_layer) override;
  void compute_removals() override;
  void save() override;
  void restore() override;

  struct Joints;
  struct Interval;
  struct Part;
  struct Middles;
  struct Block;
  using Cell = std::array<double, kChunk>;
  using Marks = std::vector<std::uint8_t>;  // [chunk]

  /// Joints of the nodes j = first ... first + count - 1 of a layer for the labels of one family, count <= 2 window + 1; entry k of
  /// the run is at nodes->q(label, joint)[shift + k].
  struct Nodes {
    const LayerNodes* nodes = nullptr;
    int shift = 0;
  };
  [[nodiscard]] Nodes nodes(int layer, int family, int first, int count, LayerNodes& scratch);
  [[nodiscard]] int chunks() const { return (lattice_->angles() + kChunk - 1) / kChunk; }
  [[nodiscard]] std::size_t mark(int label, int chunk) const {
    return static_cast<std::size_t>(label) * static_cast<std::size_t>(chunks()) + static_cast<std::size_t>(chunk);
  }
  [[nodiscard]] std::size_t cell_index(int layer, int label, int chunk) const {
    return static_cast<std::size_t>(layer) * static_cast<std::size_t>(lattice_->labels() * chunks()) + mark(label, chunk);
  }
  double& cell_value(int layer, int slot);  // makes the cell

  Joints& joints(int layer, Block& block);
  void want(Joints& joints, int family, int first, int last);  // chunks
  void clear(int layer, Block& block);
  void start_from(int layer, Block& block);  // every node at cost 0
  void relax_run(int step_layer, const Block& from, int label, int first, int count, const Block& to, int other, double* best);
  void relax(int step_layer, Block& from, const Block& to);
  void range(Joints& joints, int family, int chunk) const;
  [[nodiscard]] bool may_meet(int step_layer, const Middles& a, const Middles& b) const;
  [[nodiscard]] bool may_connect(int step_layer, const Block& from, int label, int chunk, const Block& to, int other) const;
  void mark_reach(int step_layer, const Block& to, Block& from);
  /// Chunks of the circle that lie in the windows of these.
  [[nodiscard]] Marks widened(const Marks& columns) const;
  void bar(Block& block) const;
  void add_costs(Block& block) const;
  void cut(Block& block) const;
  void settle(Block& block);
  void store(const Block& block);
  void load(int layer, const Marks& columns, Block& block);
  template <class Worth, class Visit>
  void each_in_window(int layer, int slot, const Config& q, const Worth& worth, const Visit& visit);
  [[nodiscard]] double relax_one(int layer, int slot);  // at() as it should be
  [[nodiscard]] double relax_one_forward(int layer, int slot, const Block& before);
  void relax_removed(Block& block);
  void forget();  // everything is unreachable
  void sweep_once();
  void raise_limit();
  void make_exact();
  void repair_once();

  const SrsLattice* lattice_;
  bool bounded_;
  std::unique_ptr<ChordBound> chords_;  // made by the first bounded sweep
  double limit_ = kUnreachable;
  std::vector<std::uint32_t> cell_;  // [layer][label][chunk] -> cells_; 0: unreachable
  std::vector<Cell> cells_;
  struct {
    int goal = 0;
    double limit = kUnreachable;
    std::vector<std::uint32_t> cell;
    std::vector<Cell> cells;
  } saved_;
  std::vector<std::unique_ptr<Joints>> cache_;   // by layer; empty where joints are not kept
  std::vector<std::unique_ptr<Joints>> spares_;  // of a search before, for the cache
  std::array<std::unique_ptr<Block>, 2> block_;
  std::vector<int> columns_;  // scratch of mark_reach
  LayerNodes scratch_;
  /// The run that each_in_window() solved last, in `window_scratch_` or kept: a best path's nodes are asked one after the other,
  /// each among the steps of the last.
  struct Solved {
    int layer = -1, family = 0;
    SrsLattice::Run run;
    Nodes nodes;
  };
  Solved solved_;
  LayerNodes window_scratch_;
};

}  // namespace swivel
