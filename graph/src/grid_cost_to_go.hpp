// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "coarse_bound.hpp"
#include "swivel/core/srs_lattice.hpp"
#include "swivel/graph/cost_to_go.hpp"
#include "tile_table.hpp"

namespace swivel {

/// Cost-to-go of a grid in vector code, windowed, all sheet pairs.
///
/// Extent::kBounded leaves out what cannot matter: nodes that CoarseBound proves to lie on no path of cost `limit` or less. best()
/// is exact then as well, and so is at() on every best path: as long as best() <= limit no path that matters is missing, and where
/// it comes to be more, the limit is raised and the sweep repeated. Beyond 2.5 times the bound, and for goals before the last
/// layer, what deepest_reachable() finds takes its place: exact costs from layer 0 on, or that nothing is left.
///
/// Memory per lattice node: 1.5 bytes, 8 more where it is reached, up to one for the bounds. LayerJoints are solved again where
/// they are wanted again, but after the first repair, or search for the deepest layer, of a lattice of up to a million nodes: there
/// they are kept, 40 bytes a node of the layers that were visited.
class GridCostToGo final : public CostToGo {
 public:
  /// Takes over what `retired` had allocated; null is allowed.
  explicit GridCostToGo(const SrsLattice& lattice, Extent extent = Extent::kWhole, const Budget& budget = {},
                        GridCostToGo* retired = nullptr);
  ~GridCostToGo() override;

  [[nodiscard]] const SrsLattice& lattice() const override { return *lattice_; }
  [[nodiscard]] double at(int layer, int slot) const override {
    const int j = lattice_->angle_of(slot);
    return tiles_[tile_index(layer, lattice_->sheet_of(slot), j / kTileWidth)][static_cast<std::size_t>(j % kTileWidth)];
  }
  [[nodiscard]] double best() const override;
  [[nodiscard]] int deepest_reachable() override;
  [[nodiscard]] Config config(int layer, int slot) override;
  [[nodiscard]] std::optional<Config> node(int layer, int slot) override;
  void steps(int layer, int slot, double bound, std::vector<Step>& out) override;

 private:
  static constexpr int kTileWidth = TileTable::kTileWidth;

  void compute(int goal_layer) override;
  void compute_removals() override;
  void save() override;
  void restore() override;

  struct LayerJoints;
  struct JointRange;
  struct Tile;
  struct MiddleRanges;
  struct Workspace;
  using ColumnSet = std::vector<std::uint8_t>;  // [column]

  /// LayerJoints of the nodes j = first ... first + count - 1 of a layer for the sheets of one family, count <= 2 window + 1; entry
  /// k of the run is at nodes->q(sheet, joint)[shift + k].
  struct NodeRun {
    const LayerNodes* nodes = nullptr;
    int shift = 0;
  };
  [[nodiscard]] NodeRun nodes(int layer, int family, int first, int count, LayerNodes& scratch);
  [[nodiscard]] int tile_columns() const { return (lattice_->angles() + kTileWidth - 1) / kTileWidth; }
  [[nodiscard]] std::size_t tile_of_layer(int sheet, int column) const {
    return static_cast<std::size_t>(sheet) * static_cast<std::size_t>(tile_columns()) + static_cast<std::size_t>(column);
  }
  [[nodiscard]] std::size_t tile_index(int layer, int sheet, int column) const {
    return static_cast<std::size_t>(layer) * static_cast<std::size_t>(lattice_->sheets() * tile_columns()) +
           tile_of_layer(sheet, column);
  }
  double& value_at(int layer, int slot);  // holds its tile from now on

