// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

class PreparedRobot;

/// Measures any trajectory as plan() measures its own: exact clearances, tool-path error,
/// manipulability, distance from the joint limits, tool speed. `rows` holds one row at each layer
/// of the problem's path, in order, valid or not (check_trajectory() judges). `wanted` selects what
/// is computed. Throws InvalidArgument for another number of rows or a robot that was not prepared
/// for the problem, InputError as plan() does, and Stopped.
[[nodiscard]] Measures measure(const PreparedRobot& robot, const PathProblem& problem,
                               const std::vector<TrajectoryRow>& rows,
                               const Evidence& wanted = Evidence::all(), const Budget& budget = {});

}  // namespace swivel
