// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "kinematics/self_motion/pose_solutions.hpp"
#include "swivel/core/kinematics/self_motion/self_motion.hpp"
#include "swivel/core/lattice/explicit_lattice.hpp"

namespace swivel {

/// The nodes of the layer before that are carried on: one of each pair of twins, whose twins come
/// behind them. The start of a path follows as the last.
struct CarriedNodes {
  std::vector<Config> q;
  std::vector<int> slots;  // of each; -1 for one that is only carried on, since its roll is outside
                           // the layer's window
  int nodes = 0;           // slots of the layer
  bool start = false;
  [[nodiscard]] int start_slot() const { return nodes; }
  /// Returns the slot of a node's twin; for the start a slot that nothing else has.
  [[nodiscard]] int flipped_of(int slot) const {
    if (slot < 0) return slot;
    return slot >= nodes ? slot ^ 1 : slot < nodes / 2 ? slot + nodes / 2 : slot - nodes / 2;
  }
};

/// The nodes of a layer, and what is carried on from it to the next.
struct ArcLayer {
  std::vector<ExplicitLattice::Point> points;
  CarriedNodes carried;
  std::int64_t arcs = 0;
};

/// Makes the nodes of layers of a problem's path.
class ArcLayerMaker {
 public:
  ArcLayerMaker(const Chain& chain, const LockMethod& method, const PathProblem& problem,
                const SelfMotion& motion)
      : chain_(chain),
        method_(method),
        problem_(problem),
        motion_(motion),
        // nodes drift with the tool as the cost would have it
        least_(problem.cost.metric == CostMetric::kL2   ? SelfMotion::Least::kNorm
               : problem.cost.metric == CostMetric::kL1 ? SelfMotion::Least::kSum
                                                        : SelfMotion::Least::kLargest),
        twins_(motion.has_flipped_arcs() && !chain.roll_fixed) {
    if (chain.roll_fixed) solutions_.emplace(chain, method);
  }
  /// Returns the nodes of a layer: ends of arcs, images of the nodes of the layer before, and what
  /// fills the gaps. Links those of the layer before, `last` (null: there is none), with them.
  [[nodiscard]] ArcLayer make(const PathLayer& here, const CarriedNodes& before,
                              std::vector<ExplicitLattice::Point>* last) const;
  /// Returns what is carried on from nodes that a layer has.
  [[nodiscard]] CarriedNodes carried_from(const std::vector<ExplicitLattice::Point>& points) const;
  /// Carries the nodes of each layer back to the layer before it, from the last to layer `first`,
  /// where the roll is fixed: so a layer on a singularity has nodes from both sides.
  /// Where nodes were carried to, those midway between the nodes of both neighbours are added.
  /// `solutions`: of each layer, the number of its nodes that are IK solutions, which come first.
  void carry_back(const ToolPath& path, const std::vector<std::int64_t>& solutions,
                  std::vector<std::vector<ExplicitLattice::Point>>& points, int first) const;

 private:
  const Chain& chain_;
  const LockMethod& method_;
  const PathProblem& problem_;
  const SelfMotion& motion_;
  /// Returns the nodes of a layer where the roll is fixed: IK solutions, and images of the nodes of
  /// the layer before that are none of these.
  [[nodiscard]] ArcLayer make_solutions(const PathLayer& here, const CarriedNodes& before,
                                        std::vector<ExplicitLattice::Point>* last) const;

  /// Adds nodes to a layer between two others: midway by the travel between a node of the one and
  /// a node of the other that two steps may join.
  void add_midway(const ToolPath& path, int layer,
                  std::vector<std::vector<ExplicitLattice::Point>>& points) const;

  std::optional<PoseSolutions> solutions_;  // where the roll is fixed
  SelfMotion::Least least_;
  bool twins_;
};

}  // namespace swivel
