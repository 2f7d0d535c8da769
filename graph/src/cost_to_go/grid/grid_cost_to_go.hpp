// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "cost_to_go/grid/chord_lower_bound.hpp"
#include "cost_to_go/grid/tile_table.hpp"
#include "cost_to_go/limit_slack.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {

/// The cost-to-go of a grid in vector code, within the arm-slope window, over all pairs of IK
/// solutions.
///
/// Pruning::kByBound leaves out what cannot matter: nodes that ChordLowerBound proves to lie on no
/// path of cost `limit` or less. best() is then exact as well, and so is at() on every best path:
/// as long as no cost that is coarsely best() exceeds the limit, no path that matters is missing;
/// where one does, the limit is raised and the sweep repeated. From a given start, beyond 2.5 times
/// the bound, and for goals before the last layer, what deepest_reachable() finds takes its place:
/// exact costs from layer 0 on, or that nothing is left.
///
/// Memory per lattice node: 1.5 bytes, 8 more where it is reached, up to one for the bounds. Joints
/// are solved again when they are wanted again: that takes less time than a fresh page of memory.
class GridCostToGo final : public CostToGo {
 public:
  /// Takes over the memory of `recycled`, which may be null.
  explicit GridCostToGo(const SrsLattice& lattice, Pruning pruning = Pruning::kNone,
                        const Budget& budget = {}, GridCostToGo* recycled = nullptr);
  ~GridCostToGo() override;

  [[nodiscard]] const SrsLattice& lattice() const override { return *lattice_; }
  [[nodiscard]] double at(int layer, int slot) const override {
    const int solution = lattice_->solution_of(slot), j = lattice_->angle_of(slot);
    return tiles_of(solution)[tile_index(layer, solution, j / kTileWidth)]
                             [static_cast<std::size_t>(j % kTileWidth)];
  }
  [[nodiscard]] double best() const override;
  [[nodiscard]] int deepest_reachable() override;
  void bound_by(const CostToGo& circles) override;
  [[nodiscard]] Config config(int layer, int slot) override;
  [[nodiscard]] std::optional<Config> node(int layer, int slot) override;
  void steps(int layer, int slot, double bound, std::vector<Step>& out) override;

 private:
  static constexpr int kTileWidth = TileTable::kTileWidth;

  void compute(int goal_layer) override;
  void compute_removals() override;
  [[nodiscard]] std::shared_ptr<const SavedValues> save() const override;
  void restore(const SavedValues& saved) override;

  struct LayerJoints;
  struct JointRange;
  struct Tile;
  struct MiddleRanges;
  struct Workspace;
  struct ChangedAngles;
  class RemovalSweep;
  class ReachSweep;
  using ColumnSet = std::vector<std::uint8_t>;  // [column], 0: not in it
  /// A set of angles: bit k of a column is its k-th angle. It serves as the set of columns that
  /// hold any, too.
  using AngleSet = ColumnSet;

  /// The joints of one node.
  struct OneNode {
    const LayerNodes* nodes = nullptr;
    int solution = 0, place = 0;
    [[nodiscard]] bool valid() const { return nodes->valid(solution, place); }
    [[nodiscard]] Config config() const { return nodes->config(solution, place); }
  };
  [[nodiscard]] OneNode one_node(int layer, int slot);
  /// Returns the joints of a column of one elbow side, valid until the next call.
  [[nodiscard]] const LayerNodes& neighbours(int layer, int side, int column);
  [[nodiscard]] int tile_columns() const {
    return (lattice_->angles() + kTileWidth - 1) / kTileWidth;
  }
  [[nodiscard]] std::size_t tile_of_layer(int solution, int column) const {
    return static_cast<std::size_t>(solution) * static_cast<std::size_t>(tile_columns()) +
           static_cast<std::size_t>(column);
  }
  [[nodiscard]] int half_solutions() const { return lattice_->solutions() / 2; }
  [[nodiscard]] int first_solution(int side) const { return side * half_solutions(); }
  [[nodiscard]] const TileTable& tiles_of(int solution) const {
    return apart_ && lattice_->elbow_side_of(solution) ? tiles_[1] : tiles_[0];
  }
  [[nodiscard]] TileTable& tiles_of(int solution) {
    return apart_ && lattice_->elbow_side_of(solution) ? tiles_[1] : tiles_[0];
  }
  [[nodiscard]] std::size_t tile_index(int layer, int solution, int column) const {
    return static_cast<std::size_t>(layer) * tile_of_layer(lattice_->solutions(), 0) +
           tile_of_layer(solution, column);
  }
  double& value_at(int layer, int slot);  // the tile is held from now on

