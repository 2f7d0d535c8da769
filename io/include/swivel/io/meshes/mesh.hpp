// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/shape.hpp"

namespace swivel::io {

/// Meshes that were loaded before, by canonical file name and scale.
using MeshCache = std::map<std::string, MeshPtr>;
/// Loads a mesh from an STL, OBJ, DAE or PLY file of at most 2 million triangles within 1000 m.
/// Vertices are as stored (no up-axis rotation, as ROS reads them), node transforms and units are
/// applied, and all meshes of the file are merged. `scale` has a factor for each axis; a negative
/// one mirrors. If `cache` has this file with this scale, that mesh is returned. Throws InputError.
[[nodiscard]] MeshPtr load_mesh(const std::filesystem::path& file, const Vector3d& scale,
                                MeshCache& cache);

}  // namespace swivel::io
