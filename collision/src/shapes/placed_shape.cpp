// SPDX-License-Identifier: BSD-3-Clause
#include "shapes/placed_shape.hpp"

#include <algorithm>
#include <cmath>

namespace swivel::detail {

namespace {

/// Returns true if `outer` is a closed mesh and a point of `inner` lies inside it.
bool holds_a_point(const PlacedShapeRef& outer, const PlacedShapeRef& inner) {
  if (!outer.shape->mesh || !outer.shape->mesh->is_closed()) return false;
  const ClosedMesh& solid = outer.shape->mesh->solid();
  const Pose to_outer = outer.pose->inverse(Eigen::Isometry) * *inner.pose;
  if (!inner.shape->mesh) return solid.contains(to_outer.translation());
  const auto& points = inner.shape->mesh->part_points();
  return std::any_of(points.begin(), points.end(),
                     [&](const Vector3d& p) { return solid.contains(to_outer * p); });
}

bool holds(const Box& box, const Vector3d& p) {
  return (p.cwiseAbs().array() <= box.size.array() / 2).all();
}
bool holds(const Cylinder& cylinder, const Vector3d& p) {
  return std::hypot(p.x(), p.y()) <= cylinder.radius && std::abs(p.z()) <= cylinder.length / 2;
}

/// Returns true if `outer` is a box or cylinder and a point of `inner` lies inside it.
bool solid_holds_a_point(const PlacedShapeRef& outer, const PlacedShapeRef& inner) {
  if (outer.shape->kind != FclShape::Kind::kSolid) return false;
  const Pose to_outer = outer.pose->inverse(Eigen::Isometry) * *inner.pose;
  const auto held = [&](const Vector3d& p) {
    const auto* box = std::get_if<Box>(&outer.shape->shape);
    return box ? holds(*box, to_outer * p)
               : holds(std::get<Cylinder>(outer.shape->shape), to_outer * p);
  };
  if (!inner.shape->mesh) return held(Vector3d::Zero());
  const auto& points = inner.shape->mesh->part_points();
  return std::any_of(points.begin(), points.end(), held);
}

}  // namespace

bool one_inside_other(const PlacedShapeRef& a, const PlacedShapeRef& b) {
  return holds_a_point(a, b) || holds_a_point(b, a);
}

bool one_inside_solid(const PlacedShapeRef& a, const PlacedShapeRef& b) {
  return solid_holds_a_point(a, b) || solid_holds_a_point(b, a);
}

}  // namespace swivel::detail
