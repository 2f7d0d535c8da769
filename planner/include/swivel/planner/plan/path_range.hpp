// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

class PreparedRobot;

/// A stretch of a problem's path: arc lengths from the first waypoint, m, along which turns on the
/// spot count nothing.
struct PathRange {
  double from = 0;
  double to = std::numeric_limits<double>::infinity();  ///< beyond the path's end: the end
};

/// Returns the problem of a stretch of a path alone, which the arm may begin and end in any
/// posture: Task::start, end and closed are unset. Where no waypoint is at an end of the stretch,
/// one is put there, on the straight line between its neighbours. Layers, and the reference of arm
/// angles, begin anew at `from`. Throws InvalidArgument for a range that does not lead forwards or
/// begins outside the path, and for a problem with `rolls` or `steps`, which are of the whole path.
[[nodiscard]] PathProblem problem_of_range(const PathProblem& problem, const PathRange& range);

/// Which way a path is followed.
enum class PathDirection { kForwards, kBackwards };

/// How far an arm follows a path from a place on it.
struct PathReach {
  double s = 0;  ///< arc length of the path that it reaches, m
  /// The plan of the way from the place to the path's end, or back to its begin. Solved where it
  /// reaches that; else with the cause that stops it, and the rows up to there. `s` of its rows is
  /// counted from the place, in the direction of travel.
  PlanResult plan;
};

/// Finds how far an arm, free to begin in any posture, follows a problem's path from the arc length
/// `from` on, m, or backwards from there: up to the last layer that a valid path reaches. Throws
/// InvalidArgument where nothing of the path lies ahead and as problem_of_range() and plan() do.
[[nodiscard]] PathReach reach_from(const PreparedRobot& robot, const PathProblem& problem,
                                   double from, PathDirection direction = PathDirection::kForwards,
                                   const PlanOptions& options = {});

}  // namespace swivel
