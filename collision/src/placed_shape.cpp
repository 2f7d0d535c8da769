// SPDX-License-Identifier: BSD-3-Clause
#include "placed_shape.hpp"

#include <algorithm>

namespace swivel::detail {

namespace {

/// A point of `inner` lies in the solid mesh `outer`.
bool holds_a_point(const PlacedShapeRef& outer, const PlacedShapeRef& inner) {
  if (!outer.shape->mesh || !outer.shape->mesh->solid()) return false;
  const ClosedMesh& solid = *outer.shape->mesh->solid();
  const Pose to_outer = outer.pose->inverse(Eigen::Isometry) * *inner.pose;
  if (!inner.shape->mesh) return solid.contains(to_outer.translation());
  const auto& points = inner.shape->mesh->part_points();
  return std::any_of(points.begin(), points.end(), [&](const Vector3d& p) { return solid.contains(to_outer * p); });
}

}  // namespace

bool one_inside_other(const PlacedShapeRef& a, const PlacedShapeRef& b) {
  return holds_a_point(a, b) || holds_a_point(b, a);
}

}  // namespace swivel::detail
