// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/kinematics/equations/pose_shift.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"

namespace swivel {

/// How far rows of an arm that is not exactly S-R-S may place its bodies from where the joints of their nodes place them, by the
/// exact chain both. From how far the exact axes are from the fitted ones, and from the triangle of shoulder, elbow and wrist.
/// docs/theory.md, Lemma 6.
class RowShift {
 public:
  RowShift(const Chain& chain, const SrsArm& arm);
  /// Lattice::row_shift() of the bodies that move with joint `group` of 1..7, at a node with these joints whose wrist centre is
  /// `reach` m from the shoulder centre. Not known next to the straight arm, and of links next to a singular shoulder or wrist.
  [[nodiscard]] PoseShift from_node(int group, double reach, const Config& q) const;
  /// The same, Lattice::rows_apart().
  [[nodiscard]] PoseShift between_rows(int group, double reach, const Config& q) const;
  /// A bound on the Frobenius norm by which the exact chain's Jacobian at such a node's joints differs, but for the signs of
  /// columns, from that at its row, or at the row of a node with the same elbow; both about the point where the exact chain has the
  /// tool at the node's joints. Infinite where a shift is not known.
  [[nodiscard]] double jacobian_change(double reach, const Config& q) const;
  /// What the shifts of a group are about.
  [[nodiscard]] const Vector3d& about(int group) const { return about_[part_of(group)]; }

 private:
  /// What shares a centre: shoulder (links 1 to 3), elbow (4), wrist (5 to 7).
  static constexpr std::size_t kShoulder = 0, kElbow = 1, kWrist = 2;
  static constexpr std::size_t part_of(int group) { return group <= 3 ? kShoulder : group == 4 ? kElbow : kWrist; }
  /// Of a row from where the fitted arm has the body at its node.
  [[nodiscard]] PoseShift from_fitted(int group, double reach, const Config& q) const;

  double upper_, fore_, hand_;           // m; hand_: wrist centre to tool
  double shoulder_shift_, wrist_shift_;  // rad, EulerTriple::shift
  std::array<Vector3d, 3> about_;
  std::array<double, 3> shift_{}, turn_{};  // by how much exact and fitted chain place links 3, 4 and 7 apart at the same joints
};

}  // namespace swivel
