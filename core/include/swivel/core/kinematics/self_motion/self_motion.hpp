// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "swivel/core/kinematics/closed_form/closed_form.hpp"

namespace swivel {

/// A connected piece of a self-motion curve inside the joint limits, as points with unit tangents.
/// Between two points it is the cubic with their tangents, accurate to some 1e-4 rad. Each point
/// reaches the pose within 1e-10. Joint values lie inside the limits, those of circles() in [-pi,
/// pi].
struct SelfMotionArc {
  /// Points, rad: of an open arc from the lexicographically smaller end, of a closed arc from the
  /// point where the locked joint is least.
  std::vector<Config> q;
  /// Tangents at the points: dq per rad of unweighted Euclidean arc length.
  std::vector<Config> tangent;
  /// Weighted length from the first point to each, rad; a closed arc has one number more, that of
  /// its whole length.
  std::vector<double> length;
  bool closed = false;  ///< the first point follows the last
  int slide = -1;       ///< joint (0-based) that slides, m instead of rad; -1: none
  /// Joint (0-based) that stands exactly on its limit at the first and at the last point; -1: none.
  std::array<int, 2> limit{-1, -1};

  /// Returns the number of pieces between neighbouring points.
  [[nodiscard]] int chords() const { return static_cast<int>(q.size()) - (closed ? 0 : 1); }
  /// Returns the weighted length of the arc, rad.
  [[nodiscard]] double whole() const { return length.back(); }
  /// Returns the point of piece `chord` at u in [0, 1], rad, to the accuracy of the cubic. Values
  /// may pass +-pi.
  [[nodiscard]] Config at(int chord, double u) const;
};

struct SelfMotionData;

/// Finds the curves along which a seven-joint chain moves while its tool stands. A six-joint arm
/// with a free tool axis is such a chain, its last joint the roll.
///
/// The closed form at 32 values of the locked joint gives points inside and outside the limits
/// (points inside alone would miss arcs). Neighbouring values are joined by their tangents, as are
/// the two ends at a fold; what is left is traced. Curves that lie between two lock values are
/// found from complex roots. Where three perpendicular axes meet, curves come in pairs, of which
/// one is computed. Arcs end where a joint meets its limit, and where a triple of axes is within
/// 1e-6 rad of alignment. A bounded joint with a range of more than a turn counts as a circle.
///
/// Without a closed form curves are those to which Newton leads from 96 points spread over the
/// joints' ranges and from known configurations: some may be missed.
///
/// A joint that slides is the locked one; values of it lie evenly between its limits, at most 62.5
/// mm apart and 32 at least. Curves are those that come by there. 1 m of it counts as 1 rad.
class SelfMotion {
 public:
  /// Prepares for a chain and its lock_method(). `margin` (rad) is kept from joint limits.
  /// `weights` weigh joints in lengths and in images, in proportion to the largest; a weight below
  /// a hundredth of that counts as a hundredth.
  SelfMotion(const Chain& chain, const LockMethod& method, double margin,
             const std::array<double, kDof>& weights = {1, 1, 1, 1, 1, 1, 1});
  ~SelfMotion();

  /// Whether both curves of a pair are wanted, or one of them.
  enum class Flipped { kBoth, kOne };
  /// Returns the arcs at a tool pose, in the order of their first points; deterministic. `known`
  /// are configurations at this pose that may lie on curves of which the closed form shows nothing.
  /// With Twins::kOne, where twins() is true, arcs that are twins of others are left out.
  [[nodiscard]] std::vector<SelfMotionArc> arcs(const Pose& tool,
                                                std::span<const Config> known = {},
                                                Flipped flipped = Flipped::kBoth) const;
  /// Returns true if curves come in pairs that the joint limits cut alike, as those of a wrist
  /// whose outer joints turn all round.
  [[nodiscard]] bool has_flipped_arcs() const;
  /// Returns true if q is on one of the curves that Twins::kOne leaves out.
  [[nodiscard]] bool is_flipped(const Config& q) const;
  /// Returns the configuration that corresponds to q on the other curve of its pair, with the whole
  /// turns that arcs have. Only where twins() is true.
  [[nodiscard]] Config flipped(Config q) const;
  /// Returns the whole curves at a tool pose, joint limits ignored, with arbitrary whole turns of
  /// joints.
  [[nodiscard]] std::vector<SelfMotionArc> curves(const Pose& tool) const;

  /// Returns the configuration at the pose `tool` to which at most six Newton steps of least
  /// weighted norm lead from q; where these do not arrive, and three axes line up at q or there,
  /// that to which damped steps lead; else none.
  [[nodiscard]] std::optional<Config> image(const Config& q, const Pose& tool) const;
  /// What the move from q to its image minimises: its weighted norm, the sum of its weighted
  /// joints, or the largest of them, to first order.
  enum class Least { kNorm, kSum, kLargest };
  /// Returns the image() of each configuration at the pose `tool`, in vector code. With
  /// Least::kNorm they are those of image() bit for bit; with the others they drift along the
  /// self-motion by up to 0.2 rad, to where the sum or the largest of the weighted moves is least.
  [[nodiscard]] std::vector<std::optional<Config>> images(std::span<const Config> q,
                                                          const Pose& tool,
                                                          Least least = Least::kNorm) const;
  /// Returns the point of an arc at piece `chord` and u in [0, 1], exactly on the curve of the pose
  /// `tool` and within the limits. Returns none where Newton fails.
  [[nodiscard]] std::optional<Config> point(const SelfMotionArc& arc, int chord, double u,
                                            const Pose& tool) const;
  /// Returns the configuration near q at the pose `tool` at which a joint (0-based) has a value,
  /// rad, bit for bit. Returns none where Newton fails, or outside the limits.
  [[nodiscard]] std::optional<Config> with_joint_at(const Config& q, const Pose& tool, int joint,
                                                    double value) const;
  /// Returns true where three axes of q line up within 1e-6 rad: arcs end there.
  [[nodiscard]] bool is_aligned(const Config& q) const;
  /// Brings every joint of q to the whole turns that arcs have. Returns true if q is then inside
  /// the limits.
  [[nodiscard]] bool canonical(Config& q) const;
  /// Returns which joints count as circles: continuous ones, and those with a range of more than a
  /// turn.
  [[nodiscard]] const std::array<bool, kDof>& circles() const;

 private:
  std::unique_ptr<const SelfMotionData> data_;
};

}  // namespace swivel
