// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <string>
#include <variant>

#include "swivel/core/base/types.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/kinematics/equations/trigonometric.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"

namespace swivel {

/// Joints of a chain with one joint locked.
inline constexpr int kSix = 6;
using Config6 = Eigen::Matrix<double, kSix, 1>;
using Matrix6 = Eigen::Matrix<double, kSix, kSix>;

/// Six revolute joints from base to tool, a product of exponentials like `Chain`:
///   X_BT(q) = exp([S_1] q_1) ... exp([S_6] q_6) * home.
struct SixChain {
  std::array<Vector3d, kSix> axis;   ///< unit vectors, base frame, q = 0
  std::array<Vector3d, kSix> point;  ///< a point on each axis, base frame, q = 0, m
  Pose home = Pose::Identity();      ///< tool in base at q = 0

  /// Returns the tool's pose in the base frame for joints q, rad.
  [[nodiscard]] Pose tool(const Config6& q) const;
  /// Returns the geometric Jacobian at the tool origin in the base frame: rows 0-2 linear (m), rows
  /// 3-5 angular. Joints q in rad.
  [[nodiscard]] Matrix6 jacobian(const Config6& q) const;
  /// Returns the tool's pose in the base frame and sets J to the Jacobian, for joints q, rad.
  Pose tool(const Config6& q, Matrix6& J) const;
};

/// Returns the six-joint chain that is left when one joint (0-based), which must be the slide of a
/// chain that has one, stays at `value`, rad or m: its motion is folded into the axes behind it and
/// into the home pose.
[[nodiscard]] SixChain lock_joint(const Chain& chain, int joint, double value);
/// Returns q without one joint (0-based).
[[nodiscard]] Config6 without_joint(const Config& q, int joint);
/// Returns the seven joints made of six and the value of the locked one (0-based), rad.
[[nodiscard]] Config with_joint(const Config6& q, int joint, double value);

/// What three neighbouring axes have in common that makes a closed form: the last three or the
/// first three meet in a point, or three in the middle are parallel.
enum class Structure { kSphericalWrist, kSphericalShoulder, kParallel };

/// The closed form of a six-joint chain, and how well the chain fits it. Tolerance: 1 mm and 10
/// mrad, as for S-R-S arms.
struct ClosedFormFit {
  Structure structure = Structure::kSphericalWrist;
  int first = 0;  ///< first of the three axes, 0-based
  /// Miss of the three axes from their common point (m) or direction (rad).
  FitDeviation deviation;
  bool exact = false;  ///< the fitted chain equals the chain, to rounding
};

/// Where two lines come closest. The frame (n, m, a) of the first line has its direction a and n
/// along the common normal. The second line has direction cosine a + sine m and passes through
/// `second` = `first` + distance n. Misses below 1e-5 (m, rad) are removed: lines that cross have
/// distance 0 and parallel lines sine 0, exactly.
struct CommonNormal {
  Vector3d first, second, n, m;
  double distance = 0, cosine = 1, sine = 0;
};

/// The constants of the closed form where joints 4-6 turn about one point W, so that joints 1-3
/// alone bring W to its place (Pieper 1968). Height and radius about axis 1 of the point that joint
/// 3 turns make one second-order trigonometric polynomial in q_3.
struct SphericalWrist {
  std::array<Vector3d, kSix> axis;
  Vector3d centre;              ///< W
  CommonNormal normal;          ///< of axes 1 and 2
  Vector3d foot, cosine, sine;  ///< exp([S_3] q) W = foot + cos(q) cosine + sin(q) sine
  /// About the second foot of the normal: half of its squared distance from W, negated; height of W
  /// along axis 2.
  Wave reach, height;
  double scale2 = 0;  ///< square of the size of the arm, m^2
  /// Cosines that describe axes 4-6 to each other.
  double first_cosine = 0, last_cosine = 0, middle_cosine = 0, middle_sine = 0;
  Vector3d across;  ///< unit vector, perpendicular to axis 6
};

/// The constants of the closed form where axes 2-4 are parallel: joints 2-4 keep a direction and
/// the height along it, which gives two equations linear in the cosines and sines of q_1 and q_5;
/// then q_6, and a planar arm of two links. Elias & Wen 2022 (IK-Geo) list the case; the
/// elimination is Pieper's.
struct ThreeParallel {
  std::array<Vector3d, kSix> axis;  ///< axes 2-4 made parallel
  std::array<Vector3d, kSix> point;
  std::array<double, kSix> sign;  ///< sign of axes 2-4 along axis 2
  CommonNormal normal;            ///< of axes 5 and 6
  /// The parallel direction in the frame of the normal.
  double along_n = 0, along_m = 0, along_a = 0;
  Vector3d upper, fore;  ///< links of the planar arm, m: axis 2 to 3, 3 to 4
  Vector3d across;       ///< unit vector, perpendicular to axis 2
};

/// Solves the inverse kinematics of a six-joint chain with a spherical wrist (axes 4, 5, 6 meet), a
/// spherical shoulder (1, 2, 3 meet; solved on the reversed chain) or three parallel axes (2, 3, 4
/// or 3, 4, 5). Where the axes only nearly meet or are nearly parallel, the fitted chain gives
/// starts, also from slightly complex roots, and Newton leads each to the exact chain. Sources: D.
/// L. Pieper, The kinematics of manipulators under computer control, 1968; K. M. Lynch & F. C.
/// Park, Modern Robotics, 2017, 6.1; A. J. Elias & J. T. Wen, IK-Geo, 2022.
class ClosedForm {
 public:
  /// Most solutions returned. A regular pose has at most eight (four roots, each with two ways to
  /// turn the remaining joints); singular poses have more representatives, and nearly fitted chains
  /// have solutions of their own.
  static constexpr int kMaxSolutions = 16;
  /// Configurations at one pose, rad.
  struct Solutions {
    std::array<Config6, kMaxSolutions> q;
    int count = 0;
    [[nodiscard]] const Config6* begin() const { return q.data(); }
    [[nodiscard]] const Config6* end() const { return q.data() + count; }
  };

