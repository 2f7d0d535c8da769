// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "swivel/core/problem/problem.hpp"

namespace swivel::bench {

/// The problem with a robot whose capsules are meshes: each is replaced by a closed mesh of some
/// 800 triangles with corners on its surface, as links of vendors' files are meshes.
[[nodiscard]] Problem with_mesh_bodies(Problem problem);

}  // namespace swivel::bench
