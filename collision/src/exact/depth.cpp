// SPDX-License-Identifier: BSD-3-Clause
#include "exact/depth.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "exact/medial_set.hpp"

namespace swivel::detail {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kDepthTolerance = 0.02e-3;  // m
constexpr int kMostPatches = 20'000;         // looked at before the search is cut short
constexpr int kMostCorners = 2'000;          // of a mesh, looked for in another mesh

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

/// Returns an upper bound, m, of the sum of a patch's depth and the depth in a convex solid, over
/// all points of the patch. `tangent` is that of the solid's depth at the point `at`.
double most_on(const Patch& patch, const Vector3d& at, const Tangent& tangent) {
  double most = -kInfinity;
  for (std::size_t k = 0; k < static_cast<std::size_t>(patch.corners); ++k)
    most = std::max(most, patch.depth[k] + tangent.depth + tangent.slope.dot(patch.at[k] - at));
  return most;
}

/// Returns the distance from a point of the corner of a patch that is furthest from it, m.
double radius_about(const Patch& patch, const Vector3d& point) {
  double radius = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(patch.corners); ++k)
    radius = std::max(radius, (patch.at[k] - point).norm());
  return radius;
}

/// Returns the middle of a patch and its depth there.
std::pair<Vector3d, double> middle_of(const Patch& patch) {
  Vector3d at = Vector3d::Zero();
  double depth = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(patch.corners); ++k) {
    at += patch.at[k] / patch.corners;
    depth += patch.depth[k] / patch.corners;
  }
  return {at, depth};
}

/// Returns the centre and radius, m, of a ball about patches.
std::pair<Vector3d, double> ball_about(std::span<const Patch> patches) {
  Vector3d middle = Vector3d::Zero();
  for (const Patch& patch : patches)
    middle += middle_of(patch).first / static_cast<double>(patches.size());
  double radius = 0;
  for (const Patch& patch : patches) radius = std::max(radius, radius_about(patch, middle));
  return {middle, radius};
}

/// A convex solid that is placed in another frame, in which points and slopes are given.
class PlacedSolid {
 public:
  PlacedSolid(const Shape& shape, const Pose& pose)
      : shape_(shape), pose_(pose), back_(pose.inverse(Eigen::Isometry)) {}
  [[nodiscard]] Tangent tangent_at(const Vector3d& p) const {
    Tangent tangent = std::visit(TangentAt{back_ * p}, shape_);
    tangent.slope = pose_.linear() * tangent.slope;
    return tangent;
  }

 private:
  const Shape& shape_;
  Pose pose_, back_;
};

/// Bounds how deep the points of patches, in a closed mesh's frame, lie beneath its surface, m,
/// less than 0 outside.
class MeshDepth {
 public:
  explicit MeshDepth(const MeshModel& mesh) : tree_(mesh.triangles()), solid_(mesh.solid()) {}
  /// Returns true if the whole ball of this radius, m, lies outside of the mesh.
  bool is_outside(const Vector3d& middle, double radius) {
    return tree_.distance({middle, Vector3d::Zero()}, 0, radius, nearest_) >= radius &&
           !solid_.contains(middle);
  }
  /// Returns how deep a point lies beneath the surface of the mesh, m.
  double depth(const Vector3d& p) {
    constexpr double kFarAway = 1e6;  // m
    point_ = p;
    const double surface = tree_.distance({p, Vector3d::Zero()}, 0, kFarAway, nearest_);
    inside_ = solid_.contains(p);
    return depth_ = inside_ ? surface : -surface;
  }
  /// Returns the gradient of the depth at the last point asked about; zero on the surface.
  [[nodiscard]] Vector3d slope() const {
    return depth_ != 0 ? Vector3d((tree_.nearest_on(point_, nearest_) - point_) / -depth_)
                       : Vector3d::Zero();
  }
  /// Returns an upper bound, m, of the sum of a patch's depth and the depth in the mesh, over all
  /// points of the patch. depth() must have been called last with a point of the patch.
  [[nodiscard]] double most_on(const Patch& patch) const {
    const auto half_space = half_space_about(radius_about(patch, point_));
    double by_distance = -kInfinity, by_triangle = -kInfinity;
    for (std::size_t k = 0; k < static_cast<std::size_t>(patch.corners); ++k) {
      const double way = (patch.at[k] - point_).norm();
      by_distance = std::max(by_distance, patch.depth[k] + depth_ + way);
      // No point lies deeper than its distance from any one triangle, and that distance is convex.
      by_triangle =
          std::max(by_triangle, patch.depth[k] + tree_.distance_at(patch.at[k], nearest_));
    }
    return std::min({by_distance, by_triangle,
                     half_space ? detail::most_on(patch, point_, *half_space) : kInfinity});
  }
  /// Returns an upper bound, m, of the sum of the patches' depth and the depth in the mesh, over
  /// all points of the patches that lie in the mesh, or minus infinity if none does. The bound is
  /// that of the half-space that touches the mesh where it is nearest to the middle of the patches;
  /// infinity if there is no such half-space.
  double most_in_half_space(std::span<const Patch> patches) {
    const auto [middle, radius] = ball_about(patches);
    depth(middle);
    const auto half_space = half_space_about(radius);
    if (!half_space) return kInfinity;
    double most = -kInfinity, deepest = -kInfinity;
    for (const Patch& patch : patches)
      for (std::size_t k = 0; k < static_cast<std::size_t>(patch.corners); ++k) {
        const double here = half_space->depth + half_space->slope.dot(patch.at[k] - middle);
        deepest = std::max(deepest, here);
        most = std::max(most, patch.depth[k] + here);
      }
    return deepest < 0 ? -kInfinity : most;
  }

