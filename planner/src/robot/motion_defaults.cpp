// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/robot/motion_defaults.hpp"

#include "swivel/core/messages/input_error.hpp"

namespace swivel {

void keep_clearance_between_layers(Limits& limits) {
  if (!limits.edge_clearance && !limits.self_clearance) limits.edge_clearance = limits.clearance;
}

PathProblem with_motion_defaults(PathProblem problem) {
  if (!problem.smooth) problem.smooth.emplace();
  keep_clearance_between_layers(problem.limits);
  return problem;
}

Problem with_motion_defaults(Problem problem) {
  if (const auto given = problem.given_arm())
    throw InputError(problem.source,
                     "arm '" + problem.arms[*given].name +
                         "': its motion is given, of which no motion in time is made yet: allowed "
                         "are two arms that are planned");
  for (std::size_t k = 0; k < problem.arms.size(); ++k) {
    for (Stroke& stroke : problem.arms[k].strokes) {
      if (!stroke.smooth && problem.leader_of(k) < 0) stroke.smooth.emplace();
      keep_clearance_between_layers(stroke.limits);
    }
    keep_clearance_between_layers(problem.arms[k].transition_limits);
  }
  return problem;
}

}  // namespace swivel
