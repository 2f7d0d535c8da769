// SPDX-License-Identifier: BSD-3-Clause
#include "exact/medial_set.hpp"

#include <algorithm>
#include <cmath>

namespace swivel::detail {

namespace {

Patch point(const Vector3d& at, double depth) {
  Patch patch;
  patch.add(at, depth);
  return patch;
}
Medial axis_of(double radius, double length) {
  Patch axis;
  axis.add(Vector3d(0, 0, -length / 2), radius);
  axis.add(Vector3d(0, 0, length / 2), radius);
  return {{axis}};
}

/// Returns the medial set of a box: quadrilaterals from each edge inwards at 45 degrees, and the
/// rectangle in the middle of the shortest side, in which they end.
Medial medial_of(const Box& box) {
  const Vector3d half = box.size / 2;
  Eigen::Index least = 0;
  const double deepest = half.minCoeff(&least);
  const Vector3d inner = half - Vector3d::Constant(deepest);
  Medial medial;
  const auto add_quad = [&](const std::array<Vector3d, 4>& c, const std::array<double, 4>& d) {
    medial.patches.push_back(triangle(c[0], d[0], c[1], d[1], c[2], d[2]));
    medial.patches.push_back(triangle(c[0], d[0], c[2], d[2], c[3], d[3]));
  };
  for (Eigen::Index along = 0; along < 3; ++along)
    for (const double first : {-1.0, 1.0})
      for (const double second : {-1.0, 1.0}) {
        Vector3d sign;
        sign[(along + 1) % 3] = first;
        sign[(along + 2) % 3] = second;
        const auto corner = [&](const Vector3d& size, double side) {
          sign[along] = side;
          return Vector3d(size.cwiseProduct(sign));
        };
        add_quad({corner(half, -1), corner(half, 1), corner(inner, 1), corner(inner, -1)},
                 {0, 0, deepest, deepest});
      }
  const Eigen::Index u = (least + 1) % 3, v = (least + 2) % 3;
  const auto middle = [&](double side_u, double side_v) {
    Vector3d p = Vector3d::Zero();
    p[u] = side_u * inner[u];
    p[v] = side_v * inner[v];
    return p;
  };
  add_quad({middle(-1, -1), middle(1, -1), middle(1, 1), middle(-1, 1)},
           {deepest, deepest, deepest, deepest});
  return medial;
}

/// Returns the medial set of a cylinder: cones from both rims inwards at 45 degrees, and what lies
/// between their inner ends, which is a part of the axis or, in a flat cylinder, a disc. Circles
/// are replaced by polygons.
Medial medial_of(const Cylinder& cylinder, double tolerance) {
  const double radius = cylinder.radius, half = cylinder.length / 2,
               deepest = std::min(radius, half);
  const double inner = radius - deepest, height = half - deepest;
  const int sides =
      std::clamp(static_cast<int>(std::ceil(kPi / std::sqrt(2 * tolerance / (4 * radius)))), 8, 64);
  Medial medial;
  medial.off = radius * (1 - std::cos(kPi / sides));
  const auto on_circle = [&](int k, double r, double z) {
    const double angle = kTwoPi * k / sides;
    return Vector3d(r * std::cos(angle), r * std::sin(angle), z);
  };
  for (const double side : {-1.0, 1.0})
    for (int k = 0; k < sides; ++k) {
      const Vector3d a = on_circle(k, radius, side * half),
                     b = on_circle(k + 1, radius, side * half);
      const Vector3d c = on_circle(k + 1, inner, side * height),
                     d = on_circle(k, inner, side * height);
      medial.patches.push_back(triangle(a, 0, b, 0, c, deepest));
      if (inner > 0) medial.patches.push_back(triangle(a, 0, c, deepest, d, deepest));
    }
  for (int k = 0; k < sides && inner > 0; ++k)
    medial.patches.push_back(triangle(Vector3d::Zero(), deepest, on_circle(k, inner, 0), deepest,
                                      on_circle(k + 1, inner, 0), deepest));
  if (height > 0) medial.patches.push_back(axis_of(deepest, 2 * height).patches[0]);
  return medial;
}

struct MedialOf {
  double tolerance;
  Medial operator()(const Sphere& s) const { return {{point(Vector3d::Zero(), s.radius)}}; }
  Medial operator()(const Capsule& c) const { return axis_of(c.radius, c.length); }
  Medial operator()(const Box& b) const { return medial_of(b); }
  Medial operator()(const Cylinder& c) const { return medial_of(c, tolerance); }
  Medial operator()(const MeshPtr&) const { return {}; }
};

}  // namespace

Patch triangle(const Vector3d& a, double of_a, const Vector3d& b, double of_b, const Vector3d& c,
               double of_c) {
  Patch patch;
  patch.add(a, of_a);
  patch.add(b, of_b);
  patch.add(c, of_c);
  return patch;
}

Medial medial_of(const Shape& shape, double tolerance) {
  return std::visit(MedialOf{tolerance}, shape);
}

}  // namespace swivel::detail
