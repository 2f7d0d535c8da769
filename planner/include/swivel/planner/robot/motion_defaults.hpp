// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// Returns the problem with the defaults that timed motions use for keys it leaves unset: the tool
/// rounds corners (PathSmoothing's defaults), and keep_clearance_between_layers() is applied.
[[nodiscard]] Problem with_motion_defaults(Problem problem);
/// Sets limits.edge_clearance to limits.clearance, so that pairs keep between layers what they keep
/// at layers, instead of half of it. Does nothing if edge_clearance or self_clearance is set.
void keep_clearance_between_layers(Limits& limits);

}  // namespace swivel
