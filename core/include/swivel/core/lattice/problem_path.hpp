// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// Returns the tool path of a problem in layers: the whole path, or the part from the problem's
/// start on. Corners are rounded by `problem.smooth`, or by `otherwise` if that is unset. Throws
/// InputError for what ToolPath refuses and for a start_at beyond the path; InvalidArgument if
/// Task::rolls is given and does not have one entry for each layer; Stopped.
[[nodiscard]] ToolPath problem_path(const PathProblem& problem, const Chain& chain,
                                    const Budget& budget = {},
                                    const std::optional<PathSmoothing>& otherwise = {});

/// Returns a row at a travel (m) of a path whose roll is counted from the path's frames (of an arm
/// of six joints its last joint and phi) with the roll counted from the waypoints' own orientation
/// (ToolPath::waypoint_turn()), as rows of trajectories have it.
[[nodiscard]] TrajectoryRow counted_from_waypoints(const Chain& chain, const ToolPath& path,
                                                   double travel, TrajectoryRow row);
/// Replaces rows, one for each layer from layer 0 on, by counted_from_waypoints().
void count_from_waypoints(const Chain& chain, const ToolPath& path,
                          std::vector<TrajectoryRow>& rows);
/// Returns a row at a travel (m) as counted_from_waypoints() takes it: the opposite of that.
[[nodiscard]] TrajectoryRow counted_from_path(const Chain& chain, const ToolPath& path,
                                              double travel, TrajectoryRow row);
/// Replaces rows, one for each layer from layer 0 on, by counted_from_path().
void count_from_path(const Chain& chain, const ToolPath& path, std::vector<TrajectoryRow>& rows);

}  // namespace swivel
