// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "cost_to_go/limit_slack.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {

/// A cost-to-go that keeps the values of all nodes, a list for each layer: what lattices that list
/// their nodes and grids of rolls have in common. Derived classes decide which nodes of
/// neighbouring layers are joined. A removal is repaired backwards, node by node where few change,
/// for as long as values change.
///
/// With Pruning::kByBound and a given start, it first goes forward from there, and leaves out nodes
/// that lie on no path of cost `limit` or less. Should removals make the best path cost more, the
/// limit is raised, and the sweep repeated. A plan that begins again (restart()) and removes nearly
/// what the one before did repairs the values of that one instead. Where a lattice was made by
/// halving steps of another one, forward values of that one take the place of the way forward
/// (bound_by_coarser()).
class LayerValues : public CostToGo {
 public:
  [[nodiscard]] double at(int layer, int slot) const override {
    return value_[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)];
  }
  [[nodiscard]] double best() const override;
  [[nodiscard]] int deepest_reachable() override;
  void bound_by_coarser(CostToGo& coarser, std::span<const int> layer_here) final;

 protected:
  using Values = std::vector<double>;  // [slot]
  LayerValues(const Lattice& lattice, const Budget& budget, Pruning pruning = Pruning::kNone);

  /// Replaces `out` by 0 for every node of a layer that exists, and infinity elsewhere.
  virtual void begin(int layer, Values& out) = 0;
  /// Replaces `out`, for every node of `layer`, by the least of edge cost plus value over the nodes
  /// of `other_layer`, whose values are `others`; `step` numbers the step between the two. Neither
  /// removals nor what nodes themselves cost count.
  virtual void relax(int step, int layer, int other_layer, const Values& others, Values& out) = 0;
  /// Returns the least of edge cost plus at() over the next layer for one node, over what is not
  /// removed.
  [[nodiscard]] virtual double relax_one(int layer, int slot) = 0;
  /// Returns the least of edge cost plus value over the layer before, whose values are `before`,
  /// for one node, over what is not removed.
  [[nodiscard]] virtual double relax_one_forward(int layer, int slot, const Values& before) = 0;
  /// Replaces `out`, for each of some nodes, by the least of edge cost plus at() over the next
  /// layer, over what is not removed; `layer` is not the goal.
  virtual void relax_some(int layer, const std::vector<int>& slots, Values& out);
  /// A node whose value has changed, and the value before (but see lowers_).
  struct Change {
    int slot;
    double before;
  };
  /// Appends the nodes of a layer whose values may come from nodes `ahead` of the next one, by the
  /// values that these had before they changed.
  virtual void find_stale(int layer, const std::vector<Change>& ahead, std::vector<int>& stale) = 0;
  /// Returns the number of nodes, stale or changed in the next layer, beyond which a layer is
  /// solved as a whole in less time than node by node.
  [[nodiscard]] virtual std::size_t many(int layer) const = 0;
  /// Returns whether a lattice with more knots may have paths that those of this one do not bound.
  [[nodiscard]] virtual bool more_knots_allow_more() const { return false; }
  /// Takes what is kept of the nodes of layers that a coarser cost-to-go of the same class has too.
  virtual void share_nodes(LayerValues& coarser, std::span<const int> layer_here) {
    static_cast<void>(coarser), static_cast<void>(layer_here);
  }
  /// Says that what has been solved of a layer is not wanted again soon.
  virtual void done_with(int layer) { static_cast<void>(layer); }

  /// Computes the values of a layer from those of the next, over what is not removed.
  void solve_layer(int layer, Values& out);
  [[nodiscard]] bool removed(int layer, int slot) const {
    return verdicts_.node(layer, slot) == Verdict::kRemoved;
  }

  /// Returns true if removing an edge from a node can have changed the value that the node would
  /// have without removals.
  [[nodiscard]] bool lost_best_edge(int layer, int slot, double value) const;

  std::vector<Values> value_;  // [layer]
  /// Whether a repair may lower values, because some removals of the plan before are not repeated.
  /// Then Change::before is the least of the values before and after.
  bool lowers_ = false;

 private:
  void compute(int goal_layer) final;
  void compute_removals() final;
  void keep_removals() final;
  /// If what is to be removed differs in little from what was removed before restart(), takes the
  /// values of then, and leaves only the differences pending.
  void take_last_values();
  /// Computes the values of a layer from those of the next where nodes may lie on a path within the
  /// limit, over what is not removed.
  void solve_within_limit(int layer, Values& out);
  /// Sets the limit to somewhat more than the best path to the goal costs. Returns false where no
  /// path leads there.
  bool set_limit();
  /// Sets the limit from the lower bounds of a coarser lattice: to `slack_` more than the best path
  /// is likely to cost, or to infinity where that slack is wide. Returns false where no path leads
  /// to the goal.
  bool set_limit_by_bounds();
  /// Computes for each node what no path from layer 0 costs less than, over the nodes that are not
  /// removed and all edges. Takes from `known` the values of its layers, layer k of which is layer
  /// `layer_here[k]` here.
  void go_forward(std::span<const Values> known, std::span<const int> layer_here);
  void sweep_once();
  /// Returns whether the best path costs so much that values may be too high for it.
  [[nodiscard]] bool beyond_limit() const {
    return limit_ != kUnreachable && !(lattice().largest_of_same_coarse_cost(best()) <= limit_);
  }
  /// Solves a layer as a whole. Appends the nodes whose values change to `changed`.
  void renew_layer(int layer, std::vector<Change>& changed);
  /// Appends a node to `changed` if its value is another than it was.
  void note_change(int slot, double before, double now, std::vector<Change>& changed) const;
  /// Computes the values of the nodes `stale` of a layer again. Appends those whose values change
  /// to `changed`.
  void renew_nodes(int layer, std::vector<int>& stale, std::vector<Change>& changed);
  [[nodiscard]] std::shared_ptr<const SavedValues> save() const final;
  void restore(const SavedValues& saved) final;
  void leave_out_removed(int layer, Values& values) const;

  bool bounded_;
  double slack_;  // of the limit over the cost of the best path, as a share
  double limit_ = kUnreachable;
  /// What deepest_reachable() found last, if bounded_: the cost of each node from layer 0 on
  /// without its own, as of `removed` removals.
  struct Before {
    bool known = false;
    std::int64_t removed = 0;
    int deepest = -1;
    std::vector<Values> values;  // [layer][slot]
  };
  Before before_;
  /// What go_forward() found, if it was called; by bound_by_coarser() the limit is theirs.
  std::vector<Values> forward_;
  bool by_coarser_ = false;
  double expected_ = 0;  // what the best path to the last layer is likely to cost, at least
  /// The values before restart(), and what was removed then.
  struct Last {
    bool known = false;
    std::vector<Values> value;
    Verdicts::Removals removals;
  };
  Last last_;
  bool exact_ = false;       // value_ is that of the goal and all removals
  std::vector<int> within_;  // slots, scratch
  Values fresh_;             // what renew_nodes() computes

  struct Saved : SavedValues {
    Saved(int goal_layer, double most, std::vector<Values> all, Before forward)
        : goal(goal_layer), limit(most), value(std::move(all)), before(std::move(forward)) {}
    int goal;
    double limit;
    std::vector<Values> value;
    Before before;
  };
};

}  // namespace swivel
