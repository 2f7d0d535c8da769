// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>

#include "shapes/placed_shape.hpp"
#include "swivel/collision/proofs/verdict.hpp"

namespace swivel::detail {

/// The depth (swivel::Depth) of two bodies in each other, by branch and bound over the places that are deepest in one of them:
/// the centre of a sphere, the axis of a capsule, the medial surface of a box or cylinder. FCL is not asked.
/// The search ends once at_most - at_least <= 0.02 mm, once the depth is proved to be at most `from`, or once it is proved to be
/// more than `enough`; where it is cut short before that, at_most is still a bound. Of two meshes at_most is infinite; where a mesh
/// is not closed, nothing is known. A function of its arguments alone. Const-safe from many threads.
[[nodiscard]] Depth depth(const PlacedShapeRef& a, const PlacedShapeRef& b, double from = -std::numeric_limits<double>::infinity(),
                          double enough = std::numeric_limits<double>::infinity());

}  // namespace swivel::detail
