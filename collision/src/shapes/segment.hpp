// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/base/types.hpp"

namespace swivel::detail {

/// The points start + t * along, 0 <= t <= 1; a single point if `along` is zero. Metres, in any one
/// frame.
struct Segment {
  Vector3d start, along;
  [[nodiscard]] Vector3d at(double t) const { return start + t * along; }
};

/// A triangle with the corners a, a + ab and a + ac, m. Its unit normal points along ab x ac.
struct Triangle {
  Triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c);
  [[nodiscard]] Segment edge(int k) const;  ///< k = 0, 1, 2
  /// Returns the triangle moved by `pose`.
  [[nodiscard]] Triangle moved(const Pose& pose) const;
  Vector3d a, ab, ac, normal;
};

/// Returns the squared distance of two segments, m^2, in closed form (Ericson, Real-Time Collision
/// Detection, 2005, 5.1.9). The rounding error is below 1e-7 m of distance for bodies of metres,
/// nearly parallel segments included.
[[nodiscard]] double squared_distance(const Segment& s, const Segment& t);
/// Returns the squared distance of a segment and a triangle, m^2, or any value of at least `limit`,
/// m^2, if the distance is not below that.
[[nodiscard]] double squared_distance(const Segment& s, const Triangle& t, double limit);
/// Returns the squared distance of two triangles, m^2, or `limit`, m^2, if the distance is not
/// below that.
[[nodiscard]] double squared_distance(const Triangle& s, const Triangle& t, double limit);

}  // namespace swivel::detail
