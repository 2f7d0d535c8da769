// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "shapes/fcl_shapes.hpp"

namespace swivel::detail {

/// A shape and its pose. Refers to both, which must outlive it.
struct PlacedShapeRef {
  const FclShape* shape;
  const Pose* pose;  ///< of the shape, base frame
};

/// Returns true if a point of one body lies inside the other, which is a closed mesh. If the
/// surfaces do not meet, this tells whether one contains the other; FCL does not, because it sees a
/// mesh as a surface.
[[nodiscard]] bool one_inside_other(const PlacedShapeRef& a, const PlacedShapeRef& b);

/// Returns true if a point of one body (for a mesh: of any of its connected parts) lies inside the
/// other, which is a box or cylinder. If the triangles of their surfaces do not meet, this tells
/// whether one contains the other.
[[nodiscard]] bool one_inside_solid(const PlacedShapeRef& a, const PlacedShapeRef& b);

}  // namespace swivel::detail
