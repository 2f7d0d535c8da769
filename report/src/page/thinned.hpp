// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>

#include "swivel/core/problem/shape.hpp"

namespace swivel::detail {

/// Returns a mesh for drawing with at most `most` triangles: corners within one cell of a grid
/// become one, at their middle, with the finest of a series of grids that suffices. A mesh with no
/// more triangles stays as it is.
[[nodiscard]] MeshPtr thinned(const MeshPtr& mesh, std::size_t most);

}  // namespace swivel::detail
