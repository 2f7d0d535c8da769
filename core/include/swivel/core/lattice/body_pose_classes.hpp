// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/base/types.hpp"

namespace swivel {

struct PoseErrorBound;

/// Which nodes of a layer share the poses of which bodies, so that one collision removes all nodes
/// that share it. The part of a Lattice that collision questions need.
class BodyPoseClasses {
 public:
  virtual ~BodyPoseClasses() = default;
  BodyPoseClasses& operator=(const BodyPoseClasses&) = delete;

  /// The bit of `groups` below for bodies on followers of the chain, whose poses no two nodes are
  /// sure to share.
  static constexpr unsigned kFollowers = 1u << (kDof + 1);
  /// Whether nodes of a layer share the poses of all bodies of some groups; bit g of `groups`: the
  /// bodies that move with joint g of 1..7, or kFollowers. Rows of such nodes: up to
  /// pose_error_between() of every group.
  [[nodiscard]] virtual bool shares_body_poses(unsigned groups) const = 0;
  /// Replaces `out` by the slots of the layer at which those bodies stand where they stand at this
  /// one: at least the slot itself.
  virtual void slots_with_same_body_poses(int layer, int slot, unsigned groups,
                                          std::vector<int>& out) const = 0;
  /// Groups such that exact configurations of nodes at which their bodies have the same poses have
  /// the same manipulability, but for rounding and for how far rows are from their nodes; 0 where
  /// there are none.
  [[nodiscard]] virtual unsigned manipulability_groups() const { return 0; }
  /// Whether the exact configuration of a node with joints q has too little manipulability, and
  /// that of every node of its manipulability_groups(), where they have one: true only where that
  /// is sure.
  [[nodiscard]] virtual bool all_below_manipulability(int layer, const Config& q) const {
    static_cast<void>(layer), static_cast<void>(q);
    return false;
  }
  /// How far the exact configuration of a node, where it has one, may place the bodies that move
  /// with joint `group` of 1..7 from where the joints of a node place them, itself or one at which
  /// they have the same poses. `q`: the joints of either node.
  [[nodiscard]] virtual PoseErrorBound pose_error_of_node(int layer, int group,
                                                          const Config& q) const;
  /// How far two exact configurations of nodes at which those bodies have the same poses may place
  /// them apart. `q`: the joints of either node.
  [[nodiscard]] virtual PoseErrorBound pose_error_between(int layer, int group,
                                                          const Config& q) const;

 protected:
  BodyPoseClasses() = default;
  BodyPoseClasses(const BodyPoseClasses&) = default;
};

}  // namespace swivel
