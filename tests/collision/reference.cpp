// SPDX-License-Identifier: BSD-3-Clause
#include "reference.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace swivel::testing {

namespace {

using Point = Vector3d;
constexpr double kFar = std::numeric_limits<double>::max();
using Triangle = std::array<Point, 3>;

struct Segment {
  Point a, b;
  [[nodiscard]] Point at(double t) const { return a + t * (b - a); }
};

double to_segment(const Point& p, const Segment& s) {
  const Point d = s.b - s.a;
  const double t =
      d.squaredNorm() > 0 ? std::clamp((p - s.a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - s.at(t)).norm();
}

/// Least value of a convex function on [0, 1], by golden sections.
template <class F>
double least_on_unit(const F& f) {
  constexpr double kGolden = 0.6180339887498949;
  double low = 0, high = 1, x = 1 - kGolden, y = kGolden, fx = f(x), fy = f(y);
  for (int k = 0; k < 36; ++k) {
    if (fx < fy) {
      high = y;
      y = x;
      fy = fx;
      x = high - kGolden * (high - low);
      fx = f(x);
    } else {
      low = x;
      x = y;
      fx = fy;
      y = low + kGolden * (high - low);
      fy = f(y);
    }
  }
  return std::min({f(0), f(1), fx, fy});
}

double point_triangle(const Point& p, const Triangle& t) {
  const Point normal = (t[1] - t[0]).cross(t[2] - t[0]);
  if (normal.squaredNorm() > 0) {
    bool above = true;
    for (std::size_t k = 0; k < 3; ++k)
      above = above && (t[(k + 1) % 3] - t[k]).cross(p - t[k]).dot(normal) >= 0;
    if (above) return std::abs((p - t[0]).dot(normal.normalized()));
  }
  return std::min(
      {to_segment(p, {t[0], t[1]}), to_segment(p, {t[1], t[2]}), to_segment(p, {t[2], t[0]})});
}

/// The distance of a point to a convex set is convex along a segment.
double segment_triangle(const Segment& s, const Triangle& t) {
  return least_on_unit([&](double x) { return point_triangle(s.at(x), t); });
}

double triangle_triangle(const Triangle& s, const Triangle& t) {
  double least = kFar;
  for (std::size_t k = 0; k < 3; ++k) {
    least = std::min(least, segment_triangle({s[k], s[(k + 1) % 3]}, t));
    least = std::min(least, segment_triangle({t[k], t[(k + 1) % 3]}, s));
  }
  return least;
}

double point_box(const Point& p, const Box& box) {
  return (p.cwiseAbs() - box.size / 2).cwiseMax(0).norm();
}
double point_cylinder(const Point& p, const Cylinder& c) {
  return std::hypot(std::max(0.0, std::hypot(p.x(), p.y()) - c.radius),
                    std::max(0.0, std::abs(p.z()) - c.length / 2));
}

struct Circle {
  Pose X;  ///< about its z axis
  double radius = 0;
  [[nodiscard]] Point at(double turns) const {
    return X * Point(radius * std::cos(kTwoPi * turns), radius * std::sin(kTwoPi * turns), 0);
  }
};

/// A convex primitive: its points' distance, the edges and circles that carry its corners, and the
/// ball it is grown by.
struct Convex {
  std::function<double(const Point&)> distance;  ///< base frame, before growing
  std::vector<Segment> edges;
  std::vector<Circle> rims;
  Segment axis;
  double growth = 0, tube = 0;  ///< tube: radius about the axis between its ends (cylinder)
};

Convex convex_of(const Shape& shape, const Pose& X) {
  Convex c;
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    c.growth = sphere->radius;
    c.edges = {{X.translation(), X.translation()}};
    c.distance = [X](const Point& p) { return (p - X.translation()).norm(); };
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    c.growth = capsule->radius;
    const Segment core{X * Point(0, 0, -capsule->length / 2), X * Point(0, 0, capsule->length / 2)};
    c.edges = {core};
    c.distance = [core](const Point& p) { return to_segment(p, core); };
  } else if (const auto* box = std::get_if<Box>(&shape)) {
    const auto corner = [&](int k) {
      return X *
             Point(
                 Point(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1).cwiseProduct(box->size / 2));
    };
    for (int k = 0; k < 8; ++k)
      for (const int bit : {1, 2, 4})
        if (!(k & bit)) c.edges.push_back({corner(k), corner(k | bit)});
    c.distance = [X, size = *box](const Point& p) { return point_box(X.inverse() * p, size); };
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    for (const double side : {-0.5, 0.5})
      c.rims.push_back({X * Eigen::Translation3d(0, 0, side * cylinder->length), cylinder->radius});
    c.axis = {X * Point(0, 0, -cylinder->length / 2), X * Point(0, 0, cylinder->length / 2)};
    c.edges = {c.axis};  // inside, so it adds nothing but crossings
    c.tube = cylinder->radius;
    c.distance = [X, size = *cylinder](const Point& p) {
      return point_cylinder(X.inverse() * p, size);
    };
  }
  return c;
}

/// Least distance from the edges and rims of a to the solid b.
template <class Distance>
double edges_to(const Convex& a, const Distance& distance) {
  double least = kFar;
  for (const Segment& s : a.edges)
    least = std::min(least, least_on_unit([&](double x) { return distance(s.at(x)); }));
  for (const Circle& rim : a.rims) {
    constexpr int kSamples = 120;
    int best = 0;
    double at_best = kFar;
    for (int k = 0; k < kSamples; ++k)
      if (const double d = distance(rim.at(static_cast<double>(k) / kSamples)); d < at_best) {
        best = k;
        at_best = d;
      }
    least = std::min({least, at_best, least_on_unit([&](double x) {
                        return distance(rim.at((best - 1 + 2 * x) / kSamples));
                      })});
  }
  return least;
}

/// Two cylinders' sides: the common normal of the axes, where it lies between the ends.
double sides(const Convex& a, const Convex& b) {
  if (a.tube == 0 || b.tube == 0) return kFar;
  const Point u = a.axis.b - a.axis.a, v = b.axis.b - b.axis.a, w = a.axis.a - b.axis.a;
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), determinant = uu * vv - uv * uv;
  if (determinant < 1e-12 * uu * vv) return kFar;
  const double s = (uv * v.dot(w) - vv * u.dot(w)) / determinant,
               t = (uu * v.dot(w) - uv * u.dot(w)) / determinant;
  if (s < 0 || s > 1 || t < 0 || t > 1) return kFar;
  return std::max(0.0, (a.axis.at(s) - b.axis.at(t)).norm() - a.tube - b.tube);
}

