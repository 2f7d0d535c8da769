// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "placed_shape.hpp"

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

/// The same, with a number that the clearance is not below where it is kFree, m: looks `ahead` beyond d for a larger one.
/// `witness`: triangles (of a and of b, where they have any) at which the search for a proof begins, and where it ended. Of bodies
/// that have moved little since, one look there often proves the same again; the answer does not depend on it.
struct Proof {
  Certificate certificate = Certificate::kNone;
  double floor = 0;
};
[[nodiscard]] Proof prove(const PlacedShapeRef& a, const PlacedShapeRef& b, double d, double ahead, TrianglePair& witness);

}  // namespace swivel::detail
