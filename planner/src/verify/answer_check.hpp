// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/planner/verify/check.hpp"

namespace swivel {

class PreparedRobot;
class World;

/// Checks a timed motion as check_motion() does, with the shapes and mesh trees of a world of the
/// same robot, so that no mesh is prepared again.
[[nodiscard]] CheckResult check_motion_in(const World& world, const PreparedRobot& robot,
                                          const PathProblem& problem,
                                          const std::vector<TimedRow>& rows,
                                          const CheckOptions& options);

/// Proves a planner's own trajectory as check_trajectory() does, without margins. From the planner
/// it uses only the shapes and trees of its world; path, layers, kinematics and clearances are
/// computed anew. Throws std::logic_error if the trajectory fails, and Stopped.
void check_answer(const World& world, const PreparedRobot& robot, const PathProblem& problem,
                  const std::vector<TrajectoryRow>& rows, const Budget& budget);
/// Proves a planner's own timed motion as check_motion() does, without margins. From the planner it
/// uses only the shapes and trees of its world; path, layers, kinematics and clearances are
/// computed anew. Throws std::logic_error if the motion fails, and Stopped.
void check_answer(const World& world, const PreparedRobot& robot, const PathProblem& problem,
                  const std::vector<TimedRow>& rows, const Budget& budget);

}  // namespace swivel
