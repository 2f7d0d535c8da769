// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "diagnosis/constraints.hpp"
#include "swivel/graph/search/path_first.hpp"

namespace swivel {

/// Finds what blocks every path beyond the furthest layer: the constraint whose removal alone lets
/// paths continue, and how far they then come.
///
/// Every node and edge has the set of constraints that it violates. Let bit c of a set stand for
/// "without constraint c", and the last bit for "with all of them". Then the bits under which node
/// b is reached are
/// reached(b) = exists(b) & OR over edges (a, b) of reached(a) & exists(a, b),
/// where exists() is all bits for what violates nothing, and else the bits of those constraints, or
/// objects, that each alone account for all violations. One pass over the layers tells for all
/// constraints at once how far paths come without each. This is Hauser's minimum constraint removal
/// (The minimum constraint removal problem with three robotics applications, 2014) for one
/// constraint, for which it is exact.
///
/// The pass begins some layers before the furthest one, at the node of a path that is known to lead
/// there, and further back if that finds nothing. What it finds is true wherever it begins; from
/// layer 0 it finds everything.
class ConstraintRemoval {
 public:
  /// Prepares the search. `path` is a valid path from layer 0 to the furthest layer that any
  /// reaches; empty if layer 0 has no valid node. The arguments must outlive this object.
  ConstraintRemoval(const Lattice& lattice, Constraints& constraints, const SlotPath& path,
                    const Budget& budget);

  /// What blocks every path.
  struct Answer {
    Cause cause;
    /// layer reached without it, at least; none if it is not enough
    std::optional<int> without_it;
    std::vector<Cause> together;  ///< further constraints that must go too
  };
  /// Returns the constraint, or several that together, block every path. If none was found that
  /// lets paths continue, or that would take more than `most_us` by a fixed estimate, returns the
  /// first of the constraints that were given up, without `without_it`; none if there were none.
  /// Throws Stopped.
  [[nodiscard]] std::optional<Answer> find(double most_us);

 private:
  static constexpr ConstraintSet kAlways = ~ConstraintSet{0},
                                 kWithAll = Constraints::of(Constraints::kCount);

  /// A node or edge that one constraint alone removes: of those seen, the one that violates it by
  /// the least.
  struct Witness {
    bool found = false;
    int layer = 0;  // of the node or the edge's head
    Cause cause;
    int measured = 0;
  };
  struct Pass {
    std::array<int, 64> furthest{};  // layer reached without constraint c
    // nodes and edges on continuations of paths that constraint c alone removes
    std::array<std::int64_t, 64> votes{};
    std::array<Witness, 64> witness;
    // nodes and edges that constraint c removes, alone or with others, where paths under all
    // constraints end
    std::array<std::int64_t, 64> blamed{};
    bool whole = true;  // false: stopped because of the estimated time
  };
  /// Goes from layer `from` as far as paths come without each constraint of `followed`. What
  /// follows only constraints that bar nodes is done with most edges at their steps.
  [[nodiscard]] Pass run_pass(int from, ConstraintSet waived, ConstraintSet followed,
                              bool any_slope);
  /// A node, as far as it was asked about.
  struct Known {
    bool placed = false, complete = false;  // the node has its joints; it has all its violations
    Constraints::Node node;
  };
  /// Returns what is known of a node, its joints and limits at least.
  [[nodiscard]] Known& met(int layer, int slot);
  /// Returns a node with all that it violates.
  [[nodiscard]] const Constraints::Node& at(int layer, int slot);
  /// Returns a node with its joints and at least the limits that they violate.
  [[nodiscard]] const Constraints::Node& placed(int layer, int slot) {
    return met(layer, slot).node;
  }
  void enter(int layer);
  void blame(Pass& pass, ConstraintSet violated) const;
  void see(Pass& pass, int removal, int layer, const Constraints::Node& node);
  /// Counts an edge from qa at slot a of `layer` to qb at slot b of the next layer, which exists
  /// without the constraint `removal`, and keeps it as the witness if it is a better one.
  void see_edge(Pass& pass, int removal, int layer, ConstraintSet violated, int a, const Config& qa,
                int b, const Config& qb);
  /// Marks a node as reached without each constraint of `bits`; returns those that are new there.
  ConstraintSet reach(int layer, int slot, ConstraintSet bits);
  void reach_first_layer(Pass& pass);
  /// Follows the edge from slot a of `layer` to slot b of the next layer.
  void move(Pass& pass, int layer, int a, int b);
  /// Follows all edges from the reached nodes of `layer`; with `any_slope`, those to all slots.
  void move_on(Pass& pass, int layer, bool any_slope);
  /// Sorts the nodes of a layer by the joint that tells them apart best, for heads_near(). Returns
  /// false where not every node of the layer before leads to every one of these, or where steps of
  /// joints are too wide for it.
  [[nodiscard]] bool sort_heads(int layer);
  /// Returns the slots of the nodes sorted last that no step of that joint from q keeps from it,
  /// whole turns aside, in order.
  [[nodiscard]] const std::vector<int>& heads_near(const Config& q);
  /// What a constraint removes. Kinds are tried in this order.
  enum class What { kOnNodes, kObject, kOnMoves };
  [[nodiscard]] What what(int constraint) const;
  [[nodiscard]] std::optional<int> best(const Pass& pass, What what, int least) const;
  [[nodiscard]] std::optional<int> to_give_up(const std::vector<Pass>& passes,
                                              ConstraintSet waived) const;
  [[nodiscard]] bool affordable() const { return constraints_.spent_us() < most_us_; }
  [[nodiscard]] ConstraintSet exists(ConstraintSet violated) const;

  const Lattice& lattice_;
  Constraints& constraints_;
  const SlotPath& path_;
  const Budget& budget_;
  int deepest_, wanted_;  // layers: furthest reached, and what counts as further
  double most_us_ = 0;
  ConstraintSet waived_ = 0, followed_ = kAlways;  // of the pass that runs
  struct Layer {
    std::vector<Known> nodes;
    std::vector<ConstraintSet> reached;
  };
  std::array<Layer, 2> layers_;  // by the parity of their number
  int sorted_joint_ = 0;
  double sorted_step_ = 0;                     // rad
  std::vector<std::pair<double, int>> heads_;  // wrapped value of that joint, slot
  std::vector<int> near_;
};

}  // namespace swivel
