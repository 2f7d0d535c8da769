// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// Throws InputError if Problem::start, which must be set, is outside the limits of its joints, or
/// if its tool pose is further than Problem::start_tolerance (m and rad) from the path's first
/// layer.
void validate_start(const Problem& problem, const Chain& chain, const ToolPath& path);

/// Returns the roll of the start's tool at the path's first layer, rad, taken into `range` if that
/// is less than a turn. Throws InputError if the range or the waypoints' windows do not allow it.
[[nodiscard]] double roll_of_start(const Problem& problem, const Chain& chain, const ToolPath& path,
                                   const Roll& range);

}  // namespace swivel
