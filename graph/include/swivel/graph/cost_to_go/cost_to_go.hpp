// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/verdicts/parallel_for.hpp"
#include "swivel/graph/verdicts/verdicts.hpp"

namespace swivel {

/// The cost-to-go of a node from which no path leads to the goal.
inline constexpr double kUnreachable = std::numeric_limits<double>::infinity();

/// The cost-to-go: the least cost from each node to the goal layer over the lattice minus what has
/// been removed from it, with what the nodes themselves cost, the first and the last included. It
/// is a backward dynamic program over layers that is repaired, not recomputed, after removals and
/// where nodes turn out to cost more; so it is always the perfect heuristic of what is known. How
/// it is computed depends on the kind of lattice, see make_cost_to_go(). Functions that take long
/// throw Stopped once the budget is spent: verdicts are kept, and at() means nothing then.
class CostToGo {
 public:
  virtual ~CostToGo() = default;
  CostToGo(const CostToGo&) = delete;
  CostToGo& operator=(const CostToGo&) = delete;

  /// Returns the lattice.
  [[nodiscard]] virtual const Lattice& lattice() const = 0;
  /// Returns the budget of the present plan.
  [[nodiscard]] const Budget& budget() const { return budget_; }

  /// Forgets removals and counts, and begins again within another budget. Returns true if values
  /// are now those of a lattice without removals with the last layer as its goal, as found before;
  /// else sweep() must follow.
  [[nodiscard]] bool restart(const Budget& budget);
  /// Sets the threads to share work with from now on; without this call there are none. Values are
  /// the same, bit for bit.
  void share(const ParallelFor& work) { work_ = work; }
  /// Declares that restart() will not be called, so that nothing need be kept for it.
  void set_single_use() { restarts_ = false; }
  /// Values of a lattice without removals. They are never written, so that threads may share them.
  struct SavedValues {
    SavedValues() = default;
    SavedValues(const SavedValues&) = delete;
    SavedValues& operator=(const SavedValues&) = delete;
    virtual ~SavedValues() = default;
  };
  /// Returns the values with which restart() begins again, null where they are not known. sweep()
  /// or restart() must follow.
  [[nodiscard]] std::shared_ptr<const SavedValues> values_without_removals();
  /// Takes what values_without_removals() of another cost-to-go of this lattice returned, with
  /// which restart() begins from now on.
  void begin_with(std::shared_ptr<const SavedValues> values);

  /// Takes the lower bounds of a swept cost-to-go whose lattice this one was made from by telling
  /// turns apart (Lattice::with_windings()).
  virtual void bound_by(const CostToGo& circles) { static_cast<void>(circles); }
  /// Takes lower bounds from the cost-to-go of a lattice from which this one's was made by halving
  /// steps (Lattice::with_knots()), after Verdicts::take(): layer k there is layer `layer_here[k]`
  /// here. Nodes must cost nothing.
  virtual void bound_by_coarser(CostToGo& coarser, std::span<const int> layer_here) {
    static_cast<void>(coarser), static_cast<void>(layer_here);
  }
  /// Computes the cost-to-go with every node of `goal_layer` as a goal. Verdicts are kept.
  void sweep(int goal_layer);
  /// Returns the layer whose nodes are the goals.
  [[nodiscard]] int goal_layer() const { return goal_; }
  /// Returns the cost-to-go of a node, kUnreachable where no path is known. It is exact on every
  /// best path from a node of layer 0 whose coarse cost (Lattice::coarse_cost()) is that of best().
  [[nodiscard]] virtual double at(int layer, int slot) const = 0;
  /// Returns the least cost-to-go over layer 0, exact; kUnreachable when no path is left.
  [[nodiscard]] virtual double best() const = 0;

  /// Returns the slot of layer 0 at which the best path begins, in the order of answers: of the
  /// nodes whose coarse cost is that of best(), the one nearest to the middle of the joints'
  /// ranges, the first of several; -1 when no path is left.
  [[nodiscard]] int first_slot();

