// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/problem/path_problem.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

/// What find_first_path() found.
struct FirstPath {
  /// Both ends of a straight path of the tool in the base frame, the tool not turning, with
  /// numbers of few digits; empty where no path was found.
  std::vector<Waypoint> waypoints;
  int tried = 0;    ///< paths that were planned
  PlanResult plan;  ///< of `waypoints`, or of the last path tried
};

/// Looks for a straight path that a robot can follow without a scene, within the default limits, to
/// begin a problem file with. The first of these that plan() solves is returned: paths at which the
/// tool's z axis points down, in front of the arm, then beside and behind it, a quarter of the
/// arm's reach long; then paths through postures in the midst of the joints' ranges. The paths and
/// their order depend on the robot alone. `options.timeout_s` covers all paths together. Throws as
/// Planner::plan() does.
[[nodiscard]] FirstPath find_first_path(const Robot& robot, const PlanOptions& options = {});

}  // namespace swivel
