// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>

#include "swivel/core/base/types.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

/// Bits of an IK branch: the signs of the sines of the shoulder, wrist and elbow angle, measured
/// from their singular poses. A set bit is a negative sign.
enum BranchBit { kShoulderBit = 1, kWristBit = 2, kElbowBit = 4 };
inline constexpr int kBranches = 8;
/// An S-R-S arm counts as singular if the sine of its shoulder or wrist angle is smaller than this.
inline constexpr double kSingularSine = 1e-6;

/// Three consecutive axes through one point, neighbours perpendicular, seen as z-y-z: with B = [x y
/// z], z the first axis and y the second, and `shift` the turn about y that brings the first axis
/// onto the third,
///   Rot(first, q_a) Rot(second, q_b) Rot(third, q_c)
///     = B Rz(q_a) Ry(q_b + shift) Rz(q_c) Ry(-shift) B^T.
/// So any orthogonal triple (z-y-z, x-y-z, ...) has one closed form, singular where sin(q_b +
/// shift) = 0.
struct EulerTriple {
  Matrix3d basis = Matrix3d::Identity();
  double shift = 0;
};

/// How far the exact chain is from the arm fitted to it.
struct FitDeviation {
  double offset = 0;  ///< largest miss of lines that should meet, m
  /// Largest error of angles that should be right, or of axes that should be parallel, rad.
  double angle = 0;
};

/// An S-R-S arm: a spherical shoulder and a spherical wrist joined by an elbow whose axis is
/// perpendicular to the plane through shoulder, elbow and wrist (in-plane elbow offsets are
/// allowed). All members are at q = 0 in the base frame. Closed form: Shimizu et al. 2008. Source:
/// fit_srs().
struct SrsArm {
  std::array<Vector3d, kDof> axis;  ///< fitted axes: neighbours perpendicular within each triple
  /// Shoulder centre, foot of the elbow on axis 4, wrist centre, m.
  Vector3d S, E, W;
  Matrix3d home_rotation;      ///< tool at q = 0
  Vector3d wrist_in_tool;      ///< W in the tool frame, m
  double upper = 0, fore = 0;  ///< lengths |SE| and |EW|, m
  /// Angle of the elbow from the straight arm = q4 + elbow_shift, rad.
  double elbow_shift = 0;
  EulerTriple shoulder, wrist;
  FitDeviation deviation;
  /// The tool's z axis is the axis of joint 7, within what fit_srs() forgives, and the tool may be
  /// turned about it by any angle.
  bool coaxial = false;
  bool exact = false;  ///< the fitted arm equals the chain, to rounding
  /// How far the fitted arm's joints are from the chain's at the same pose, arm angle and branch,
  /// each joint, rad: 0 where exact, else the most over seeded postures within the limits at which
  /// no |sin| of shoulder, elbow and wrist is below 0.1 and no joint differs by more than
  /// solve_exact_chain() may move it.
  Config fit_error = Config::Zero();

  /// Returns the shoulder angle (joint 2 from its singular pose, where its sine is 0), rad.
  [[nodiscard]] double shoulder_angle(const Config& q) const { return q[1] + shoulder.shift; }
  /// Returns the elbow angle (joint 4 from the straight arm, where its sine is 0), rad.
  [[nodiscard]] double elbow_angle(const Config& q) const { return q[3] + elbow_shift; }
  /// Returns the wrist angle (joint 6 from its singular pose, where its sine is 0), rad.
  [[nodiscard]] double wrist_angle(const Config& q) const { return q[5] + wrist.shift; }
  /// Returns the IK branch of joints q (rad), by BranchBit, 0 to 7.
  [[nodiscard]] int branch(const Config& q) const;
  /// Returns the direction of the fitted arm's axis 4 at joints q (rad), in the base frame: what
  /// the arm angle measures.
  [[nodiscard]] Vector3d elbow_axis(const Config& q) const;
};

/// Thrown for an arm that is not S-R-S.
class NotSrs : public InputError {
 public:
  NotSrs(const std::string& source, const std::string& why, const std::string& allowed)
      : InputError(source, "not an S-R-S arm: " + why + ": allowed are " + allowed), why_(why) {}
  /// Returns which axes miss each other, and by how much.
  [[nodiscard]] const std::string& why() const { return why_; }

