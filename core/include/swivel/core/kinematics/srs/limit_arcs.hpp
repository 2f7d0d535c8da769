// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "swivel/core/kinematics/equations/trigonometric.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"

namespace swivel {

/// An arc of arm angles from begin to end, counter-clockwise, rad: begin in [-pi, pi], begin <= end
/// <= begin + 2 pi. The whole circle is -pi to pi.
struct AngleArc {
  double begin = 0, end = 0;
  /// Returns true if the arc is the whole circle.
  [[nodiscard]] bool whole() const { return end - begin >= kTwoPi; }
};

/// The angles that a joint may have, whole turns ignored.
class AngleRange {
 public:
  /// Makes the range from lower to upper, rad: all angles if that is a turn or more, none if upper
  /// < lower.
  AngleRange(double lower, double upper);
  /// Returns true if every angle is in the range.
  [[nodiscard]] bool all() const { return all_; }
  [[nodiscard]] const Angle& lower() const { return lower_; }
  [[nodiscard]] const Angle& upper() const { return upper_; }
  /// Returns true if the direction (x, y), of any length, is in the range.
  [[nodiscard]] bool holds(double x, double y) const;

 private:
  Angle lower_, upper_;
  bool all_, none_, wide_;  // wide_: over half a turn
};

/// Finds the arm angles at which a triple of joints keeps to its ranges, in closed form (Shimizu et
/// al. 2008). With the rows x, y, z, u, v of a TripleCircle, each a sin(phi) + b cos(phi) + c:
/// where the sine of the middle angle is positive, the first joint is the angle of (x, y) and the
/// last that of (-u, v), and cos(middle + shift) = z; where it is negative, both are half a turn
/// from there. So the ends of ranges are roots of waves, at most two arm angles each, and between
/// them nothing changes.
class TripleLimits {
 public:
  /// Takes the lower and upper ends of the first, middle and last joint's range, rad, and `shift`
  /// of the EulerTriple.
  TripleLimits(const std::array<std::array<double, 2>, 3>& ranges, double shift);
  /// Replaces `out` by the arcs of one tool pose for one sign of the middle angle's sine
  /// (`negative`), ascending and disjoint. Their ends are exact to rounding divided by how fast the
  /// joint passes there; where a joint only touches the end of its range, to 1e-7 rad.
  void arcs(const TripleCircle& circle, bool negative, std::vector<AngleArc>& out) const;

 private:
  std::array<AngleRange, 3> ranges_;  // the middle joint's includes the shift
};

/// Replaces `out` by the arcs that lie in both a and b, in the order of their begins.
void common_arcs(const std::vector<AngleArc>& a, const std::vector<AngleArc>& b,
                 std::vector<AngleArc>& out);

}  // namespace swivel
