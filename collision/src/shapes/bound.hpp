// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/problem/shape.hpp"

namespace swivel::detail {

/// A bounding volume of a shape: a box along the shape's axes, grown by a ball. For a capsule the
/// box degenerates to its axis, so that its round sides are bounded exactly.
struct Bound {
  Vector3d center = Vector3d::Zero();  ///< in the shape's frame
  Vector3d half = Vector3d::Zero();    ///< half edge lengths of the box
  double radius = 0;                   ///< of the ball
  /// radius of the ball about `center` that contains the shape
  double reach = 0;
};
/// Returns the bounding volume of a shape, in the shape's frame.
[[nodiscard]] Bound bound_of(const Shape& shape);

/// The centre and the axes (columns) of a bounding volume, base frame.
struct PlacedBound {
  Vector3d center;
  Matrix3d axes;
};
/// Returns the bounding volume's centre and axes for a body at `pose`, base frame.
[[nodiscard]] PlacedBound place(const Bound& bound, const Pose& pose);

/// Returns an upper bound, m, of how far any point of the body's core (the shape itself or, if a
/// ball grows the box, the box) moves between two placements.
[[nodiscard]] double motion(const Bound& bound, const PlacedBound& from, const PlacedBound& to);

/// Returns a lower bound of the distance of two bodies, m: the widest gap along the line of centres
/// and the six box axes. Negative if their bounds overlap.
[[nodiscard]] double distance_bound(const Bound& a, const PlacedBound& at_a, const Bound& b,
                                    const PlacedBound& at_b);
/// Returns a lower bound of the distance of two bodies, m, by the balls about their centres alone.
/// Cheaper and weaker than distance_bound().
[[nodiscard]] double ball_distance_bound(const Bound& a, const PlacedBound& at_a, const Bound& b,
                                         const PlacedBound& at_b);
/// Returns true if the distance of the two bodies is proved to be at least d, m, by the criterion
/// of distance_bound(). Tests the cheap balls first.
[[nodiscard]] bool proved_apart(const Bound& a, const PlacedBound& at_a, const Bound& b,
                                const PlacedBound& at_b, double d);

}  // namespace swivel::detail
