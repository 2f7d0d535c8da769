// SPDX-License-Identifier: BSD-3-Clause
#include "proofs/distance_proof.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "swivel/collision/proofs/verdict.hpp"

namespace swivel::detail {

namespace {

constexpr double kRounding = 1e-6;  // far above what these distances lose, far below the band

constexpr Proof kCollides{DistanceProof::kColliding};

/// Turns a distance into a verdict. The distance exceeds the clearance by at most `growth`. A
/// distance below `low` is a collision, one of at least `high` is free, and distances beyond `far`
/// need not be told apart. All in metres.
struct Range {
  double growth, low, high, far;
  Range(double d, double margin, double growth_within, double growth_between = 0)
      : growth(growth_within + growth_between),
        low(d + growth_within - kVerdictBand - kRounding),
        high(d + growth + kVerdictBand + kRounding),
        far(high + margin) {}
  [[nodiscard]] Proof of(double distance) const {
    if (distance < low) return kCollides;
    return {distance >= high ? DistanceProof::kFree : DistanceProof::kNone,
            distance - growth - kRounding};
  }
};

bool is_round(const PlacedShapeRef& body) {
  return body.shape->kind == FclShape::Kind::kRound;
}
/// Returns true for a cylinder that is little smaller than the capsule around it.
bool is_rod(const PlacedShapeRef& body) {
  const auto* cylinder = std::get_if<Cylinder>(&body.shape->shape);
  return cylinder && cylinder->length >= 2 * cylinder->radius;
}

/// The core of a sphere, a capsule or a rod: its radius and, along z of the shape's frame, its
/// length, m.
struct Core {
  double radius, length;
};
Core core_of(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return {sphere->radius, 0};
  if (const auto* rod = std::get_if<Cylinder>(&shape)) return {rod->radius, rod->length};
  const auto& capsule = std::get<Capsule>(shape);
  return {capsule.radius, capsule.length};
}
double radius_of(const PlacedShapeRef& round) {
  return core_of(round.shape->shape).radius;
}
/// Returns the core segment, base frame.
Segment core_of(const PlacedShapeRef& round) {
  const Vector3d along = core_of(round.shape->shape).length * round.pose->linear().col(2);
  return {round.pose->translation() - along / 2, along};
}

Segment in_frame(const Segment& s, const Pose& frame) {
  return {frame.linear().transpose() * (s.start - frame.translation()),
          frame.linear().transpose() * s.along};
}

/// Returns the vector from the nearest point of a solid to the point p, in the solid's frame.
Vector3d way_out(const Box& box, const Vector3d& p) {
  return (p.cwiseAbs() - box.size / 2).cwiseMax(0).cwiseProduct(p.cwiseSign());
}
Vector3d way_out(const Cylinder& cylinder, const Vector3d& p) {
  const double r = std::hypot(p.x(), p.y());
  const double aside = r > cylinder.radius ? 1 - cylinder.radius / r : 0;
  return {aside * p.x(), aside * p.y(),
          std::copysign(std::max(0.0, std::abs(p.z()) - cylinder.length / 2), p.z())};
}

/// Returns how deep a point p inside the solid lies beneath its surface, m.
double depth(const Cylinder& cylinder, const Vector3d& p) {
  return std::min(cylinder.radius - std::hypot(p.x(), p.y()),
                  cylinder.length / 2 - std::abs(p.z()));
}

/// Compares the distance of a segment from a convex solid with a range. The distance is convex
/// along the segment, so its least value lies between the values and the tangents on both sides.
template <class Solid>
Proof bracket(const Segment& s, const Solid& solid, const Range& range) {
  struct Place {
    double t, distance, slope;
  };
  const auto at = [&](double t) {
    const Vector3d out = way_out(solid, s.at(t));
    const double distance = out.norm();
    return Place{t, distance, distance > 0 ? out.dot(s.along) / distance : 0};
  };
  constexpr int kSteps = 40;
  Place left = at(0), right = at(1);
  for (int step = 0; step < kSteps; ++step) {
    if (std::min(left.distance, right.distance) < range.low) return kCollides;
    if (left.slope >= 0) return range.of(left.distance);
    if (right.slope <= 0) return range.of(right.distance);
    const double to_crossing = (right.distance - left.distance - right.slope * (right.t - left.t)) /
                               (left.slope - right.slope);
    if (const Proof proof = range.of(left.distance + left.slope * to_crossing);
        proof.proved == DistanceProof::kFree)
      return proof;
    const Place middle = at(left.t + to_crossing);
    (middle.slope < 0 ? left : right) = middle;
  }
  return {};
}

Proof prove_round(const PlacedShapeRef& round, const PlacedShapeRef& other, double d, double margin,
                  int& triangle) {
  const Segment core = core_of(round);
  const double radius = radius_of(round);
  if (is_round(other))
    return Range(d, margin, radius + radius_of(other))
        .of(std::sqrt(squared_distance(core, core_of(other))));
  const Segment there = in_frame(core, *other.pose);
  const Range range(d, margin, radius);
  if (const auto* box = std::get_if<Box>(&other.shape->shape)) return bracket(there, *box, range);
  if (const auto* cylinder = std::get_if<Cylinder>(&other.shape->shape))
    return bracket(there, *cylinder, range);
  const Proof surface =
      range.of(other.shape->triangles().distance(there, range.low, range.far, triangle));
  return surface.proved != DistanceProof::kColliding && one_inside_other(round, other) ? kCollides
                                                                                       : surface;
}

/// Returns the distance of a point from a solid, m; if the point is inside, minus its depth.
double signed_distance(const Box& box, const Vector3d& p) {
  const Vector3d out = p.cwiseAbs() - box.size / 2;
  const double most = out.maxCoeff();
  return most <= 0 ? most : out.cwiseMax(0).norm();
}
double signed_distance(const Cylinder& cylinder, const Vector3d& p) {
  const double out = way_out(cylinder, p).norm();
  return out > 0 ? out : -depth(cylinder, p);
}
/// Returns true if the signed distance of a point from a solid is below `low`, m.
bool is_nearer(const Box& box, const Vector3d& p, double low) {
  const Vector3d out = p.cwiseAbs() - box.size / 2;
  const double most = out.maxCoeff();
  return most < low && (most <= 0 || out.cwiseMax(0).squaredNorm() < low * low);
}
bool is_nearer(const Cylinder& cylinder, const Vector3d& p, double low) {
  return signed_distance(cylinder, p) < low;
}

/// Returns true if `holds` returns true for a corner or the middle of the triangle.
template <class Holds>
bool any_point(const Holds& holds, const Triangle& t) {
  return holds(t.a) || holds(t.a + t.ab) || holds(t.a + t.ac) || holds(t.a + (t.ab + t.ac) / 3);
}
/// Looks for a corner or middle of a triangle of `body` whose signed distance from the box or
/// cylinder `solid` is below `low`, m, and returns true if it finds one. Returns false for bodies
/// of other kinds. `first` is a warm start.
bool finds_deeper(double low, const PlacedShapeRef& solid, const PlacedShapeRef& body, int& first) {
  if (solid.shape->kind != FclShape::Kind::kSolid || !body.shape->has_triangles()) return false;
  const Pose to_solid = solid.pose->inverse(Eigen::Isometry) * *body.pose;
  const auto seek = [&](const auto& shape) {
    const auto gap = [&](const Vector3d& p) { return signed_distance(shape, to_solid * p); };
    const auto nearer = [&](const Vector3d& p) { return is_nearer(shape, to_solid * p, low); };
    return body.shape->triangles().seek(
        low, gap, [&](const Triangle& t) { return any_point(nearer, t); }, first);
  };
  if (const auto* box = std::get_if<Box>(&solid.shape->shape)) return seek(*box);
  return seek(std::get<Cylinder>(solid.shape->shape));
}
/// Looks for a part of the surface of `body` that is well inside `solid`, without searching the
/// whole surface. It proves only what the whole search would prove (a prism lacks what is beyond
/// it), so it only saves time.
bool finds_nearer(double d, const PlacedShapeRef& solid, const PlacedShapeRef& body, int& first) {
  const double low = d - solid.shape->beyond_triangles;
  return low > 0 && finds_deeper(low, solid, body, first);
}

}  // namespace

double surface_distance(const PlacedShapeRef& a, const PlacedShapeRef& b, double enough,
                        double limit, TrianglePair& warm_start) {
  const Pose b_in_a = a.pose->inverse(Eigen::Isometry) * *b.pose;
  return a.shape->triangles().distance(b.shape->triangles(), b_in_a, enough, limit, warm_start);
}

double distance_at(const PlacedShapeRef& a, const PlacedShapeRef& b,
                   const TrianglePair& warm_start) {
  if (!a.shape->has_triangles() || !b.shape->has_triangles())
    return std::numeric_limits<double>::infinity();
  return a.shape->triangles().distance_at(b.shape->triangles(),
                                          a.pose->inverse(Eigen::Isometry) * *b.pose, warm_start);
}

namespace {

Proof prove_triangles(const PlacedShapeRef& a, const PlacedShapeRef& b, double d, double margin,
                      TrianglePair& warm_start, Expected expected) {
  if (!a.shape->has_triangles() || !b.shape->has_triangles()) return {};
  const Range range(d, margin, 0, a.shape->beyond_triangles + b.shape->beyond_triangles);
  if (expected == Expected::kAny &&
      (finds_nearer(range.low, b, a, warm_start.a) || finds_nearer(range.low, a, b, warm_start.b)))
    return kCollides;
  const Proof surface = range.of(surface_distance(a, b, range.low, range.far, warm_start));
  if (surface.proved == DistanceProof::kColliding) return surface;
  const bool surfaces_apart = surface.proved == DistanceProof::kFree || range.low > 0;
  const bool inside = one_inside_other(a, b) || (surfaces_apart && one_inside_solid(a, b));
  return inside ? kCollides : surface;
}

}  // namespace

Proof prove(const PlacedShapeRef& a, const PlacedShapeRef& b, double d, double margin,
            TrianglePair& warm_start, Expected expected) {
  if (is_round(a)) return prove_round(a, b, d, margin, warm_start.b);
  if (is_round(b)) return prove_round(b, a, d, margin, warm_start.a);
  // The capsule around a rod often proves more than the prism with its long triangles does.
  if (is_rod(a))
    if (const Proof proof = prove_round(a, b, d, margin, warm_start.b);
        proof.proved == DistanceProof::kFree)
      return proof;
  if (is_rod(b))
    if (const Proof proof = prove_round(b, a, d, margin, warm_start.a);
        proof.proved == DistanceProof::kFree)
      return proof;
  return prove_triangles(a, b, d, margin, warm_start, expected);
}

bool are_triangles(const PlacedShapeRef& a, const PlacedShapeRef& b) {
  return a.shape->has_triangles() && b.shape->has_triangles() && a.shape->beyond_triangles == 0 &&
         b.shape->beyond_triangles == 0;
}

double triangle_distance(const PlacedShapeRef& a, const PlacedShapeRef& b, double enough,
                         double limit, TrianglePair& warm_start) {
  const double surfaces = surface_distance(a, b, enough, limit, warm_start);
  return surfaces > 0 && (one_inside_other(a, b) || one_inside_solid(a, b)) ? 0 : surfaces;
}

bool proves_beyond(const PlacedShapeRef& a, const PlacedShapeRef& b, double d,
                   TrianglePair& warm_start) {
  if (!are_triangles(a, b)) return prove(a, b, d, 0, warm_start).proved == DistanceProof::kFree;
  const double far = d + kTriangleBand;
  return triangle_distance(a, b, far, far, warm_start) >= far;
}

bool proves_below(const PlacedShapeRef& a, const PlacedShapeRef& b, double d,
                  TrianglePair& warm_start) {
  if (is_round(b) && !is_round(a)) {
    TrianglePair swapped{warm_start.b, warm_start.a};
    const bool proved = proves_below(b, a, d, swapped);
    warm_start = {swapped.b, swapped.a};
    return proved;
  }
  const double low = d - kVerdictBand - kRounding;
  if (!is_round(a))
    return finds_deeper(low, b, a, warm_start.a) || finds_deeper(low, a, b, warm_start.b);
  if (b.shape->mesh) {
    const Segment core = in_frame(core_of(a), *b.pose);
    const double radius = radius_of(a);
    const auto gap = [&](const Vector3d& p) {
      return std::sqrt(squared_distance(core, Segment{p, Vector3d::Zero()})) - radius;
    };
    const auto nearer = [&](const Vector3d& p) { return gap(p) < low; };
    return b.shape->triangles().seek(
        low, gap, [&](const Triangle& t) { return any_point(nearer, t); }, warm_start.b);
  }
  // nothing but the distance of the core decides where b has no triangles of its own
  int unused = 0;
  return prove_round(a, b, d, 0, unused).proved == DistanceProof::kColliding;
}

DistanceProof prove_distance(const PlacedShapeRef& a, const PlacedShapeRef& b, double d) {
  TrianglePair none;
  return prove(a, b, d, 0, none).proved;
}

}  // namespace swivel::detail
