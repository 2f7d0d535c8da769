// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/base/types.hpp"

namespace swivel {

struct PoseErrorBound;

/// Says which nodes of a layer place some bodies of the robot at the same poses, so that one
/// collision of those bodies removes all of these nodes. This is the part of a Lattice that
/// collision questions need.
///
/// A set of groups is an unsigned number: bit g stands for the bodies that move with joint g
/// (1..7), and kFollowers for bodies on followers of the chain.
class BodyPoseClasses {
 public:
  virtual ~BodyPoseClasses() = default;
  BodyPoseClasses& operator=(const BodyPoseClasses&) = delete;

  /// The bit for bodies on followers of the chain, whose poses no two nodes are sure to share.
  static constexpr unsigned kFollowers = 1u << (kDof + 1);
  /// Returns whether some nodes of a layer place all bodies of `groups` at the same poses. The
  /// exact configurations of such nodes may differ in these poses by pose_error_between() of every
  /// group.
  [[nodiscard]] virtual bool shares_body_poses(unsigned groups) const = 0;
  /// Replaces `out` by the slots of `layer` whose nodes place the bodies of `groups` where the node
  /// of `slot` does; `slot` itself is always among them.
  virtual void slots_with_same_body_poses(int layer, int slot, unsigned groups,
                                          std::vector<int>& out) const = 0;
  /// Returns a set of groups that determines manipulability: if two nodes of a layer place the
  /// bodies of these groups at the same poses, their exact configurations have the same
  /// manipulability, up to rounding and up to how far rows are from their nodes. Returns 0 if there
  /// is no such set.
  [[nodiscard]] virtual unsigned manipulability_groups() const { return 0; }
  /// Returns true only if it is certain that the exact configuration of a node with joints `q`, and
  /// those of all nodes that share its poses of manipulability_groups(), have too little
  /// manipulability.
  [[nodiscard]] virtual bool all_below_manipulability(int layer, const Config& q) const {
    static_cast<void>(layer), static_cast<void>(q);
    return false;
  }
  /// Returns a bound on how far a body that moves with joint `group` (1..7) is at a node's exact
  /// configuration from where the node's own joints, or those of a node that shares its pose, place
  /// it. `q`: the joints of either node.
  [[nodiscard]] virtual PoseErrorBound pose_error_of_node(int layer, int group,
                                                          const Config& q) const;
  /// Returns a bound on how far apart the exact configurations of two nodes that share the pose of
  /// `group` place its bodies. `q`: the joints of either node.
  [[nodiscard]] virtual PoseErrorBound pose_error_between(int layer, int group,
                                                          const Config& q) const;

 protected:
  BodyPoseClasses() = default;
  BodyPoseClasses(const BodyPoseClasses&) = default;
};

}  // namespace swivel