 private:
  /// Looks for a half-space such that no point within `radius` of the last point asked about is
  /// deeper in the mesh than in the half-space, whose border is square to the way from that point
  /// to the nearest one of the mesh. All triangles that may be the nearest to one of the points lie
  /// in it. Returns the depth of the last point in the half-space and its gradient; none if the
  /// triangles reach further along that way than `radius`, or there is mesh beyond the border.
  [[nodiscard]] std::optional<Tangent> half_space_about(double radius) const {
    constexpr double kApart = 1e-6;  // m
    const double far = std::abs(depth_);
    if (far < kApart) return std::nullopt;
    const Vector3d nearest = tree_.nearest_on(point_, nearest_), normal = -slope();
    const double border = normal.dot(nearest),
                 reach = tree_.reach_near(point_, 3 * radius + far + 2 * kApart, normal, border,
                                          border + radius) -
                         border;
    if (reach > radius || solid_.contains(nearest + (reach + kApart) * normal)) return std::nullopt;
    return Tangent{depth_ + reach + kApart, -normal};
  }

  const TriangleTree& tree_;
  const ClosedMesh& solid_;
  Vector3d point_ = Vector3d::Zero();
  double depth_ = 0;
  bool inside_ = false;
  int nearest_ = 0;
};

/// Bounds the greatest value of a function over patches, by branch and bound.
class Greatest {
 public:
  /// The search ends once the value is known within half of kDepthTolerance, is proved to be at
  /// most `from`, or is found to be more than `enough`, m.
  Greatest(double from, double enough) : from_(from), enough_(enough) {}
  void find(double value) { found_ = std::max(found_, value); }
  /// Returns a value such that patches with no more need not be looked at.
  [[nodiscard]] double of_interest() const { return std::max(found_ + kDepthTolerance / 2, from_); }
  [[nodiscard]] bool is_enough() const { return found_ > enough_; }
  /// Takes note that a part that is not looked at has no value above `most`.
  void leave(double most) { left_ = std::max(left_, most); }
  /// Adds a patch with a bound of its values, m. `slope` is the gradient of the function, but for
  /// the patch's own depth, near the middle of the patch.
  void add(const Patch& patch, double most, const Vector3d& slope) {
    ++asked_;
    if (most <= of_interest())
      leave(most);
    else
      open_.push({most, asked_, patch, slope});
  }
  /// Halves the patches that were added. `look_at(patch)` is called with each half; it finds a
  /// value, and adds or leaves the half.
  template <class LookAt>
  void search(const LookAt& look_at) {
    while (!open_.empty() && asked_ < kMostPatches && open_.top().most > of_interest() &&
           !is_enough()) {
      const auto [first, second] = open_.top().patch.halves(open_.top().slope);
      open_.pop();
      look_at(first);
      look_at(second);
    }
    if (!open_.empty()) leave(open_.top().most);
    open_ = {};
  }
  [[nodiscard]] Depth bounds() const { return {found_, std::max(found_, left_)}; }

 private:
  struct Open {
    double most;
    int asked;
    Patch patch;
    Vector3d slope;
    bool operator<(const Open& other) const {
      return std::pair(most, -asked) < std::pair(other.most, -other.asked);
    }
  };
  double from_, enough_, found_ = -kInfinity, left_ = -kInfinity;
  int asked_ = 0;
  std::priority_queue<Open> open_;
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
  MeshDepth mesh(*b.shape->mesh);
  double found = -kInfinity;
  for (std::size_t k = 0; k < corners.size(); k += stride)
    if (const Vector3d p = in_b * corners[k]; b.shape->mesh->solid().contains(p))
      found = std::max(found, mesh.depth(p));
  return found;
}

