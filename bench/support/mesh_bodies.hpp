// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "swivel/core/problem/path_problem.hpp"

namespace swivel::bench {

/// Returns the problem with a robot whose capsules are meshes: each is replaced by a closed mesh of
/// some 800 triangles with corners on its surface, similar to link meshes in vendors' files.
[[nodiscard]] PathProblem with_mesh_bodies(PathProblem problem);

}  // namespace swivel::bench