  /// Returns what has been asked and removed, and what nodes cost. Values follow at the next
  /// repair().
  [[nodiscard]] Verdicts& verdicts() { return verdicts_; }
  [[nodiscard]] const Verdicts& verdicts() const { return verdicts_; }
  /// Removes the edge from slot a of a layer to slot b of the next. Values follow at the next
  /// repair().
  void remove_edge(int layer, int a, int b);
  /// Makes best() exact again after removals and new costs.
  void repair();

  /// Returns the deepest layer that layer 0 reaches over what is not removed; -1 when layer 0 is
  /// empty.
  [[nodiscard]] virtual int deepest_reachable() = 0;

  /// Returns the joints of a node, rad.
  [[nodiscard]] virtual Config config(int layer, int slot) = 0;
  /// Returns the joints of a node, rad, none where there is no such node. Allowed before the first
  /// sweep too.
  [[nodiscard]] virtual std::optional<Config> node(int layer, int slot) {
    return lattice().node(layer, slot);
  }
  /// An edge to the next layer.
  struct Step {
    int slot = 0;
    double cost = 0;  ///< cost of the edge and of the node that it leaves
  };
  /// Replaces `out` by the edges that are left from a node to the next layer with cost + at() <=
  /// bound, in the order of slots.
  virtual void steps(int layer, int slot, double bound, std::vector<Step>& out) = 0;

  /// Returns the number of nodes whose IK was solved so far, repeats counted.
  [[nodiscard]] std::int64_t ik_nodes() const { return ik_nodes_; }
  /// Returns the number of edges compared so far, repeats counted.
  [[nodiscard]] std::int64_t edges() const { return edges_; }

 protected:
  CostToGo(const Lattice& lattice, const Budget& budget) : budget_(budget), verdicts_(lattice) {}
  virtual void compute(int goal_layer) = 0;
  virtual void compute_removals() = 0;
  /// Keeps the present values and removals, which restart() is about to forget: the next plan's
  /// removals are often nearly the same. By default keeps nothing.
  virtual void keep_removals() {}
  /// Returns a copy of the present values, which restore() brings back.
  [[nodiscard]] virtual std::shared_ptr<const SavedValues> save() const = 0;
  virtual void restore(const SavedValues& saved) = 0;
  /// Saves the values without removals, if they are present, before they or what goes with them are
  /// overwritten.
  void save_unremoved();

  Budget budget_;
  ParallelFor work_;
  int goal_ = 0;
  Verdicts verdicts_;
  std::int64_t ik_nodes_ = 0, edges_ = 0;

 private:
  /// Where the values without removals and with the last layer as goal are.
  enum class Unremoved { kUnknown, kPresent, kSaved };
  Unremoved unremoved_ = Unremoved::kUnknown;
  std::shared_ptr<const SavedValues> saved_;
  bool restarts_ = true;
};

/// Whether a sweep computes all nodes (kNone), or may leave out nodes that a lower bound proves to
/// lie on no best path (kByBound): these then read as unreachable, or as costlier than they are.
/// best(), first_slot() and every best path are exact all the same.
enum class Pruning { kNone, kByBound };
/// Returns the cost-to-go of a lattice: of an SrsLattice by vector code over its grid, of a
/// KnotGrid layer by layer over rolls and arm angles, always whole, of an ExplicitLattice over
/// all pairs of nodes, bounded from a given start alone. The memory of `recycled`, of any lattice,
/// is used again: pages fresh from the system take a quarter of a plan that meets obstacles.
[[nodiscard]] std::unique_ptr<CostToGo> make_cost_to_go(
    const Lattice& lattice, Pruning pruning = Pruning::kNone, const Budget& budget = {},
    std::unique_ptr<CostToGo> recycled = nullptr);

}  // namespace swivel
