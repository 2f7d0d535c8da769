// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "swivel/core/kinematics/equations/trigonometric.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"

namespace swivel {

/// Arm angles from begin to end, counter-clockwise, rad: begin in [-pi, pi], begin <= end <= begin + 2 pi. The whole circle is -pi
/// to pi.
struct AngleArc {
  double begin = 0, end = 0;
  [[nodiscard]] bool whole() const { return end - begin >= kTwoPi; }
};

/// The values that a joint may have, whole turns aside, rad. From lower to upper: a turn or more are all values, less than nothing
/// is none.
class AngleRange {
 public:
  AngleRange(double lower, double upper);
  [[nodiscard]] bool all() const { return all_; }
  [[nodiscard]] const Angle& lower() const { return lower_; }
  [[nodiscard]] const Angle& upper() const { return upper_; }
  /// Whether the angle of (x, y), of any length, is among them.
  [[nodiscard]] bool holds(double x, double y) const;

 private:
  Angle lower_, upper_;
  bool all_, none_, wide_;  // wide_: more than half a turn
};

/// The arm angles at which a triple of joints keeps to ranges, in closed form (Shimizu et al. 2008). With the rows x, y, z, u, v of
/// a TripleCircle, each a sin(phi) + b cos(phi) + c: where the sine of the middle angle is positive, the first joint is the angle
/// of (x, y) and the last that of (-u, v), and cos(middle + shift) = z; where it is negative, both are half a turn from there. So
/// the end of a range is a root of a wave, at most two arm angles, and between the ends of all ranges nothing changes.
class TripleLimits {
 public:
  /// Lower and upper ends for the first, middle and last joint; `shift` of the EulerTriple.
  TripleLimits(const std::array<std::array<double, 2>, 3>& ranges, double shift);
  /// Replaces `out` by the arcs of one pose for one sign of the middle angle's sine, in order and apart. Ends are exact to
  /// rounding, divided by how fast the joint passes there; where it only touches the end of its range, to 1e-7 rad.
  void arcs(const TripleCircle& circle, bool negative, std::vector<AngleArc>& out) const;

 private:
  std::array<AngleRange, 3> ranges_;  // of the middle joint plus the shift
};

/// Replaces `out` by what lies in both, in order of the beginnings.
void common_arcs(const std::vector<AngleArc>& a, const std::vector<AngleArc>& b, std::vector<AngleArc>& out);

}  // namespace swivel