double convex_convex(const Convex& a, const Convex& b) {
  const double least = std::min({edges_to(a, b.distance), edges_to(b, a.distance), sides(a, b)});
  return std::max(0.0, least - a.growth - b.growth);
}

double convex_triangle(const Convex& a, const Triangle& t) {
  double least = edges_to(a, [&](const Point& p) { return point_triangle(p, t); });
  for (std::size_t k = 0; k < 3; ++k) {
    const Segment edge{t[k], t[(k + 1) % 3]};
    least = std::min(least, least_on_unit([&](double x) { return a.distance(edge.at(x)); }));
  }
  return std::max(0.0, least - a.growth);
}

/// No point of the triangle is further than this from its first corner.
double size_of(const Triangle& t) {
  return std::max((t[1] - t[0]).norm(), (t[2] - t[0]).norm());
}

std::vector<Triangle> triangles_of(const TriangleMesh& mesh, const Pose& X) {
  std::vector<Triangle> result;
  for (const auto& t : mesh.triangles) {
    Triangle triangle;
    for (std::size_t k = 0; k < 3; ++k) triangle[k] = X * mesh.vertices[t[k]];
    result.push_back(triangle);
  }
  return result;
}

bool inside(const MeshPtr& mesh, const Pose& X, const Point& p) {
  return mesh->closed && winding_number(*mesh, X.inverse() * p) > 0.5;
}

Point some_point(const Shape& shape, const Pose& X) {
  const auto* mesh = std::get_if<MeshPtr>(&shape);
  return mesh ? X * (*mesh)->vertices[0] : X.translation();
}

}  // namespace

double winding_number(const TriangleMesh& mesh, const Vector3d& point) {
  double angle = 0;
  for (const auto& t : mesh.triangles) {
    std::array<Vector3d, 3> v;
    for (std::size_t k = 0; k < 3; ++k) v[k] = mesh.vertices[t[k]] - point;
    const double a = v[0].norm(), b = v[1].norm(), c = v[2].norm();
    angle +=
        2 * std::atan2(v[0].dot(v[1].cross(v[2])),
                       a * b * c + v[0].dot(v[1]) * c + v[1].dot(v[2]) * a + v[2].dot(v[0]) * b);
  }
  return angle / (4 * kPi);
}

double reference_clearance(const Shape& a, const Pose& X_a, const Shape& b, const Pose& X_b) {
  const auto* mesh_a = std::get_if<MeshPtr>(&a);
  const auto* mesh_b = std::get_if<MeshPtr>(&b);
  if (mesh_a && inside(*mesh_a, X_a, some_point(b, X_b))) return 0;
  if (mesh_b && inside(*mesh_b, X_b, some_point(a, X_a))) return 0;
  if (!mesh_a && !mesh_b) return convex_convex(convex_of(a, X_a), convex_of(b, X_b));
  double least = kFar;
  if (mesh_a && mesh_b) {
    const auto other = triangles_of(**mesh_b, X_b);
    for (const Triangle& s : triangles_of(**mesh_a, X_a))
      for (const Triangle& t : other)
        if ((s[0] - t[0]).norm() - size_of(s) - size_of(t) < least)
          least = std::min(least, triangle_triangle(s, t));
  } else {
    const Convex convex = mesh_a ? convex_of(b, X_b) : convex_of(a, X_a);
    for (const Triangle& t : triangles_of(mesh_a ? **mesh_a : **mesh_b, mesh_a ? X_a : X_b))
      if (convex.distance(t[0]) - size_of(t) - convex.growth < least)
        least = std::min(least, convex_triangle(convex, t));
  }
  constexpr double kCrossing =
      1e-7;  // what the one-dimensional searches leave where an edge crosses a side
  return least < kCrossing ? 0 : least;
}

}  // namespace swivel::testing
