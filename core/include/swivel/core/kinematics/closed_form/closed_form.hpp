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

inline constexpr int kSix = 6;
using Config6 = Eigen::Matrix<double, kSix, 1>;
using Matrix6 = Eigen::Matrix<double, kSix, kSix>;

/// Six revolute joints from base to tool, a product of exponentials like `Chain`:
///   X_BT(q) = exp([S_1] q_1) ... exp([S_6] q_6) * home.
struct SixChain {
  std::array<Vector3d, kSix> axis;   ///< unit, base frame, q = 0
  std::array<Vector3d, kSix> point;  ///< on the axis, base frame, q = 0, m
  Pose home = Pose::Identity();      ///< tool in base at q = 0

  [[nodiscard]] Pose tool(const Config6& q) const;
  /// Geometric Jacobian at the tool origin, base frame: rows 0-2 linear, 3-5 angular.
  [[nodiscard]] Matrix6 jacobian(const Config6& q) const;
  /// Both at once.
  Pose tool(const Config6& q, Matrix6& J) const;
};

/// The chain that is left when one joint (0-based) stays at `value`: its turn is folded into the axes behind it.
[[nodiscard]] SixChain lock_joint(const Chain& chain, int joint, double value);
/// q without the locked joint, and with it again.
[[nodiscard]] Config6 without_joint(const Config& q, int joint);
[[nodiscard]] Config with_joint(const Config6& q, int joint, double value);

/// Three neighbouring axes that make a closed form.
enum class Structure { kSphericalWrist, kSphericalShoulder, kParallel };

/// What closed form a six-joint chain has. Tolerance: 1 mm and 10 mrad, as for S-R-S arms.
struct ClosedFormFit {
  Structure structure = Structure::kSphericalWrist;
  int first = 0;           ///< 0-based, of the three axes
  FitDeviation deviation;  ///< miss of the three axes from their common point (m) or direction (rad)
  bool exact = false;      ///< the fitted chain is the chain itself, to rounding
};

/// Where two lines come closest: the frame (n, m, a) of the first has n along their common normal; the second has the direction
/// cosine a + sine m and passes through `second` = `first` + distance n. Crossing lines have distance 0 and parallel ones sine 0,
/// exactly: misses below 1e-5 (m, rad) are taken out.
struct CommonNormal {
  Vector3d first, second, n, m;
  double distance = 0, cosine = 1, sine = 0;
};

/// Joints 4-6 turn about one point W, so joints 1-3 alone carry W to its place: Pieper 1968. Height and radius about axis 1 of the
/// point that joint 3 turns make one second-order trigonometric polynomial in q_3. The constants of that.
struct SphericalWrist {
  std::array<Vector3d, kSix> axis;
  Vector3d centre;              ///< W
  CommonNormal normal;          ///< of axes 1 and 2
  Vector3d foot, cosine, sine;  ///< exp([S_3] q) W = foot + cos(q) cosine + sin(q) sine
  Wave reach, height;           ///< about the second foot of the normal: half the squared distance; along axis 2
  double scale2 = 0;            ///< square of the size of the arm, m^2
  double first_cosine = 0, last_cosine = 0, middle_cosine = 0, middle_sine = 0;  ///< of the triple
  Vector3d across;                                                               ///< unit, perpendicular to axis 6
};

/// Axes 2-4 are parallel, so joints 2-4 keep a direction and a height along it: two equations linear in the cosines and sines of
/// q_1 and q_5. Then q_6, and a planar arm of two links. Elias & Wen 2022 (IK-Geo) list the case; the elimination is that of
/// Pieper.
struct ThreeParallel {
  std::array<Vector3d, kSix> axis;  ///< 2-4 made parallel
  std::array<Vector3d, kSix> point;
  std::array<double, kSix> sign;                 ///< of axes 2-4 along axis 2
  CommonNormal normal;                           ///< of axes 5 and 6
  double along_n = 0, along_m = 0, along_a = 0;  ///< the parallel direction in the frame of the normal
  Vector3d upper, fore;                          ///< links of the planar arm: axis 2 to 3, 3 to 4
  Vector3d across;                               ///< unit, perpendicular to axis 2
};

