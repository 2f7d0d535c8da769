// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// Throws InputError where Problem::start leaves the limits of its joints, or is not at the path's
/// first layer within Problem::start_tolerance.
void validate_start(const Problem& problem, const Chain& chain, const ToolPath& path);

/// The roll of the start at the path's first layer, rad, within `range` where that is less than a
/// turn. Throws InputError where the range or the waypoints do not allow it.
[[nodiscard]] double roll_of_start(const Problem& problem, const Chain& chain, const ToolPath& path,
                                   const Roll& range);

}  // namespace swivel
