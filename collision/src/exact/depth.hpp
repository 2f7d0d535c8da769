// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>

#include "shapes/placed_shape.hpp"
#include "swivel/collision/proofs/verdict.hpp"

namespace swivel::detail {

/// Returns the penetration depth (swivel::Depth) of two bodies, by branch and bound over the medial
/// set of one of them and, where the other one is a mesh, over the surface of the mesh
/// (docs/model.md, "Contact"). FCL is not called.
/// The search ends once at_most - at_least <= 0.02 mm (for a cylinder plus 0.3 % of its radius),
/// once the depth is proved to be at most `from`, m, which may leave at_least at minus infinity, or
/// once it is proved to be more than `enough`, m, which may leave at_most at infinity. If it is cut
/// short before that, at_most is still a bound. Of two meshes at_least is the depth of the deepest
/// corner of one in the other, and at_most the depth of the box about the smaller one, along the
/// axes of its frame. If a mesh is not closed, nothing is known. The result depends on the
/// arguments alone. Safe to call from many threads.
[[nodiscard]] Depth depth(const PlacedShapeRef& a, const PlacedShapeRef& b,
                          double from = -std::numeric_limits<double>::infinity(),
                          double enough = std::numeric_limits<double>::infinity());

}  // namespace swivel::detail
