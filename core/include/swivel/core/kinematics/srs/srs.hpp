// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>

#include "swivel/core/base/types.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

/// Signs of sin of the three angles measured from their singular poses; a set bit is a negative sign.
enum BranchBit { kShoulderBit = 1, kWristBit = 2, kElbowBit = 4 };
inline constexpr int kBranches = 8;

/// Three consecutive axes through one point, neighbours perpendicular, seen as z-y-z: with B = [x y z], z the first axis and y the
/// second, and `shift` the turn about y that brings the first axis onto the third,
///   Rot(first, q_a) Rot(second, q_b) Rot(third, q_c) = B Rz(q_a) Ry(q_b + shift) Rz(q_c) Ry(-shift) B^T.
/// So any orthogonal triple (z-y-z, x-y-z, ...) has one closed form, singular where sin(q_b + shift) = 0.
struct EulerTriple {
  Matrix3d basis = Matrix3d::Identity();
  double shift = 0;
};

/// How far the exact chain is from the fitted ideal arm.
struct FitDeviation {
  double offset = 0;  ///< m, largest miss of lines that should meet
  double angle = 0;   ///< rad, largest deviation of axes that should be perpendicular
};

/// A spherical shoulder and a spherical wrist joined by an elbow whose axis is perpendicular to the plane through shoulder, elbow
/// and wrist (in-plane elbow offsets allowed). All at q = 0 in the base frame. Closed form: Shimizu et al. 2008.
struct SrsArm {
  std::array<Vector3d, kDof> axis;  ///< fitted: neighbours perpendicular within each triple
  Vector3d S, E, W;                 ///< shoulder centre, foot of the elbow on axis 4, wrist centre, m
  Matrix3d home_rotation;           ///< tool at q = 0
  Vector3d wrist_in_tool;           ///< W in the tool frame, m
  double upper = 0, fore = 0;       ///< |SE|, |EW|, m
  double elbow_shift = 0;           ///< angle of the elbow from the straight arm = q4 + elbow_shift
  EulerTriple shoulder, wrist;
  FitDeviation deviation;
  bool exact = false;  ///< the fitted arm is the chain itself, to rounding
  /// By how much the fitted arm's joints differ from the chain's at the same pose, arm angle and branch, each joint, rad: 0 where
  /// exact, else the most over seeded postures within the limits at which no |sin| of shoulder, elbow and wrist is below 0.1 and no
  /// joint differs by more than polish() may move it.
  Config misfit = Config::Zero();

  /// Angles measured from their singular poses: sin = 0 is singular.
  [[nodiscard]] double shoulder_angle(const Config& q) const { return q[1] + shoulder.shift; }
  [[nodiscard]] double elbow_angle(const Config& q) const { return q[3] + elbow_shift; }
  [[nodiscard]] double wrist_angle(const Config& q) const { return q[5] + wrist.shift; }
  /// Branch sheet of a configuration.
  [[nodiscard]] int branch(const Config& q) const;
  /// Direction of axis 4 at q (fitted arm), base frame: what the arm angle measures.
  [[nodiscard]] Vector3d elbow_axis(const Config& q) const;
};

/// An arm that is not S-R-S.
class NotSrs : public InputError {
 public:
  NotSrs(const std::string& source, const std::string& why, const std::string& allowed)
      : InputError(source, "not an S-R-S arm: " + why + ": allowed are " + allowed), why_(why) {}
  /// Which axes miss each other, and by how much.
  [[nodiscard]] const std::string& why() const { return why_; }

 private:
  std::string why_;
};

/// Fits the ideal arm, or throws NotSrs. Tolerance: 1 mm and 10 mrad.
[[nodiscard]] SrsArm fit_srs(const Chain& chain, const std::string& source);

/// The plane that the arm angle turns in: u along S->W, r the reference direction. Unit, perpendicular, base frame.
struct ArmPlane {
  Vector3d u = Vector3d::UnitZ(), r = Vector3d::UnitX();
  double reach = 0;  ///< |SW|, m
  /// Arm angle of a direction of axis 4: right-handed about u, from r. Rad, (-pi, pi].
  [[nodiscard]] double angle_of(const Vector3d& elbow_axis) const;
};
[[nodiscard]] Vector3d wrist_centre(const SrsArm& arm, const Pose& tool);
/// First plane of a path: r = u x z, or u x x where that vanishes (|u x z| < 1e-3).
[[nodiscard]] ArmPlane first_plane(const SrsArm& arm, const Pose& tool);
/// The next one: r turned by the smallest rotation u -> u'; kept where |SW| < 1e-6 m; about r where u turns by more than 179.9 deg.
[[nodiscard]] ArmPlane carry_plane(const SrsArm& arm, const ArmPlane& previous, const Pose& tool);

/// Entries of the middle-angle decomposition, each a sin(phi) + b cos(phi) + c: five rows (m02, m12, m22, m20, m21) of (a, b, c).
using TripleCircle = std::array<std::array<double, 3>, 5>;
/// One tool pose's whole circle of arm angles for one sign of the elbow.
struct ElbowCircle {
  double q4 = 0;  ///< rad, principal
  TripleCircle shoulder, wrist;
};
enum class ReachStatus { kReachable, kSingular, kOutOfReach };
/// |SW| must be 1e-9 m inside [| |SE| - |EW| |, |SE| + |EW|]: within 1e-9 of a bound is singular, beyond is out of reach.
[[nodiscard]] ReachStatus reach_status(const SrsArm& arm, double reach);
/// Circles for the elbow angle positive [0] and negative [1]. Requires reach_status == kReachable.
[[nodiscard]] std::array<ElbowCircle, 2> elbow_circles(const SrsArm& arm, const ArmPlane& plane, const Pose& tool);

/// Closed form of the fitted arm at one arm angle and branch: principal joint angles, limits not applied.
[[nodiscard]] Config srs_ik(const SrsArm& arm, const std::array<ElbowCircle, 2>& circles, double phi, int branch);

/// Most that polish() may move a joint, rad.
inline constexpr double kMostPolished = 0.05;
/// Newton on seven equations (pose of the exact chain; arm angle of the fitted one), at most 5 steps to 1e-10, moving no joint by
/// more than kMostPolished in all; none when it does not get there. Returns the seed unchanged on exact arms.
[[nodiscard]] std::optional<Config> polish(const Chain& chain, const SrsArm& arm, const ArmPlane& plane, const Pose& tool,
                                           double phi, const Config& seed);
/// SrsArm::misfit of a fitted arm.
[[nodiscard]] Config measure_misfit(const Chain& chain, const SrsArm& arm);

}  // namespace swivel
