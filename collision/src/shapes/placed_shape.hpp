// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "shapes/fcl_shapes.hpp"

namespace swivel::detail {

/// A body where it is.
struct PlacedShapeRef {
  const FclShape* shape;
  const Pose* pose;  ///< of the shape, base frame
};

/// A point of one lies inside the other, which is a closed mesh. Decides where surfaces do not meet: FCL sees a mesh as a surface.
[[nodiscard]] bool one_inside_other(const PlacedShapeRef& a, const PlacedShapeRef& b);

/// A point of one, or of a part of it if it is a mesh, lies inside the other, which is a box or cylinder. Decides where triangles
/// of their surfaces do not meet.
[[nodiscard]] bool one_inside_solid(const PlacedShapeRef& a, const PlacedShapeRef& b);

}  // namespace swivel::detail