/// Bounds the greatest depth of the surface of a mesh in a convex solid.
Depth depth_of_surface(const TriangleTree& surface, const PlacedSolid& solid, double from,
                       double enough) {
  Greatest greatest(from, enough);
  const auto look_at = [&](const Patch& patch) {
    const Vector3d at = middle_of(patch).first;
    const Tangent tangent = solid.tangent_at(at);
    greatest.find(tangent.depth);
    greatest.add(patch, most_on(patch, at, tangent), tangent.slope);
  };
  const auto most_in_box = [&](const Vector3d& center, const Vector3d& half) {
    const Tangent tangent = solid.tangent_at(center);
    return tangent.depth + tangent.slope.cwiseAbs().dot(half);
  };
  const auto look_at_triangle = [&](const Triangle& t) {
    for (const Vector3d& corner : {t.a, Vector3d(t.a + t.ab), Vector3d(t.a + t.ac)})
      greatest.find(solid.tangent_at(corner).depth);
    look_at(triangle(t.a, 0, t.a + t.ab, 0, t.a + t.ac, 0));
    greatest.search(look_at);
    return greatest.is_enough() ? kInfinity : greatest.of_interest();
  };
  greatest.leave(surface.visit_best_first(most_in_box, greatest.of_interest(), look_at_triangle));
  return greatest.bounds();
}

/// Bounds the depth of a body with a known medial set, which lies at `in_b` in the other's frame.
Depth depth_by_medial_set(const Shape& a, const Pose& in_b, const FclShape& b, double from,
                          double enough) {
  Medial medial = medial_of(a, kDepthTolerance);
  for (Patch& patch : medial.patches)
    for (Vector3d& corner : patch.at) corner = in_b * corner;
  std::optional<MeshDepth> mesh;
  if (b.mesh) mesh.emplace(*b.mesh);
  const bool by_surface = mesh && medial.patches.size() > 1;
  Depth of_surface{-kInfinity, -kInfinity};
  if (by_surface) {
    const double most = mesh->most_in_half_space(medial.patches) + medial.off;
    if (std::isfinite(most) && most <= from) return {-kInfinity, most};
    of_surface = depth_of_surface(b.mesh->triangles(), PlacedSolid(a, in_b), from, enough);
    if (of_surface.at_least > enough) return {of_surface.at_least, kInfinity};
    // The body's points that are deeper in it than any point of the mesh's surface lie all in the
    // mesh, if its centre does, or all outside.
    if (!b.mesh->solid().contains(in_b.translation()))
      std::erase_if(medial.patches, [&](const Patch& patch) {
        return patch.least_depth() > of_surface.at_most + medial.off;
      });
  }

  Greatest greatest(std::max(from - medial.off, of_surface.at_least + kDepthTolerance / 2),
                    enough + medial.off);
  const auto look_at = [&](const Patch& patch) {
    const auto [middle, beneath] = middle_of(patch);
    if (!mesh) {
      const Tangent tangent = std::visit(TangentAt{middle}, b.shape);
      greatest.find(beneath + tangent.depth);
      return greatest.add(patch, most_on(patch, middle, tangent), tangent.slope);
    }
    // No point outside of the mesh is deeper than some point of its surface.
    if (by_surface && mesh->is_outside(middle, radius_about(patch, middle))) return;
    const double here = beneath + mesh->depth(middle);
    greatest.find(here);
    greatest.add(patch, patch.corners == 1 ? here : mesh->most_on(patch), mesh->slope());
  };
  const auto look_at_all = [&](const auto& self, std::span<const Patch> patches) -> void {
    if (patches.size() <= 1) {
      for (const Patch& patch : patches) look_at(patch);
      return;
    }
    if (by_surface) {
      const double most = mesh->most_in_half_space(patches);
      if (most <= greatest.of_interest()) return greatest.leave(most);
    }
    const std::size_t half = patches.size() / 2;
    self(self, patches.first(half));
    self(self, patches.subspan(half));
  };
  look_at_all(look_at_all, medial.patches);
  greatest.search(look_at);
  const Depth inside = greatest.bounds();
  return {std::max(of_surface.at_least, inside.at_least - medial.off),
          std::max(of_surface.at_most, inside.at_most + medial.off)};
}

/// Returns an upper bound of the depth of two meshes, m: that of the box about the smaller one,
/// along the axes of its frame.
double most_of_meshes(const PlacedShapeRef& a, const PlacedShapeRef& b, double from) {
  const Eigen::AlignedBox3d box = a.shape->mesh->triangles().box(),
                            other = b.shape->mesh->triangles().box();
  if (other.diagonal().norm() < box.diagonal().norm()) return most_of_meshes(b, a, from);
  const Pose in_b = b.pose->inverse(Eigen::Isometry) * *a.pose * Eigen::Translation3d(box.center());
  return depth_by_medial_set(Box{box.sizes()}, in_b, *b.shape, from, kInfinity).at_most;
}

}  // namespace

Depth depth(const PlacedShapeRef& a, const PlacedShapeRef& b, double from, double enough) {
  if (!has_inside(*a.shape) || !has_inside(*b.shape)) return {-kInfinity, kInfinity};
  if (a.shape->mesh && b.shape->mesh)
    return {std::max(deepest_corner(a, b), deepest_corner(b, a)), most_of_meshes(a, b, from)};
  if (patches_of(*b.shape) < patches_of(*a.shape)) return depth(b, a, from, enough);
  return depth_by_medial_set(a.shape->shape, b.pose->inverse(Eigen::Isometry) * *a.pose, *b.shape,
                             from, enough);
}

}  // namespace swivel::detail
