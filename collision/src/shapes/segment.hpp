// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/base/types.hpp"

namespace swivel::detail {

/// start + t along, 0 <= t <= 1; a point where `along` is zero. Metres, any one frame.
struct Segment {
  Vector3d start, along;
  [[nodiscard]] Vector3d at(double t) const { return start + t * along; }
};

/// Corners a, a + ab, a + ac; the unit normal is along ab x ac.
struct Triangle {
  Triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c);
  [[nodiscard]] Segment edge(int k) const;  ///< k = 0, 1, 2
  [[nodiscard]] Triangle moved(const Pose& pose) const;
  Vector3d a, ab, ac, normal;
};

/// Squared distances, m^2, in closed form. Ericson, Real-Time Collision Detection (2005), 5.1.9. Their rounding stays below
/// 1e-7 m of distance for bodies of metres, nearly parallel segments included.
[[nodiscard]] double squared_distance(const Segment& s, const Segment& t);
/// Something not below `limit`, m^2, where the squared distance is not.
[[nodiscard]] double squared_distance(const Segment& s, const Triangle& t, double limit);
[[nodiscard]] double squared_distance(const Triangle& s, const Triangle& t, double limit);

}  // namespace swivel::detail
