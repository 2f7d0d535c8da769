// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "cost_to_go/kernels/relax.hpp"
#include "cost_to_go/kinds/joint_box.hpp"
#include "cost_to_go/kinds/layer_values.hpp"
#include "swivel/core/lattice/kinds/knot_grid.hpp"

namespace swivel {

/// The cost-to-go of a grid of rolls and arm angles, in vector code: the circle of arm angles of
/// each roll and IK solution against those of the rolls nearby, of the same branch. Memory: 9 bytes
/// a node, and some 40 bytes for the joints of each node of the layers that are kept.
class KnotGridCostToGo final : public LayerValues {
 public:
  explicit KnotGridCostToGo(const KnotGrid& lattice, const Budget& budget = {});

  [[nodiscard]] const KnotGrid& lattice() const override { return *lattice_; }
  [[nodiscard]] Config config(int layer, int slot) override;
  void steps(int layer, int slot, double bound, std::vector<Step>& out) override;

 private:
  /// Returns whether a slot has a node.
  [[nodiscard]] bool exists(int layer, int slot);
  void begin(int layer, Values& out) override;
  void relax(int step, int layer, int other_layer, const Values& others, Values& out) override;
  [[nodiscard]] double relax_one(int layer, int slot) override;
  [[nodiscard]] double relax_one_forward(int layer, int slot, const Values& before) override;
  void find_stale(int layer, const std::vector<Change>& ahead, std::vector<int>& stale) override;
  [[nodiscard]] std::size_t many(int layer) const override;
  /// Branches may change between shorter steps, and joints turn further in several.
  [[nodiscard]] bool more_knots_allow_more() const override { return true; }
  /// Returns the rolls that a step may join to a roll, the nearest ones first.
  [[nodiscard]] const std::vector<int>& nearest_first(int step, int rank, bool forward);
  // solving it again takes less than fresh pages
  void done_with(int layer) override { forget(layer); }

  /// Returns the nodes of a layer that is no given start or end, for one roll: arm angle j at entry
  /// pad_ + j, and around the circle on both sides.
  const LayerNodes& nodes(int layer, int rank);
  void forget(int layer);
  /// The values of a layer, continued around the circle, [rank][solution][pad_ + j].
  struct Around {
    Values value;
    // [rank][solution]: first finite one, and behind the last
    std::vector<std::pair<int, int>> finite;
    // [rank][solution][block of kTile]: where the nodes with finite values lie, and the least value
    std::vector<JointBox> boxes;
    Values least;
  };
  static constexpr int kTile = 16;  // nodes that are relaxed together
  /// What becomes of the branch along an edge: nothing, or KnotGrid::kFlips.
  static constexpr std::array<int, 3> kFlips{0, KnotGrid::kFlips[0], KnotGrid::kFlips[1]};
  /// Returns whether the node at entry k of an IK solution may have edges that change a bit of the
  /// branch; true for none.
  [[nodiscard]] bool may_flip(int bit, const LayerNodes& nodes, int solution, int k) const {
    if (bit == 0) return true;
    return KnotGrid::is_near_singular(bit == kShoulderBit
                                          ? nodes.q(solution, 1)[k] + lattice_->arm().shoulder.shift
                                          : nodes.q(solution, 5)[k] + lattice_->arm().wrist.shift);
  }
  /// Finds runs of nodes that may change a bit of the branch.
  void runs_of(const LayerNodes& nodes, int solution, int bit);
  /// Calls visit(slot) for the slots of `layer` that the window of `step` joins to the only node of
  /// the neighbouring layer `other`, which is a given start or end.
  template <class Visit>
  void each_beside_given(int step, int layer, int other, const Visit& visit);
  void take_around(int layer, const RelaxTask<double>& task, const Values& values);
  /// Sets what is known of the finite values of a row, whose joints `theirs` has.
  void describe_row(const LayerNodes& theirs, const RelaxTask<double>& task, Around& around,
                    int row);
  /// Relaxes a tile of nodes of an IK solution, the entries `begin` ... `end` - 1 of the circle of
  /// arm angles, with those of a row that a window joins to them and that may lower one of `best`.
  void relax_tile(const LayerNodes& own, int solution, const std::pair<int, int>& tile,
                  const JointBox& box, const Around& around, int row, int window,
                  RelaxTask<double>& task, double* best);
  /// Calls visit(slot b, its joints) for the nodes b of a neighbouring layer that a node may be
  /// joined to, removed or not, whose worth(b) is true. worth() must be false for slots without a
  /// node.
  template <class Worth, class Visit>
  void each_near(int step, int layer, int slot, int other, const Worth& worth, const Visit& visit);

  const KnotGrid* lattice_;
  int angles_, solutions_, pad_;
  int around_layer_ = -1;                     // the layer that around_ is of
  std::array<Around, kFlips.size()> around_;  // of the nodes that may change that bit
  std::vector<int> near_;                     // what nearest_first() returns
  std::vector<std::pair<int, int>> runs_;     // runs of arm angles: first, and behind the last
  struct Solved {
    std::vector<LayerNodes> of_roll;  // [rank]
    std::vector<char> done;
    bool kept = false;
  };
  std::vector<Solved> solved_;  // [layer]
  std::vector<int> kept_;       // layers, in the order in which they were first wanted
  std::size_t bytes_ = 0;
  std::vector<LayerNodes> recycled_;  // arrays of a layer that was forgotten, for the next
};

}  // namespace swivel
