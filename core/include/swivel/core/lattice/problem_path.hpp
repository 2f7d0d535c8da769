// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// Returns the tool path of a problem in layers: the whole path, or the part from the problem's
/// start on. Corners are rounded by `problem.smooth`, or by `otherwise` if that is unset. Throws
/// InputError for what ToolPath refuses and for a start_at beyond the path; InvalidArgument if
/// Task::rolls is given and does not have one entry for each layer; Stopped.
[[nodiscard]] ToolPath problem_path(const Problem& problem, const Chain& chain,
                                    const Budget& budget = {},
                                    const std::optional<PathSmoothing>& otherwise = {});

}  // namespace swivel
