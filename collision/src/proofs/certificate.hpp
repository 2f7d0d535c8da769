// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "shapes/placed_shape.hpp"

namespace swivel::detail {

/// What is proved of one pair of bodies without FCL.
enum class Certificate { kFree, kColliding, kNone };

/// kFree: their clearance is at least d + kVerdictBand. kColliding: below d - kVerdictBand, or one holds a point of the other, as
/// FCL's verdict has it. Else FCL has to be asked. d >= 0, metres.
///
/// A sphere or capsule is a core (a point or segment) and a radius, so its distance is one of segments: in closed form to segments
/// and triangles (segment.hpp), bracketed to boxes and cylinders. Boxes, cylinders and meshes among each other are compared as
/// triangles, a cylinder as a prism inside it and what the prism may lack.
/// A function of its arguments alone. Const-safe from many threads.
[[nodiscard]] Certificate certify(const PlacedShapeRef& a, const PlacedShapeRef& b, double d);

/// The same, with a number that the clearance is not below where it is kFree, m: looks `margin` beyond d for a larger one.
/// `witness`: triangles (of a and of b, where they have any) at which the search for a proof begins, and where it ended. Of bodies
/// that have moved little since, one look there often proves the same again; the answer does not depend on it.
struct Proof {
  Certificate certificate = Certificate::kNone;
  double bound = 0;
};
/// Of triangles that are likely to be free, the search for one well inside the other body is left out: a matter of time alone.
enum class Expected { kAny, kFree };
[[nodiscard]] Proof prove(const PlacedShapeRef& a, const PlacedShapeRef& b, double d, double margin, TrianglePair& witness,
                          Expected expected = Expected::kAny);

/// What the distance of two surfaces of triangles may differ by between triangle_distance() and FCL, m: of meshes and boxes, both
/// in closed form but for boxes, where FCL's GJK gives 0.05 um.
inline constexpr double kTriangleBand = 1e-6;
/// Of the triangles of two bodies that have some, m, where it lies in [enough, limit]; else as TriangleTree::distance.
[[nodiscard]] double surface_distance(const PlacedShapeRef& a, const PlacedShapeRef& b, double enough, double limit,
                                      TrianglePair& witness);
/// What the distance of such surfaces is at most, m: that of the two triangles. Infinite where a body has none.
[[nodiscard]] double distance_at(const PlacedShapeRef& a, const PlacedShapeRef& b, const TrianglePair& witness);
/// Whether both bodies are nothing but triangles: meshes and boxes.
[[nodiscard]] bool are_triangles(const PlacedShapeRef& a, const PlacedShapeRef& b);
/// Of such bodies: surface_distance, but 0 where one holds the other.
[[nodiscard]] double triangle_distance(const PlacedShapeRef& a, const PlacedShapeRef& b, double enough, double limit,
                                       TrianglePair& witness);
/// Whether the clearance is proved to be more than d > 0, m, by at least what FCL may differ by.
[[nodiscard]] bool proves_beyond(const PlacedShapeRef& a, const PlacedShapeRef& b, double d, TrianglePair& witness);

/// Proves by a point of one body near or inside the other that their clearance is below d - kVerdictBand; where d is below zero,
/// that the point is by as much inside. A point is a corner or the middle of a triangle, the end of a capsule, the centre of a
/// sphere; the other body a box, a cylinder, a capsule or a sphere. Where it finds none there may be one.
[[nodiscard]] bool proves_below(const PlacedShapeRef& a, const PlacedShapeRef& b, double d, TrianglePair& witness);

}  // namespace swivel::detail
