// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "shapes/triangle_tree.hpp"
#include "swivel/core/problem/shape.hpp"

namespace swivel::detail {

/// Triangles as collision has them: those less than a nanometre high are left out, since their neighbours' edges cover them and FCL
/// returns an unset distance for a triangle without area.
[[nodiscard]] std::vector<std::array<int, 3>> triangles_with_area(const TriangleMesh& mesh);
/// Of these triangles of the mesh; null where there are none.
[[nodiscard]] std::unique_ptr<const TriangleTree> tree_of(const TriangleMesh& mesh, const std::vector<std::array<int, 3>>& some);

[[nodiscard]] TriangleMesh surface_of(const Box& box);
/// A prism inside the cylinder. No point of the cylinder is further than `beyond_prism` from it, m.
[[nodiscard]] TriangleMesh surface_of(const Cylinder& cylinder);
[[nodiscard]] double beyond_prism(const Cylinder& cylinder);

}  // namespace swivel::detail