 private:
  std::string why_;
};

/// Returns the S-R-S arm nearest to a chain. Throws NotSrs where the chain misses one by more than
/// 1 mm or 10 mrad (a tool as near as that to the axis of joint 7 is taken to be on it if it may
/// turn freely), or where axis 4 runs through the shoulder or wrist centre. `source` is the file
/// for messages.
[[nodiscard]] SrsArm fit_srs(const Chain& chain, const std::string& source);

/// The frame in which the arm angle is measured: u along the line from shoulder to wrist centre, r
/// the reference direction. Unit vectors, perpendicular to each other, in the base frame.
struct ArmPlane {
  Vector3d u = Vector3d::UnitZ(), r = Vector3d::UnitX();
  double reach = 0;  ///< distance |SW|, m
  /// Returns the arm angle of a direction of axis 4 (base frame): right-handed about u, from r; in
  /// [-pi, pi] rad.
  [[nodiscard]] double angle_of(const Vector3d& elbow_axis) const;
};
/// Returns the wrist centre in the base frame, m, where the tool stands at a pose.
[[nodiscard]] Vector3d wrist_centre(const SrsArm& arm, const Pose& tool);
/// Returns the frame of the arm angle at a path's first tool pose: r = u x z, or u x x where that
/// vanishes (|u x z| < 1e-3).
[[nodiscard]] ArmPlane first_plane(const SrsArm& arm, const Pose& tool);
/// Returns the frame of the arm angle at the next tool pose: `previous` with r turned by the
/// smallest rotation from u to the new u. It is kept where |SW| < 1e-6 m, and turned about r where
/// u turns by more than 179.9 deg.
[[nodiscard]] ArmPlane carry_plane(const SrsArm& arm, const ArmPlane& previous, const Pose& tool);

/// Entries of the rotation that a triple of joints must make, as the arm angle phi varies: five
/// rows (m02, m12, m22, m20, m21) of (a, b, c), each the entry a sin(phi) + b cos(phi) + c.
using TripleCircle = std::array<std::array<double, 3>, 5>;
/// The inverse kinematics of one tool pose for one sign of the elbow and every arm angle.
struct ElbowCircle {
  double q4 = 0;  ///< joint 4, rad, whole turns ignored
  TripleCircle shoulder, wrist;
};
/// Whether the elbow can bring the wrist centre to its place.
enum class ReachStatus { kReachable, kSingular, kOutOfReach };
/// Returns whether the wrist centre can be `reach` m from the shoulder centre: kReachable if that
/// is at least 1e-9 m inside [| |SE| - |EW| |, |SE| + |EW|], kSingular within 1e-9 m of a bound or
/// below 1e-6 m, kOutOfReach beyond.
[[nodiscard]] ReachStatus reach_status(const SrsArm& arm, double reach);
/// Returns the circles of arm angles at a tool pose for a positive [0] and a negative [1] elbow
/// angle. reach_status() must be kReachable.
[[nodiscard]] std::array<ElbowCircle, 2> elbow_circles(const SrsArm& arm, const ArmPlane& plane,
                                                       const Pose& tool);

/// Returns the fitted arm's joints at one arm angle phi (rad) and branch (BranchBit), in closed
/// form: rad, whole turns ignored, limits not applied.
[[nodiscard]] Config srs_ik(const SrsArm& arm, const std::array<ElbowCircle, 2>& circles,
                            double phi, int branch);

/// Most that solve_exact_chain() may move a joint, rad.
inline constexpr double kMostCorrection = 0.05;
/// Refines joints of the fitted arm to the exact chain: Newton on seven equations (the exact
/// chain's tool pose, and the arm angle phi in `plane`, rad, of the fitted arm), at most 5 steps to
/// a residual of 1e-10. Returns none where it does not get there or would move a joint by more than
/// kMostCorrection in all. Returns the seed unchanged for an exact arm.
[[nodiscard]] std::optional<Config> solve_exact_chain(const Chain& chain, const SrsArm& arm,
                                                      const ArmPlane& plane, const Pose& tool,
                                                      double phi, const Config& seed);
/// Measures SrsArm::fit_error of an arm fitted to a chain, rad.
[[nodiscard]] Config measure_fit_error(const Chain& chain, const SrsArm& arm);

}  // namespace swivel
