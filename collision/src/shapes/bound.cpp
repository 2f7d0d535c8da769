// SPDX-License-Identifier: BSD-3-Clause
#include "shapes/bound.hpp"

#include <algorithm>
#include <cmath>

namespace swivel::detail {

namespace {

struct BoundVisitor {
  Bound operator()(const Sphere& s) const { return {Vector3d::Zero(), Vector3d::Zero(), s.radius}; }
  Bound operator()(const Box& b) const { return {Vector3d::Zero(), b.size / 2, 0}; }
  Bound operator()(const Cylinder& c) const {
    return {Vector3d::Zero(), Vector3d(c.radius, c.radius, c.length / 2), 0};
  }
  Bound operator()(const Capsule& c) const {
    return {Vector3d::Zero(), Vector3d(0, 0, c.length / 2), c.radius};
  }
  Bound operator()(const MeshPtr& mesh) const {
    Eigen::AlignedBox3d box;
    for (const auto& triangle : mesh->triangles)
      for (const int v : triangle) box.extend(mesh->vertices[v]);
    return {box.center(), box.sizes() / 2, 0};
  }
};

/// Returns the widest gap of two bounding volumes along the axes of both boxes, m.
double gap_along_box_axes(const Bound& a, const Matrix3d& axes_a, const Bound& b,
                          const Matrix3d& axes_b, const Vector3d& offset) {
  const Matrix3d turn = (axes_a.transpose() * axes_b).cwiseAbs();
  const Vector3d along_a = (axes_a.transpose() * offset).cwiseAbs() - a.half - turn * b.half;
  const Vector3d along_b =
      (axes_b.transpose() * offset).cwiseAbs() - b.half - turn.transpose() * a.half;
  return std::max(along_a.maxCoeff(), along_b.maxCoeff()) - a.radius - b.radius;
}

}  // namespace

Bound bound_of(const Shape& shape) {
  Bound bound = std::visit(BoundVisitor{}, shape);
  bound.reach = bound.half.norm() + bound.radius;
  return bound;
}

PlacedBound place(const Bound& bound, const Pose& pose) {
  return {pose * bound.center, pose.linear()};
}

double motion(const Bound& bound, const PlacedBound& from, const PlacedBound& to) {
  const Eigen::Vector4d squares((to.center - from.center).squaredNorm(),
                                (to.axes.col(0) - from.axes.col(0)).squaredNorm(),
                                (to.axes.col(1) - from.axes.col(1)).squaredNorm(),
                                (to.axes.col(2) - from.axes.col(2)).squaredNorm());
  const Eigen::Vector4d moved = squares.cwiseSqrt();  // centre, ends of the axes
  return moved[0] + bound.half.dot(moved.tail<3>());
}

double ball_distance_bound(const Bound& a, const PlacedBound& at_a, const Bound& b,
                           const PlacedBound& at_b) {
  return (at_b.center - at_a.center).norm() - a.reach - b.reach;
}

double distance_bound(const Bound& a, const PlacedBound& at_a, const Bound& b,
                      const PlacedBound& at_b) {
  const Vector3d offset = at_b.center - at_a.center;
  return std::max(offset.norm() - a.reach - b.reach,
                  gap_along_box_axes(a, at_a.axes, b, at_b.axes, offset));
}

bool proved_apart(const Bound& a, const PlacedBound& at_a, const Bound& b, const PlacedBound& at_b,
                  double d) {
  const Vector3d offset = at_b.center - at_a.center;
  const double reach = a.reach + b.reach + d;
  return offset.squaredNorm() >= reach * reach ||
         gap_along_box_axes(a, at_a.axes, b, at_b.axes, offset) >= d;
}

}  // namespace swivel::detail
