// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/shape.hpp"

namespace swivel::io {

/// STL, OBJ, DAE, PLY, at most 2 million triangles within 1000 m: vertices as stored (no up-axis rotation, as ROS reads them), node
/// transforms and units applied, all meshes of the file merged; scale per axis, negative mirrors. The same file and scale loaded
/// twice shares one mesh within `cache`.
using MeshCache = std::map<std::string, MeshPtr>;
[[nodiscard]] MeshPtr load_mesh(const std::filesystem::path& file, const Vector3d& scale, MeshCache& cache);

}  // namespace swivel::io
