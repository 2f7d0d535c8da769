// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/planner/verify/check.hpp"

namespace swivel {

class PreparedRobot;
class World;

/// check_motion() in front of objects that a world of the robot has met, so that no mesh is prepared again.
[[nodiscard]] CheckResult check_motion_in(const World& world, const PreparedRobot& robot, const Problem& problem,
                                          const std::vector<TimedRow>& rows, const CheckOptions& options);

/// Proves a planner's own answer, a trajectory or a motion, as check_trajectory() and check_motion() do, without margins. Of the
/// planner it takes the shapes and trees of its world alone: path, layers, kinematics and clearances are worked out anew. Throws
/// std::logic_error where it fails, and Stopped.
void check_answer(const World& world, const PreparedRobot& robot, const Problem& problem, const std::vector<TrajectoryRow>& rows,
                  const Budget& budget);
void check_answer(const World& world, const PreparedRobot& robot, const Problem& problem, const std::vector<TimedRow>& rows,
                  const Budget& budget);

}  // namespace swivel
