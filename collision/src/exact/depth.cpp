// SPDX-License-Identifier: BSD-3-Clause
#include "exact/depth.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

namespace swivel::detail {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDepthTolerance = 0.02e-3;  // m
constexpr int kMostPatches = 20'000;         // looked at before the search is cut short
constexpr int kMostCorners = 2'000;          // of a mesh, looked for in another mesh

/// A point, a segment or a triangle (1, 2 or 3 `corners`) of a body's medial set. `depth` is how
/// deep each corner lies beneath the body's surface, m, and is linear in between.
struct Patch {
  int corners = 0;
  std::array<Vector3d, 3> at{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  std::array<double, 3> depth{};

  void add(const Vector3d& corner, double beneath) {
    at[static_cast<std::size_t>(corners)] = corner;
    depth[static_cast<std::size_t>(corners++)] = beneath;
  }
  /// Returns the two halves of the patch, which is divided across its longest edge.
  [[nodiscard]] std::pair<Patch, Patch> halves() const {
    const auto edge = [&](std::size_t k) { return (at[(k + 1) % 3] - at[k]).squaredNorm(); };
    std::size_t from = 0;
    if (corners == 3)
      for (std::size_t k = 1; k < 3; ++k)
        if (edge(k) > edge(from)) from = k;
    const std::size_t to = corners == 3 ? (from + 1) % 3 : 1;
    std::pair<Patch, Patch> halves{*this, *this};
    halves.first.at[to] = halves.second.at[from] = (at[from] + at[to]) / 2;
    halves.first.depth[to] = halves.second.depth[from] = (depth[from] + depth[to]) / 2;
    return halves;
  }
};

Patch point(const Vector3d& at, double depth) {
  Patch patch;
  patch.add(at, depth);
  return patch;
}
Patch triangle(const Vector3d& a, double of_a, const Vector3d& b, double of_b, const Vector3d& c,
               double of_c) {
  Patch patch;
  patch.add(a, of_a);
  patch.add(b, of_b);
  patch.add(c, of_c);
  return patch;
}

/// The medial set of a body, in its own frame: the points that are locally deepest beneath its
/// surface. For every point in the body there is a point of this set at which the sum of the depths
/// in both bodies is at least as large.
struct Medial {
  std::vector<Patch> patches;
  double off = 0;  ///< no point of the set is further from the patches than this, m
};

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
Medial medial_of(const Cylinder& cylinder) {
  const double radius = cylinder.radius, half = cylinder.length / 2,
               deepest = std::min(radius, half);
  const double inner = radius - deepest, height = half - deepest;
  const int sides = std::clamp(
      static_cast<int>(std::ceil(kPi / std::sqrt(2 * kDepthTolerance / (4 * radius)))), 8, 64);
  Medial medial;
  medial.off = radius * (1 - std::cos(kPi / sides));
  const auto on_circle = [&](int k, double r, double z) {
    const double angle = kTwoPi * k / sides;
    return Vector3d(r * std::cos(angle), r * std::sin(angle), z);
  };
  for (int k = 0; k < sides; ++k) {
    for (const double side : {-1.0, 1.0}) {
      const Vector3d a = on_circle(k, radius, side * half),
                     b = on_circle(k + 1, radius, side * half);
      const Vector3d c = on_circle(k + 1, inner, side * height),
                     d = on_circle(k, inner, side * height);
      medial.patches.push_back(triangle(a, 0, b, 0, c, deepest));
      if (inner > 0) medial.patches.push_back(triangle(a, 0, c, deepest, d, deepest));
    }
    if (inner > 0)
      medial.patches.push_back(triangle(Vector3d::Zero(), deepest, on_circle(k, inner, 0), deepest,
                                        on_circle(k + 1, inner, 0), deepest));
  }
  if (height > 0) medial.patches.push_back(axis_of(deepest, 2 * height).patches[0]);
  return medial;
}

struct MedialOf {
  Medial operator()(const Sphere& s) const { return {{point(Vector3d::Zero(), s.radius)}}; }
  Medial operator()(const Capsule& c) const { return axis_of(c.radius, c.length); }
  Medial operator()(const Box& b) const { return medial_of(b); }
  Medial operator()(const Cylinder& c) const { return medial_of(c); }
  Medial operator()(const MeshPtr&) const { return {}; }
};

/// How deep a point lies beneath the surface of a convex solid, m, less than 0 outside, and the
/// gradient of that depth. The depth is a concave function, so it nowhere exceeds its tangent.
struct Tangent {
  double depth = 0;
  Vector3d slope = Vector3d::Zero();
};
Tangent about(const Vector3d& nearest, double radius, const Vector3d& p) {
  const Vector3d out = p - nearest;
  const double far = out.norm();
  return {radius - far, far > 0 ? Vector3d(-out / far) : Vector3d::Zero()};
}
struct TangentAt {
  const Vector3d& p;
  Tangent operator()(const Sphere& s) const { return about(Vector3d::Zero(), s.radius, p); }
  Tangent operator()(const Capsule& c) const {
    return about({0, 0, std::clamp(p.z(), -c.length / 2, c.length / 2)}, c.radius, p);
  }
  Tangent operator()(const Box& b) const {
    const Vector3d out = p.cwiseAbs() - b.size / 2;
    Eigen::Index most = 0;
    if (const double inside = out.maxCoeff(&most); inside <= 0) {
      Tangent tangent{-inside};
      tangent.slope[most] = p[most] > 0 ? -1 : 1;
      return tangent;
    }
    return about(p.cwiseMin(b.size / 2).cwiseMax(-b.size / 2), 0, p);
  }
  Tangent operator()(const Cylinder& c) const {
    const double r = std::hypot(p.x(), p.y()), aside = c.radius - r,
                 above = c.length / 2 - std::abs(p.z());
    const Vector3d inwards = r > 0 ? Vector3d(-p.x() / r, -p.y() / r, 0) : Vector3d::Zero();
    if (aside >= 0 && above >= 0)
      return aside < above ? Tangent{aside, inwards}
                           : Tangent{above, Vector3d(0, 0, p.z() > 0 ? -1 : 1)};
    const double kept = r > c.radius ? c.radius / r : 1;
    return about({kept * p.x(), kept * p.y(), std::clamp(p.z(), -c.length / 2, c.length / 2)}, 0,
                 p);
  }
  Tangent operator()(const MeshPtr&) const { return {}; }
};

/// Computes how deep points, in the body's frame, lie beneath the surface of one body, m, less than
/// 0 outside.
class Solid {
 public:
  explicit Solid(const FclShape& shape) : shape_(&shape) {}
  double depth(const Vector3d& p) {
    point_ = p;
    if (const auto& mesh = shape_->mesh) {
      constexpr double kFarAway = 1e6;  // m
      const double surface =
          mesh->triangles().distance({p, Vector3d::Zero()}, 0, kFarAway, nearest_);
      tangent_.depth = mesh->solid().contains(p) ? surface : -surface;
    } else {
      tangent_ = std::visit(TangentAt{p}, shape_->shape);
    }
    return tangent_.depth;
  }
  /// Returns an upper bound, m, of the sum of a patch's depth and the depth in this body, over all
  /// points of the patch. depth() must have been called last with a point of the patch.
  [[nodiscard]] double most_on(const Patch& patch) const {
    if (!shape_->mesh) return most_on(patch, tangent_.slope);
    double by_tangent = -kInfinity, by_triangle = -kInfinity;
    if (shape_->mesh && tangent_.depth < -kApart) {
      double radius = 0;
      for (std::size_t k = 0; k < static_cast<std::size_t>(patch.corners); ++k)
        radius = std::max(radius, (patch.at[k] - point_).norm());
      if (const auto slope = slope_outside(radius)) return most_on(patch, *slope) + kApart;
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(patch.corners); ++k) {
      const Vector3d way = patch.at[k] - point_;
      by_tangent = std::max(by_tangent, patch.depth[k] + tangent_.depth + way.norm());
      // No point lies deeper than its distance from any one triangle, and that distance is convex.
      by_triangle = std::max(by_triangle, patch.depth[k] + shape_->mesh->triangles().distance_at(
                                                               patch.at[k], nearest_));
    }
    return std::min(by_tangent, by_triangle);
  }

