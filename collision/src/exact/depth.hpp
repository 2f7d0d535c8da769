// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>

#include "shapes/placed_shape.hpp"
#include "swivel/collision/proofs/verdict.hpp"

namespace swivel::detail {

/// Returns the penetration depth (swivel::Depth) of two bodies, by branch and bound over the medial
/// set of one of them: the centre of a sphere, the axis of a capsule, the medial surface of a box
/// or cylinder. FCL is not called.
/// The search ends once at_most - at_least <= 0.02 mm (for a cylinder plus 0.3 % of its radius),
/// once the depth is proved to be at most `from`, m, or once it is proved to be more than `enough`,
/// m. If it is cut short before that, at_most is still a bound. For two meshes at_most is infinite;
/// if a mesh is not closed, at_least is minus infinity as well. The result depends on the arguments
/// alone. Safe to call from many threads.
[[nodiscard]] Depth depth(const PlacedShapeRef& a, const PlacedShapeRef& b,
                          double from = -std::numeric_limits<double>::infinity(),
                          double enough = std::numeric_limits<double>::infinity());

}  // namespace swivel::detail
