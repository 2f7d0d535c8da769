// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "swivel/core/kinematics/closed_form/closed_form.hpp"

namespace swivel {

/// A connected piece of a self-motion curve inside the joint limits, as points with unit tangents; between two points it is the
/// cubic with their tangents, to some 1e-4 rad. Each point reaches the pose within 1e-10. Values lie inside the limits; of joints
/// that are circles, in [-pi, pi].
struct SelfMotionArc {
  std::vector<Config> q;        ///< from the lexicographically smaller end; a closed arc from its least point, by lock and joints
  std::vector<Config> tangent;  ///< dq per rad of arc length (Euclidean, unweighted), in the order of the points
  std::vector<double> length;   ///< weighted length from the first point, rad; of a closed arc also that of the first, once round
  bool closed = false;          ///< the first point follows the last
  std::array<int, 2> limit{-1, -1};  ///< joint (0-based) that stands on its limit at the first and last point, exactly; -1: none

  [[nodiscard]] int chords() const { return static_cast<int>(q.size()) - (closed ? 0 : 1); }
  [[nodiscard]] double whole() const { return length.back(); }
  /// The point of chord k at u in [0, 1], to the accuracy of the cubic; values may pass +-pi.
  [[nodiscard]] Config at(int chord, double u) const;
};

struct SelfMotionData;

/// Curves along which a seven-joint chain moves while the tool stays. A six-joint arm with a free tool axis is such a chain, its
/// last joint the turn of the tool.
/// The closed form at 32 values of the locked joint gives points inside and outside the limits (in-limit points alone miss arcs);
/// neighbouring values are joined by their tangents, as are the ends of folds; what is left is traced. Curves between two lock
/// values are found from complex roots. Of the pairs that a triple of perpendicular axes makes, one curve is sought. Pieces end
/// where a joint meets its limit, and where a triple is within 1e-6 rad of alignment. A bounded joint with a range of more than a
/// turn is a circle here.
/// Without a lock curves are those to which Newton leads from 96 points spread over the joints' ranges, and from configurations
/// known: not all are found.
class SelfMotion {
 public:
  /// Limits are kept with `margin` (rad). Lengths and images are weighted by `weights`, in proportion;
  /// a weight below a hundredth of the largest counts as that.
  SelfMotion(const Chain& chain, const LockMethod& method, double margin,
             const std::array<double, kDof>& weights = {1, 1, 1, 1, 1, 1, 1});
  ~SelfMotion();

  enum class Twins { kBoth, kOne };
  /// Arcs in the order of their first points; deterministic. `known`: configurations at this pose that may lie on curves of which
  /// the closed form shows nothing. `twins`: of arms that have them, whether arcs that are twins of others are left out.
  [[nodiscard]] std::vector<SelfMotionArc> arcs(const Pose& tool, std::span<const Config> known = {},
                                                Twins twins = Twins::kBoth) const;
  /// Whether the pairs of curves are cut by the limits alike, as those of a wrist are whose outer joints turn all round.
  [[nodiscard]] bool twins() const;
  /// Whether q is on the side whose arcs `Twins::kOne` leaves out.
  [[nodiscard]] bool is_twin(const Config& q) const;
  /// Where q is on the other curve of its pair; in the winding that arcs have. Of arms with twins.
  [[nodiscard]] Config twin(Config q) const;
  /// The whole curves, limits ignored; joints in no given winding.
  [[nodiscard]] std::vector<SelfMotionArc> curves(const Pose& tool) const;

  /// The configuration at the pose to which at most six Newton steps of least weighted norm lead from q.
  [[nodiscard]] std::optional<Config> image(const Config& q, const Pose& tool) const;
  /// What is least of the way to an image: its weighted norm, or its largest weighted joint, to first order.
  enum class Least { kNorm, kLargest };
  /// The same of many, in vector code; by the norm to the same bits.
  [[nodiscard]] std::vector<std::optional<Config>> images(std::span<const Config> q, const Pose& tool,
                                                          Least least = Least::kNorm) const;
  /// The point of the pose's arc at chord k and u, exactly on the curve and within the limits. None where Newton fails.
  [[nodiscard]] std::optional<Config> point(const SelfMotionArc& arc, int chord, double u, const Pose& tool) const;
  /// The point of the pose near q at which a joint has a value, bit for bit. None where Newton fails, or outside the limits.
  [[nodiscard]] std::optional<Config> with_joint_at(const Config& q, const Pose& tool, int joint, double value) const;
  /// q with every joint in the winding that arcs have; whether it is inside the limits.
  [[nodiscard]] bool canonical(Config& q) const;
  /// Joints that are circles here: continuous, or a range of more than a turn.
  [[nodiscard]] const std::array<bool, kDof>& circles() const;

 private:
  std::unique_ptr<const SelfMotionData> data_;
};

}  // namespace swivel
