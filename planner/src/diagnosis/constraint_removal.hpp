// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "diagnosis/constraints.hpp"
#include "swivel/graph/search/path_first.hpp"

namespace swivel {

/// What stands in the way of every path past the furthest layer: the constraint whose removal alone lets paths go on, and how far.
///
/// Every node and edge has the set of constraints that it violates. Let bit c of a set stand for "without constraint c"; the last
/// bit for "with all of them". Then the bits under which node b is reached are
///   reached(b) = exists(b) & OR over edges (a, b) of reached(a) & exists(a, b),
/// where exists() is all bits for what violates nothing, and else the bits of what does away with all that it violates alone: that
/// constraint, or an object. One pass over
/// the layers tells for all constraints at once how far paths come without each. It is Hauser's minimum constraint removal (The
/// minimum constraint removal problem with three robotics applications, 2014) for one constraint, where it is exact.
///
/// The pass begins some layers before the furthest one, at the node of a path that is known to lead there; from further back where
/// that finds nothing. What it finds is true from wherever it begins; from layer 0 it finds all.
class ConstraintRemoval {
 public:
  /// `path`: a valid one from layer 0 to the furthest layer that one reaches, empty where layer 0 has no valid node.
  ConstraintRemoval(const Lattice& lattice, Constraints& constraints, const SlotPath& path, const Budget& budget);

  struct Answer {
    Cause cause;
    std::optional<int> without_it;  ///< layer reached without this constraint, at least; none where it is not enough
    std::vector<Cause> together;    ///< what must go besides
  };
  /// None where no constraints were found that would help, or it would have taken more than `most_us` by a fixed estimate. Throws
  /// Stopped.
  [[nodiscard]] std::optional<Answer> find(double most_us);

 private:
  static constexpr ConstraintSet kAlways = ~ConstraintSet{0}, kWithAll = Constraints::of(Constraints::kCount);

  /// A node or edge that one constraint alone removes, which misses least of those seen.
  struct Witness {
    bool found = false;
    int layer = 0;  // of the node, or of the edge's head
    Cause cause;
    int measured = 0;
  };
  struct Pass {
    std::array<int, 64> furthest{};        // layer reached without constraint c
    std::array<std::int64_t, 64> votes{};  // nodes and edges of paths' continuations that c alone removes
    std::array<Witness, 64> witness;
    std::array<std::int64_t, 64> blamed{};  // that c removes, alone or with others, where paths under all constraints end
    bool whole = true;                      // false: stopped at the estimate
  };
  [[nodiscard]] Pass run_pass(int from, ConstraintSet waived, bool any_slope);
  [[nodiscard]] const Constraints::Node& at(int layer, int slot);
  void enter(int layer);
  void blame(Pass& pass, ConstraintSet violated) const;
  void see(Pass& pass, int removal, int layer, const Constraints::Node& node);
  /// What is removed: in this order, as far as it helps.
  enum class What { kOnNodes, kObject, kOnMoves };
  [[nodiscard]] What what(int constraint) const;
  [[nodiscard]] std::optional<int> best(const Pass& pass, What what, int least) const;
  [[nodiscard]] std::optional<int> to_give_up(const std::vector<Pass>& passes, ConstraintSet waived) const;
  [[nodiscard]] bool affordable() const { return constraints_.spent_us() < most_us_; }
  [[nodiscard]] ConstraintSet exists(ConstraintSet violated) const;

  const Lattice& lattice_;
  Constraints& constraints_;
  const SlotPath& path_;
  const Budget& budget_;
  int deepest_, wanted_;  // layers: furthest reached, and what counts as further
  double most_us_ = 0;
  ConstraintSet waived_ = 0;
  struct Known {
    bool known = false;
    Constraints::Node node;
  };
  struct Layer {
    std::vector<Known> nodes;
    std::vector<ConstraintSet> reached;
  };
  std::array<Layer, 2> layers_;  // by the parity of their number
};

}  // namespace swivel
