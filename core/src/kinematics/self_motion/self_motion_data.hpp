// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "kinematics/newton/pose_newton.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/equations/alignment.hpp"
#include "swivel/core/kinematics/self_motion/self_motion.hpp"

namespace swivel {

// What self_motion.cpp, self_motion_curves.cpp and self_motion_arcs.cpp have in common.
namespace self_motion {

using Point = PoseNewton::Point;

constexpr double kSingular = 1e-6;  // rad from alignment of a triple
inline const Config kPlain = Config::Ones();

/// Returns a - b less its nearest whole number of turns, rad.
inline double difference(double a, double b) {
  constexpr double kRound = 0x1.8p52;  // added and taken away again, it rounds to an integer
  const double d = a - b;
  return d - kTwoPi * ((d * (1 / kTwoPi) + kRound) - kRound);
}

/// Returns difference() of all joints; of the one that slides (0-based; -1: none) plainly a - b.
inline Config difference(const Config& a, const Config& b, int slide) {
  Config d;
  for (int j = 0; j < kDof; ++j) d[j] = difference(a[j], b[j]);
  if (slide >= 0) d[slide] = a[slide] - b[slide];
  return d;
}

/// Returns wrap_angle(angle), without its division where there is nothing to wrap.
inline double wrapped(double angle) {
  return std::abs(angle) < 3 ? angle : wrap_angle(angle);
}

/// The cubic from a point to another with their tangents, scaled by its chord, relative to the
/// first point.
struct Cubic {
  Config d, m0, m1;  // chord, and tangents times its length
  Cubic(const Point& a, const Point& b, double sign_b, int slide) : d(difference(b.q, a.q, slide)) {
    const double length = joint_norm(d);
    m0 = length * a.tangent;
    m1 = (length * sign_b) * b.tangent;
  }
  [[nodiscard]] Config at(double u) const {
    return u * m0 + (u * u) * (3 * d - 2 * m0 - m1) + (u * u * u) * (m0 + m1 - 2 * d);
  }
  [[nodiscard]] double at(int j, double u) const {
    return u * (m0[j] + u * (3 * d[j] - 2 * m0[j] - m1[j] + u * (m0[j] + m1[j] - 2 * d[j])));
  }
};

/// The other way to turn a rigid body by three axes that meet in a point, each perpendicular to the
/// next: a half turn about the first, the second on the other side of alignment, a half turn back
/// about the third. All other joints stay, so self-motion curves come in pairs.
class Flip {
 public:
  Flip() = default;
  Flip(int first, double aligned) : first_(first), aligned_(aligned) {}
  [[nodiscard]] bool none() const { return first_ < 0; }
  [[nodiscard]] int first() const { return first_; }
  [[nodiscard]] double aligned() const { return aligned_; }
  /// Returns true if q is on the side of a pair that is computed; at the alignment, to rounding,
  /// both are.
  [[nodiscard]] bool kept(const Config& q) const {
    return none() || std::sin(q[first_ + 1] - aligned_) > -1e-9;
  }
  void apply(Config& q) const {
    q[first_] += kPi;
    q[first_ + 1] = 2 * aligned_ - q[first_ + 1];
    q[first_ + 2] += kPi;
  }
  void apply(Point& p) const {
    apply(p.q);
    p.tangent[first_ + 1] = -p.tangent[first_ + 1];
  }

 private:
  int first_ = -1;  // first joint of the triple, 0-based; -1: none
  double aligned_ = 0;
};

}  // namespace self_motion

/// What SelfMotion knows of a chain before any pose is given.
struct SelfMotionData {
  explicit SelfMotionData(const Chain& chain) : newton(chain) {}
  PoseNewton newton;
  int lock = -1, other = 0;  // lock: the joint to lock; other: any joint but that
  int slide = -1;            // the joint that slides, which is locked; -1: none
  std::array<double, kDof> lower{}, upper{};
  std::array<bool, kDof> circle{};
  Config scale, scale2;
  std::vector<Alignment> alignments;
  self_motion::Flip flip;                            // of curves, one of two is sought
  bool flip_keeps_limits = false;                    // the flip keeps the limits
  std::vector<std::pair<double, ClosedForm>> forms;  // by lock value; none without a lock
  std::vector<Config> starts;                        // of Newton, without a lock

  [[nodiscard]] double image(double angle, std::size_t j) const {
    if (circle[j]) return self_motion::wrapped(angle);
    if (static_cast<int>(j) == slide) return angle;
    if (angle >= lower[j] && angle <= upper[j]) return angle;  // ends stand on limits bit for bit
    const double middle = (lower[j] + upper[j]) / 2;
    return middle + self_motion::wrapped(angle - middle);
  }
  [[nodiscard]] bool inside(const Config& q) const {
    for (std::size_t j = 0; j < kDof; ++j) {
      if (circle[j]) continue;
      const double value = image(q[static_cast<Eigen::Index>(j)], j);
      if (!(value >= lower[j] && value <= upper[j])) return false;
    }
    return true;
  }
  /// Whether three axes line up within an angle, rad.
  [[nodiscard]] bool aligned(const Config& q, double within = self_motion::kSingular) const {
    return std::any_of(alignments.begin(), alignments.end(), [&](const Alignment& a) {
      return std::abs(wrap_angle(q[a.joint] - a.angle)) < within;
    });
  }
  /// Returns the configuration at a pose to which damped Newton steps lead from q, where three axes
  /// line up at one of the two; none elsewhere.
  [[nodiscard]] std::optional<Config> image_past_alignment(const Config& q,
                                                           const Pose& tool) const {
    constexpr double kFarthest = 0.35;  // rad: of q from an alignment
    if (!aligned(q, kFarthest)) return std::nullopt;
    const auto p = newton.through_singular(q, tool);
    if (!p || !(aligned(q) || aligned(p->q))) return std::nullopt;
    return p->q;
  }
  /// Whether the move passes over an alignment.
  [[nodiscard]] bool passes_alignment(const Config& q, const Config& move) const {
    return std::any_of(alignments.begin(), alignments.end(), [&](const Alignment& a) {
      const double before = wrap_angle(q[a.joint] - a.angle), after = before + move[a.joint];
      return (before > 0) != (after > 0) || std::abs(after) < self_motion::kSingular;
    });
  }
};

}  // namespace swivel
