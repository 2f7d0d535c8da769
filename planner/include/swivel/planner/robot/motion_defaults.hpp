// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// Returns the problem with the defaults that timed motions use for keys it leaves unset: the tool
/// rounds corners (PathSmoothing's defaults), and keep_clearance_between_layers() is applied.
[[nodiscard]] PathProblem with_motion_defaults(PathProblem problem);
/// Returns the problem with these defaults for each of its strokes and for transitions. Throws
/// InputError where the motion of an arm is given, since no motion in time is made beside it.
[[nodiscard]] Problem with_motion_defaults(Problem problem);
/// Sets limits.edge_clearance to limits.clearance, so that pairs keep between layers what they keep
/// at layers, instead of half of it. Does nothing if edge_clearance or self_clearance is set.
void keep_clearance_between_layers(Limits& limits);

}  // namespace swivel