/// All configurations of a six-joint chain at a tool pose, for chains with a spherical wrist (axes 4, 5, 6 meet), a spherical
/// shoulder (1, 2, 3 meet; the chain is turned round) or three parallel axes (2, 3, 4 or 3, 4, 5). Where the axes only nearly meet,
/// the fitted chain gives starts, slightly complex roots included, and Newton leads each to the exact chain. Sources: D. L. Pieper,
/// The kinematics of manipulators under computer control, 1968; K. M. Lynch & F. C. Park, Modern Robotics, 2017, 6.1; A. J. Elias &
/// J. T. Wen, IK-Geo, 2022.
class ClosedForm {
 public:
  /// Four roots, each with two ways to turn the rest, make eight. Near singular poses there are more representatives, and nearly
  /// fitted chains have solutions of their own.
  static constexpr int kMaxSolutions = 16;
  struct Solutions {
    std::array<Config6, kMaxSolutions> q;
    int count = 0;
    [[nodiscard]] const Config6* begin() const { return q.data(); }
    [[nodiscard]] const Config6* end() const { return q.data() + count; }
  };

  /// None where no three axes in the right place meet or are parallel, or where the first two axes of the position coincide.
  [[nodiscard]] static std::optional<ClosedForm> of(const SixChain& chain);

  /// Of the two ways to turn three axes that meet, which differ by half a turn of the first and the third.
  enum class Ways { kBoth, kOne };

  /// Distinct configurations in (-pi, pi], limits not applied, in a fixed order: each reaches the pose within 1e-9 m and rad on the
  /// exact chain, by forward kinematics. At a singular pose a family has some representatives, not all. Allocates nothing; plain
  /// IEEE arithmetic but for atan2 (and sin, cos where Newton is needed).
  [[nodiscard]] Solutions solve(const Pose& tool, Ways ways = Ways::kBoth) const;

  /// Unchecked starts for an iteration that may move the locked joint too: solutions of the fitted chain, and the neighbourhood of
  /// complex ones whose discriminants are within `slack` (relative) of zero.
  [[nodiscard]] Solutions starts(const Pose& tool, double slack, Ways ways = Ways::kBoth) const;

  [[nodiscard]] const SixChain& chain() const { return chain_; }
  [[nodiscard]] const ClosedFormFit& fit() const { return fit_; }

 private:
  SixChain chain_;  // exact
  ClosedFormFit fit_;
  bool reversed_ = false;  // the method sees joints 6, 5, ... 1 and the inverse displacement
  double slack_ = 0;       // how far below zero a relative discriminant may be
  double aligned_ = 0;     // sine below which axes may be aligned on the exact chain
  Pose home_inverse_ = Pose::Identity();
  std::variant<SphericalWrist, ThreeParallel> method_;
};

/// How a seven-joint chain is solved in closed form: with one joint locked. A six-joint arm whose tool may turn about its own axis
/// is such a chain too: its last joint is that turn.
struct LockMethod {
  std::array<std::optional<ClosedFormFit>, kDof> by_joint;  ///< none: locking that joint gives no closed form
  int best = -1;      ///< the joint to lock: of those possible, the one that self-motion turns most on average; -1: none
  bool roll = false;  ///< the last joint is the roll of the tool of an arm of six
  /// For people, e.g. "closed form: axes 1, 2 and 3 meet in a point; locks joint 5 (or 4, 6, 7)". An arm of six joints has no joint
  /// 7: there it is "the roll", the turn of the tool about its own axis.
  [[nodiscard]] std::string words() const;
};
[[nodiscard]] LockMethod lock_method(const Chain& chain);

}  // namespace swivel