  // The two elbow sides (elbow sides, signs of the elbow angle) meet at hardly any layer: between,
  // each is a lattice of its own, which one thread goes through by itself. Nothing that one side
  // writes is read by the other.
  /// Most layers that the elbow sides go through, one after the other or side by side, until the
  /// next poll.
  static constexpr int kMostAlone = 64;
  /// Returns true if the elbow sides are apart from a layer to the next. Where an edge is removed
  /// there one thread looks at both.
  [[nodiscard]] bool elbow_sides_part(int step_layer) const {
    return !lattice_->may_change_elbow_side(step_layer) && !verdicts_.removed_edges(step_layer);
  }
  /// Calls part(elbow side) for both elbow sides, on two threads where work is shared.
  template <class Part>
  void by_elbow_side(const Part& part);
  void collect_counts();
  Workspace& workspace(int layer) { return *workspace_[static_cast<std::size_t>(layer % 2)]; }
  LayerJoints& joints(int side, int layer);
  void forget_joints();
  void solve_columns(Workspace& workspace, int side, int first, int last);
  void find_ranges(LayerJoints& joints, int side, int column) const;
  void begin(int side, int layer, Workspace& workspace) const;
  void begin_with_all(int side, int layer, Workspace& workspace);  // every node at cost 0
  /// Loads the values of columns, and their joints. Columns that are not among those `reached`, if
  /// given, get no value and need no joints.
  void load_tiles(int side, int layer, const ColumnSet& columns, Workspace& workspace,
                  const ColumnSet* reached = nullptr);
  void reach_back(int side, int step_layer, const Workspace& to, Workspace& from);
  void relax(int side, int step_layer, Workspace& from, const Workspace& to);
  void relax_run(int step_layer, Workspace& from, int solution, int first, int count,
                 const Workspace& to, int other, double* best);
  void apply_masks(int side, Workspace& workspace) const;
  void add_node_costs(int side, Workspace& workspace) const;
  void prune_above_limit(int side, Workspace& workspace) const;
  void publish_values(int side, Workspace& workspace) const;
  /// Returns true if no step takes a joint from one range into the other. Continuous joints have no
  /// plain ranges, which tell nothing.
  [[nodiscard]] bool out_of_step(int step_layer, int joint, const JointRange& a,
                                 const JointRange& b) const;
  [[nodiscard]] bool may_meet(int step_layer, const MiddleRanges& a, const MiddleRanges& b) const;
  [[nodiscard]] bool may_connect(int step_layer, const Workspace& from, int solution, int column,
                                 const Workspace& to, int other) const;
  /// Finds the angles in the windows of these; gaps between two of a column are filled, so there
  /// may be more.
  void widen(const AngleSet& angles, AngleSet& result) const;
  void store_tiles(int side, const Workspace& workspace);
  /// Replaces the values kept of these angles. Returns true if any differ, `changed` says which.
  /// What the workspace holds of other angles of their columns may be too much, since not all of
  /// their windows were loaded.
  [[nodiscard]] bool renew_tiles(int side, const Workspace& workspace, const AngleSet& angles,
                                 AngleSet& changed);
  template <class Worth, class Visit>
  void each_in_window(int layer, int slot, const Config& q, const Worth& worth, const Visit& visit);
  [[nodiscard]] double relax_one(int layer, int slot);  // at() as it should be
  [[nodiscard]] double relax_one_forward(int layer, int slot, const Workspace& before);
  void relax_removed(int layer);
  void clear_values();  // everything is unreachable
  void sweep_once();
  void limit_by_reach();
  /// Returns false where the goal is out of reach, whatever the limit.
  bool raise_limit();
  void raise_limit_until_exact();
  /// Returns what the nodes of a layer cost from layer 0 on, or less; null where nothing is known
  /// of the layer.
  [[nodiscard]] const float* cost_before(int layer) const;
  void begin_reach_rows(int layers);
  void keep_reach(int side, int layer, float* kept);
  [[nodiscard]] bool knows_reach() const {
    return reach_.known && reach_.removed == verdicts_.removed();
  }
  void forget_reach() {
    reach_.known = false;
    reach_.slack = kSlack;
  }
  void propagate_removals();

  const SrsLattice* lattice_;
  bool bounded_;
  /// Made by the first bounded sweep, or taken from the lattice of circles.
  std::shared_ptr<const ChordLowerBound> chord_bound_;
  std::vector<int> on_circles_;  // if taken: of each IK solution, that in its rows
  double least_ = 0;             // no path costs less
  double limit_ = kUnreachable;
  /// What deepest_reachable() found last: costs from layer 0 on, of every few layers and of the
  /// deepest.
  struct Reach {
    static constexpr int kStride = 4;
    bool known = false;
    std::int64_t removed = 0;  // what was removed by then
    int deepest = -1;
    double best = kUnreachable;  // of the deepest
    std::vector<float> rows;     // [layer / kStride][slot], the deepest last; rounded down
    double slack = kSlack;       // of the next limit over `best`
  };
  Reach reach_;
  bool by_reach_ = false;  // nodes are held to the limit by reach_, not by the coarse bound
  /// One for each elbow side where threads share the work, else all in the first: two that grow
  /// beside each other take more fresh memory.
  std::array<TileTable, 2> tiles_;
  bool apart_ = false;
  struct Saved : SavedValues {
    int goal = 0;
    double limit = kUnreachable;
    bool apart = false, by_reach = false;
    Reach reach;
    std::array<TileTable::Held, 2> tiles;
    std::shared_ptr<const ChordLowerBound> chord_bound;
  };
  std::vector<LayerJoints> passing_;                     // [elbow side][layer % 2]: those at hand
  std::array<std::unique_ptr<Workspace>, 2> workspace_;  // [layer % 2]
  /// Joints of columns around nodes that were asked about one by one, since others around them will
  /// be asked about too.
  struct Neighbours {
    std::int64_t of = -1;
    LayerNodes nodes;
  };
  static constexpr std::size_t kNeighbourhoods = 509;
  std::vector<Neighbours> neighbours_;
};

}  // namespace swivel
