// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// Returns the tool path of a problem in layers: its whole path, or from its start on. Corners are
/// rounded by `problem.smooth`, by `otherwise` where that is unset. Throws InputError as ToolPath
/// does, and for a start_at beyond the path; InvalidArgument where there are Task::rolls, but not
/// one for each layer; Stopped.
[[nodiscard]] ToolPath problem_path(const Problem& problem, const Chain& chain,
                                    const Budget& budget = {},
                                    const std::optional<PathSmoothing>& otherwise = {});

}  // namespace swivel
