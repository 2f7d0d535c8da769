// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "shapes/triangle_tree.hpp"
#include "swivel/core/problem/shape.hpp"

namespace swivel::detail {

/// Returns the triangles of the mesh that collision uses, as vertex indices: all but those less
/// than a nanometre high, because their neighbours' edges cover them and FCL returns an unset
/// distance for a triangle without area.
[[nodiscard]] std::vector<std::array<int, 3>> triangles_with_area(const TriangleMesh& mesh);
/// Returns a tree of the given triangles (vertex indices) of the mesh; null if there are none.
[[nodiscard]] std::unique_ptr<const TriangleTree> tree_of(
    const TriangleMesh& mesh, const std::vector<std::array<int, 3>>& some);

/// Returns the surface of the box as twelve triangles, in the box's frame.
[[nodiscard]] TriangleMesh surface_of(const Box& box);
/// Returns the surface of a prism of 32 sides inside the cylinder, in the cylinder's frame. No
/// point of the cylinder is further than beyond_prism() from the prism.
[[nodiscard]] TriangleMesh surface_of(const Cylinder& cylinder);
/// Returns the largest distance of a point of the cylinder from the prism that surface_of()
/// returns, m.
[[nodiscard]] double beyond_prism(const Cylinder& cylinder);

}  // namespace swivel::detail
