// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/problem/shape.hpp"

namespace swivel::detail {

/// A box in the shape's axes, grown by a ball: it contains the shape. A capsule is a degenerate box with a radius, so that its
/// round sides cost nothing.
struct Bound {
  Vector3d center = Vector3d::Zero();  ///< in the shape's frame
  Vector3d half = Vector3d::Zero();    ///< half edge lengths of the box
  double radius = 0;                   ///< of the ball
  double reach = 0;                    ///< radius of the ball about `center` that contains the shape
};
[[nodiscard]] Bound bound_of(const Shape& shape);

/// A bound where its body is.
struct PlacedBound {
  Vector3d center;
  Matrix3d axes;
};
[[nodiscard]] PlacedBound place(const Bound& bound, const Pose& pose);

/// No point of a body's core (the shape itself, or what a ball grows to it) moves further than this between two places, m.
[[nodiscard]] double motion(const Bound& bound, const PlacedBound& from, const PlacedBound& to);

/// A number that the distance of the two bodies cannot be below, m: the widest gap along the line of centres and the six box axes.
[[nodiscard]] double distance_bound(const Bound& a, const PlacedBound& at_a, const Bound& b, const PlacedBound& at_b);
/// The same by the line of centres alone; cheap.
[[nodiscard]] double ball_distance_bound(const Bound& a, const PlacedBound& at_a, const Bound& b, const PlacedBound& at_b);
/// True only if distance_bound >= d; asks the cheap balls first.
[[nodiscard]] bool proved_apart(const Bound& a, const PlacedBound& at_a, const Bound& b, const PlacedBound& at_b, double d);

}  // namespace swivel::detail
