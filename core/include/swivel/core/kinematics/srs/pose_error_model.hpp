// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/kinematics/equations/pose_error_bound.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"

namespace swivel {

/// Bounds how far a trajectory row of an arm that is not exactly S-R-S places its bodies from where
/// the joints of its lattice node place them, both by the exact chain. The bound comes from how far
/// the exact axes are from the fitted ones, and from the triangle of shoulder, elbow and wrist.
/// Source: docs/theory.md, Lemma 6.
class PoseErrorModel {
 public:
  /// Prepares the bounds for an exact chain and the S-R-S arm fitted to it.
  PoseErrorModel(const Chain& chain, const SrsArm& arm);
  /// Returns how far the exact configuration of a node may place the bodies that move with joint
  /// `group` of 1..7 from where the node's joints q (rad) place them, or those of another node that
  /// places these bodies alike. The node's wrist centre is `reach` m from the shoulder centre. The
  /// bound is unknown next to the straight arm, and for links next to a singular shoulder or wrist.
  [[nodiscard]] PoseErrorBound from_node(int group, double reach, const Config& q) const;
  /// Returns how far apart the rows of two nodes that place the bodies of joint `group` of 1..7
  /// alike may place them; q (rad) and `reach` (m) are those of one of them. The bound is unknown
  /// where that of from_node() is.
  [[nodiscard]] PoseErrorBound between_exact_configs(int group, double reach,
                                                     const Config& q) const;
  /// Returns a bound on the Frobenius norm of the change of the exact chain's Jacobian, but for the
  /// signs of columns, from a node's joints q (rad) to its row or to the exact configuration of a
  /// node with the same elbow. Both Jacobians are taken about the point where the exact chain has
  /// the tool at the node's joints. The bound is infinite where a shift is unknown. `reach` is as
  /// for from_node().
  [[nodiscard]] double jacobian_change(double reach, const Config& q) const;
  /// Returns the point (base frame, q = 0, m) that the shifts of a group are about.
  [[nodiscard]] const Vector3d& about(int group) const { return about_[part_of(group)]; }

 private:
  /// Parts of the arm that share a centre: shoulder (links 1 to 3), elbow (4), wrist (5 to 7).
  static constexpr std::size_t kShoulder = 0, kElbow = 1, kWrist = 2;
  static constexpr std::size_t part_of(int group) {
    return group <= 3 ? kShoulder : group == 4 ? kElbow : kWrist;
  }
  /// Returns how far a row may place a body from where the fitted arm has it at its node.
  [[nodiscard]] PoseErrorBound from_fitted(int group, double reach, const Config& q) const;

  double upper_, fore_, hand_;           // m; hand_: wrist centre to tool
  double shoulder_shift_, wrist_shift_;  // rad, EulerTriple::shift
  std::array<Vector3d, 3> about_;
  // How far apart the exact and the fitted chain place links 3, 4 and 7 at the same joints, m and
  // rad.
  std::array<double, 3> shift_{}, turn_{};
};

}  // namespace swivel
