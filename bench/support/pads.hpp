// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/problem/path_problem.hpp"

namespace swivel::bench {

/// The shapes of the pads of pad_on_dome().
inline constexpr const char* kPads[] = {"sphere", "capsule", "box", "cylinder", "mesh"};

/// Returns `problem` with another path and scene: a pad of a shape of kPads, 80 mm wide, is led
/// across a dome of about so many triangles, which it touches in a patch 1 mm deep. `triangles` is
/// at least 100. The pad may touch the dome, to `depth`, m, if that is not 0.
[[nodiscard]] PathProblem pad_on_dome(PathProblem problem, const std::string& pad, int triangles,
                                      double depth);

}  // namespace swivel::bench