  /// Returns the closed form of a chain, none if no three axes in the right place meet or are
  /// parallel, or if the first two axes of the position coincide.
  [[nodiscard]] static std::optional<ClosedForm> of(const SixChain& chain);

  /// Whether both configurations of three axes that meet are wanted, or one of them: they differ by
  /// half a turn of the first and the third.
  enum class Flips { kBoth, kOne };

  /// Returns the distinct configurations, in (-pi, pi], at a tool pose, in a fixed order; joint
  /// limits are not applied. Each reaches the pose within 1e-9 m and rad on the exact chain, by
  /// forward kinematics. A singular pose with infinitely many gets some representatives. Allocates
  /// nothing; uses only IEEE arithmetic and atan2 (and sin, cos where Newton is needed).
  [[nodiscard]] Solutions solve(const Pose& tool, Flips flips = Flips::kBoth) const;

  /// Returns unchecked starts, in (-pi, pi], for an iteration that may move the locked joint too:
  /// solutions of the fitted chain, and real starts beside complex ones whose discriminants are
  /// within `slack` (relative) of zero.
  [[nodiscard]] Solutions starts(const Pose& tool, double slack, Flips flips = Flips::kBoth) const;

  /// Returns the exact chain.
  [[nodiscard]] const SixChain& chain() const { return chain_; }
  /// Returns which closed form it is, and how well it fits.
  [[nodiscard]] const ClosedFormFit& fit() const { return fit_; }

 private:
  SixChain chain_;  // exact
  ClosedFormFit fit_;
  bool reversed_ = false;  // the method works on joints 6, 5, ... 1 and the inverse displacement
  double slack_ = 0;       // how far below zero a relative discriminant may be
  double aligned_ = 0;     // sine below which axes may be aligned on the exact chain
  Pose home_inverse_ = Pose::Identity();
  std::variant<SphericalWrist, ThreeParallel> method_;
};

/// How a seven-joint chain is solved in closed form: with one joint locked. A six-joint arm whose
/// tool may turn about its own axis is such a chain too, its last joint the roll.
struct LockMethod {
  /// Closed form with this joint locked; none: there is no closed form.
  std::array<std::optional<ClosedFormFit>, kDof> by_joint;
  /// Joint to lock, 0-based: the one that self-motion turns most on average, of those possible; -1:
  /// none.
  int best = -1;
  bool roll = false;        ///< the last joint is the roll of the tool of a six-joint arm
  bool roll_fixed = false;  ///< that roll stays 0, and it alone may be locked
  /// Returns the method for people, such as "closed form: axes 1, 2 and 3 meet in a point; locks
  /// joint 5 (or 4, 6, 7)". The seventh joint of a six-joint arm is called "the roll".
  [[nodiscard]] std::string words() const;
};
/// Returns with which joints locked a seven-joint chain has a closed form, and which is best.
/// Joints that self-motion hardly turns are not considered; where a joint slides, it alone is.
[[nodiscard]] LockMethod lock_method(const Chain& chain);

}  // namespace swivel