 private:
  static constexpr double kApart = 1e-9;  // m

  [[nodiscard]] double most_on(const Patch& patch, const Vector3d& slope) const {
    double most = -kInfinity;
    for (std::size_t k = 0; k < static_cast<std::size_t>(patch.corners); ++k)
      most = std::max(most, patch.depth[k] + tangent_.depth + slope.dot(patch.at[k] - point_));
    return most;
  }
  /// Looks for a plane such that no point within `radius` of the last point asked about, which lies
  /// outside of the mesh, is deeper in the mesh than in the half-space behind the plane. Returns
  /// the gradient of the depth in that half-space; none if a triangle that may be the nearest to
  /// one of these points reaches beyond the plane.
  [[nodiscard]] std::optional<Vector3d> slope_outside(double radius) const {
    const TriangleTree& tree = shape_->mesh->triangles();
    const Vector3d nearest = tree.nearest_on(point_, nearest_),
                   normal = (nearest - point_) / tangent_.depth;
    if (tree.reaches_beyond(point_, 3 * radius - tangent_.depth, normal,
                            normal.dot(nearest) + kApart))
      return std::nullopt;
    return Vector3d(-normal);
  }

  const FclShape* shape_;
  Vector3d point_ = Vector3d::Zero();
  Tangent tangent_;
  int nearest_ = 0;
};

/// Returns the dimension of a body's medial set (0 a point or axis, 1 a box, 2 a cylinder, 3 none
/// known), which is used only to order two bodies.
int patches_of(const FclShape& shape) {
  if (shape.mesh) return 3;
  if (std::holds_alternative<Cylinder>(shape.shape)) return 2;
  return std::holds_alternative<Box>(shape.shape) ? 1 : 0;
}

bool has_inside(const FclShape& shape) {
  return !shape.mesh || shape.mesh->is_closed();
}

/// Returns how deep the deepest of at most kMostCorners corners of mesh a lies in mesh b, m; minus
/// infinity if none lies in it.
double deepest_corner(const PlacedShapeRef& a, const PlacedShapeRef& b) {
  const Pose in_b = b.pose->inverse(Eigen::Isometry) * *a.pose;
  const auto& corners = std::get<MeshPtr>(a.shape->shape)->vertices;
  const std::size_t stride = corners.size() / kMostCorners + 1;
  Solid solid(*b.shape);
  double found = -kInfinity;
  for (std::size_t k = 0; k < corners.size(); k += stride)
    if (const Vector3d p = in_b * corners[k]; b.shape->mesh->solid().contains(p))
      found = std::max(found, solid.depth(p));
  return found;
}

}  // namespace

Depth depth(const PlacedShapeRef& a, const PlacedShapeRef& b, double from, double enough) {
  if (!has_inside(*a.shape) || !has_inside(*b.shape)) return {-kInfinity, kInfinity};
  if (a.shape->mesh && b.shape->mesh)
    return {std::max(deepest_corner(a, b), deepest_corner(b, a)), kInfinity};
  if (patches_of(*b.shape) < patches_of(*a.shape)) return depth(b, a, from, enough);

  const Medial medial = std::visit(MedialOf{}, a.shape->shape);
  const Pose in_b = b.pose->inverse(Eigen::Isometry) * *a.pose;
  struct Open {
    double most;
    int asked;
    Patch patch;
    bool operator<(const Open& other) const {
      return std::pair(most, -asked) < std::pair(other.most, -other.asked);
    }
  };
  std::priority_queue<Open> open;
  Solid solid(*b.shape);
  double found = -kInfinity, closed = -kInfinity;
  int asked = 0;
  const auto look_at = [&](const Patch& patch) {
    Vector3d middle = Vector3d::Zero();
    double beneath = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(patch.corners); ++k) {
      middle += patch.at[k] / patch.corners;
      beneath += patch.depth[k] / patch.corners;
    }
    const double here = beneath + solid.depth(middle);
    found = std::max(found, here);
    const double most = patch.corners == 1 ? here : solid.most_on(patch);
    ++asked;
    if (most <= std::max(found + kDepthTolerance / 2, from - medial.off))
      closed = std::max(closed, most);
    else
      open.push({most, asked, patch});
  };
  for (Patch patch : medial.patches) {
    for (Vector3d& corner : patch.at) corner = in_b * corner;
    look_at(patch);
  }
  const double sought = from - medial.off;
  while (!open.empty() && asked < kMostPatches &&
         open.top().most > std::max(found + kDepthTolerance / 2, sought) &&
         found - medial.off <= enough) {
    const auto [first, second] = open.top().patch.halves();
    open.pop();
    look_at(first);
    look_at(second);
  }
  const double most = std::max({found, closed, open.empty() ? -kInfinity : open.top().most});
  return {found - medial.off, most + medial.off};
}

}  // namespace swivel::detail
