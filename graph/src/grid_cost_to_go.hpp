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
/// Memory per lattice node: 1.5 bytes, 8 more where it is reached, up to one for the bounds. Joints are solved again where they are
/// wanted again: that takes less time than a fresh page of memory.
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

  /// Joints of one node.
  struct OneNode {
    const LayerNodes* nodes = nullptr;
    int sheet = 0, place = 0;
    [[nodiscard]] bool valid() const { return nodes->valid(sheet, place); }
    [[nodiscard]] Config config() const { return nodes->config(sheet, place); }
  };
  [[nodiscard]] OneNode one_node(int layer, int slot);
  [[nodiscard]] int tile_columns() const { return (lattice_->angles() + kTileWidth - 1) / kTileWidth; }
  [[nodiscard]] std::size_t tile_of_layer(int sheet, int column) const {
    return static_cast<std::size_t>(sheet) * static_cast<std::size_t>(tile_columns()) + static_cast<std::size_t>(column);
  }
  [[nodiscard]] std::size_t tile_index(int layer, int sheet, int column) const {
    return static_cast<std::size_t>(layer) * static_cast<std::size_t>(lattice_->sheets() * tile_columns()) +
           tile_of_layer(sheet, column);
  }
  double& value_at(int layer, int slot);  // holds its tile from now on

  LayerJoints& joints(int layer);
  void forget_joints();  // what is solved again does not hang on how many layers there is room for
  void solve_ahead(int layer, int by, const Workspace& reached);                // by 1 or -1
  void solve_open(LayerJoints& joints, int family, int first, int last) const;  // columns
  void solve_columns(LayerJoints& joints, int family, int first, int last);     // columns
  void begin_layer(int layer, Workspace& workspace);
  void begin_with_all(int layer, Workspace& workspace);  // every node at cost 0
  void relax_run(int step_layer, const Workspace& from, int sheet, int first, int count, const Workspace& to, int other,
                 double* best);
  void relax(int step_layer, Workspace& from, const Workspace& to);
  void find_ranges(LayerJoints& joints, int family, int column) const;
  /// No step takes a joint from one range into the other. Continuous joints have no plain ranges, which tell nothing.
  [[nodiscard]] bool out_of_step(int step_layer, int joint, const JointRange& a, const JointRange& b) const;
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
  void solve_window(int layer, int family, const SrsLattice::Run& run);
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
  static constexpr int kLayersAhead = 8;
  std::vector<LayerJoints> passing_;  // by layer % size: those at hand and those solved ahead
  std::array<std::unique_ptr<Workspace>, 2> workspace_;
  std::vector<int> columns_;  // scratch of reach_back
  /// As many neighbours as a vector has lanes, for one_node(): nodes are asked about together with others around them. By layer,
  /// family and column.
  struct Neighbours {
    std::int64_t of = -1;
    LayerNodes nodes;
  };
  static constexpr std::size_t kNeighbourhoods = 509;
  std::vector<Neighbours> neighbours_;
  /// The run that each_in_window() solved last: a best path's nodes are asked one after the other, each among the steps of the
  /// last.
  struct Window {
    int layer = -1, family = 0;
    SrsLattice::Run run;
    LayerNodes nodes;
  };
  Window window_;
};

}  // namespace swivel