  /// From now on, in lattices that leave room for it: where one repair is needed more follow, and after a layer that is not
  /// reached.
  void keep_joints();
  LayerJoints& joints(int layer);
  void solve_ahead(int layer, int by, const Workspace& reached);                // by 1 or -1
  void solve_open(LayerJoints& joints, int family, int first, int last) const;  // columns
  void solve_columns(LayerJoints& joints, int family, int first, int last);     // columns
  void begin_layer(int layer, Workspace& workspace);
  void begin_with_all(int layer, Workspace& workspace);  // every node at cost 0
  void relax_run(int step_layer, const Workspace& from, int sheet, int first, int count, const Workspace& to, int other,
                 double* best);
  void relax(int step_layer, Workspace& from, const Workspace& to);
  void find_ranges(LayerJoints& joints, int family, int column) const;
  [[nodiscard]] bool may_meet(int step_layer, const MiddleRanges& a, const MiddleRanges& b) const;
  [[nodiscard]] bool may_connect(int step_layer, const Workspace& from, int sheet, int column, const Workspace& to,
                                 int other) const;
  void reach_back(int step_layer, const Workspace& to, Workspace& from);
  /// Columns of the circle that lie in the windows of these.
  [[nodiscard]] ColumnSet widened(const ColumnSet& columns) const;
  void apply_masks(Workspace& workspace) const;
  void add_node_costs(Workspace& workspace) const;
  void prune_above_limit(Workspace& workspace) const;
  void publish_values(Workspace& workspace);
  void store_tiles(const Workspace& workspace);
  void load_tiles(int layer, const ColumnSet& columns, Workspace& workspace);
  template <class Worth, class Visit>
  void each_in_window(int layer, int slot, const Config& q, const Worth& worth, const Visit& visit);
  [[nodiscard]] double relax_one(int layer, int slot);  // at() as it should be
  [[nodiscard]] double relax_one_forward(int layer, int slot, const Workspace& before);
  void relax_removed(Workspace& workspace);
  void clear_values();  // everything is unreachable
  void sweep_once();
  void limit_by_reach();
  /// False where the goal is out of reach, whatever the limit.
  bool raise_limit();
  void raise_limit_until_exact();
  /// What the nodes of a layer cost from layer 0 on, or less; null where nothing is known of the layer.
  [[nodiscard]] const float* cost_before(int layer) const;
  void keep_reach(int layer, const Workspace& workspace);
  [[nodiscard]] bool knows_reach() const { return reach_.known && reach_.removed == verdicts_.removed(); }
  void forget_reach() {
    reach_.known = false;
    reach_.slack = Reach::kSlack;
  }
  void propagate_removals();

  const SrsLattice* lattice_;
  bool bounded_;
  std::unique_ptr<CoarseBound> coarse_bound_;  // made by the first bounded sweep
  double limit_ = kUnreachable;
  /// What deepest_reachable() found last: costs from layer 0 on, of every few layers and of the deepest.
  struct Reach {
    static constexpr int kStride = 4;
    static constexpr double kSlack = 0.5;
    bool known = false;
    std::int64_t removed = 0;  // what was removed by then
    int deepest = -1;
    double best = kUnreachable;  // of the deepest
    std::vector<float> rows;     // [layer / kStride][slot], the deepest last; rounded down
    double slack = kSlack;       // of the next limit over `best`
  };
  Reach reach_;
  bool by_reach_ = false;  // nodes are held to the limit by reach_, not by the coarse bound
  TileTable tiles_;
  struct {
    int goal = 0;
    double limit = kUnreachable;
    TileTable::Held tiles;
  } saved_;
  std::vector<std::unique_ptr<LayerJoints>> cache_;  // by layer; empty where joints are not kept
  static constexpr int kLayersAhead = 8;
  std::vector<LayerJoints> passing_;  // by layer % size, where they are not kept: those at hand and those solved ahead
  std::vector<std::unique_ptr<LayerJoints>> spares_;  // of a search before, for the cache
  std::array<std::unique_ptr<Workspace>, 2> workspace_;
  std::vector<int> columns_;  // scratch of reach_back
  LayerNodes scratch_;
  /// The run that each_in_window() solved last, in `window_scratch_` or kept: a best path's nodes are asked one after the other,
  /// each among the steps of the last.
  struct Solved {
    int layer = -1, family = 0;
    SrsLattice::Run run;
    NodeRun nodes;
  };
  Solved solved_;
  LayerNodes window_scratch_;
};

}  // namespace swivel
