// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "shapes/placed_shape.hpp"

namespace swivel::detail {

/// What a distance proof, which needs no FCL, shows about one pair of bodies.
enum class DistanceProof { kFree, kColliding, kNone };

/// Compares the clearance of two bodies with d >= 0, m, without FCL. Returns kFree if the clearance
/// is proved to be at least d + kVerdictBand; kColliding if it is proved to be below d -
/// kVerdictBand, or one body holds a point of the other, as in FCL's verdict; kNone otherwise, and
/// then FCL has to decide.
///
/// A sphere or capsule is a core (a point or segment) and a radius, so its distance is one of
/// segments: in closed form to segments and triangles (segment.hpp), bracketed to boxes and
/// cylinders. Boxes, cylinders and meshes among each other are compared as triangles; a cylinder is
/// a prism inside it plus a bound of what the prism lacks.
/// The result depends on the arguments alone. Safe to call from many threads.
[[nodiscard]] DistanceProof prove_distance(const PlacedShapeRef& a, const PlacedShapeRef& b,
                                           double d);

/// The result of a distance proof: the verdict and, if it is kFree, a lower bound of the clearance,
/// m.
struct Proof {
  DistanceProof proved = DistanceProof::kNone;
  double bound = 0;
};
/// What the caller expects of a pair. kFree omits the search for a triangle well inside the other
/// body, which only saves time when bodies collide. The verdict is the same.
enum class Expected { kAny, kFree };
/// Compares the clearance of two bodies with d >= 0, m, as prove_distance() does, and for kFree
/// also returns a lower bound of the clearance, which is sought up to `margin`, m, beyond d.
/// `warm_start` is a warm start: the triangles of a and of b, where they have any, at which the
/// search begins and, on return, ended. For bodies that have moved little since, one look there
/// often proves the same again; the verdict does not depend on it.
[[nodiscard]] Proof prove(const PlacedShapeRef& a, const PlacedShapeRef& b, double d, double margin,
                          TrianglePair& warm_start, Expected expected = Expected::kAny);

/// The most, m, that triangle_distance() and FCL may differ by for meshes and boxes. Both use
/// closed forms, except that FCL's GJK errs by 0.05 um for boxes.
inline constexpr double kTriangleBand = 1e-6;
/// Returns the distance, m, of the triangles of two bodies that both have some, if it lies in
/// [enough, limit]; outside of that range it returns what TriangleTree::distance() does.
/// `warm_start` is a warm start.
[[nodiscard]] double surface_distance(const PlacedShapeRef& a, const PlacedShapeRef& b,
                                      double enough, double limit, TrianglePair& warm_start);
/// Returns the distance, m, of triangle witness.a of body a and triangle witness.b of body b, which
/// is an upper bound of the distance of their surfaces. Infinite if a body has no triangles.
[[nodiscard]] double distance_at(const PlacedShapeRef& a, const PlacedShapeRef& b,
                                 const TrianglePair& warm_start);
/// Returns true if each of the bodies is a mesh or a box, whose surface consists of triangles.
[[nodiscard]] bool are_triangles(const PlacedShapeRef& a, const PlacedShapeRef& b);
/// Returns the distance, m, of two bodies for which are_triangles() holds: 0 if one contains the
/// other, else surface_distance().
[[nodiscard]] double triangle_distance(const PlacedShapeRef& a, const PlacedShapeRef& b,
                                       double enough, double limit, TrianglePair& warm_start);
/// Returns true if the clearance is proved to exceed d > 0, m, by at least the amount that FCL may
/// err. `warm_start` is a warm start.
[[nodiscard]] bool proves_beyond(const PlacedShapeRef& a, const PlacedShapeRef& b, double d,
                                 TrianglePair& warm_start);

/// Returns true if a point of one body is found that proves that their clearance is below d -
/// kVerdictBand, m; if d is below zero, that the point lies deeper than that inside the other body.
/// The points tried are corners and middles of triangles, or the core of a sphere or capsule; the
/// other body is a box, a cylinder, a capsule or a sphere. If the result is false, there may still
/// be such a point. `warm_start` is a warm start.
[[nodiscard]] bool proves_below(const PlacedShapeRef& a, const PlacedShapeRef& b, double d,
                                TrianglePair& warm_start);

}  // namespace swivel::detail
