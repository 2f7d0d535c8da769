// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// The problems that the arms of a workcell pose by themselves (PreparedWorkcell::problem).
struct ArmProblems {
  std::array<PathProblem, 2> problems;
  /// Where one arm leads the other one: the waypoints of the follower in the leader's tool frame.
  std::vector<Waypoint> on_leader;
};
/// Returns the problems of both arms. Throws InputError where the arms share a joint or a link, and
/// as ToolPath does; Stopped.
[[nodiscard]] ArmProblems problems_of_arms(const Problem& cell, const Budget& budget);
/// Returns the pose of the tool in the base frame as the joints q, rad, have turned it: of an arm
/// of six joints with the roll that Chain::tool() leaves out.
[[nodiscard]] Pose turned_tool(const Chain& chain, const Config& q);
/// Returns a pose between two waypoints: the position is linear, the orientation turns on the short
/// arc. `t`: 0 to 1.
[[nodiscard]] Pose pose_between(const Waypoint& from, const Waypoint& to, double t);

}  // namespace swivel
