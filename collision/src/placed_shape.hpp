// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "fcl_shapes.hpp"

namespace swivel::detail {

/// A body where it is.
struct PlacedShapeRef {
  const FclShape* shape;
  const Pose* pose;  ///< of the shape, base frame
};

/// A point of one lies inside the other, which is a closed mesh. Decides where surfaces do not meet: FCL sees a mesh as a surface.
[[nodiscard]] bool one_inside_other(const PlacedShapeRef& a, const PlacedShapeRef& b);

}  // namespace swivel::detail
