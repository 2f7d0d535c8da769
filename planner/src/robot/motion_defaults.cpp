// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/robot/motion_defaults.hpp"

namespace swivel {

void keep_clearance_between_layers(Limits& limits) {
  if (!limits.edge_clearance && !limits.self_clearance) limits.edge_clearance = limits.clearance;
}

PathProblem with_motion_defaults(PathProblem problem) {
  if (!problem.smooth) problem.smooth.emplace();
  keep_clearance_between_layers(problem.limits);
  return problem;
}

Job with_motion_defaults(Job job) {
  for (Stroke& stroke : job.strokes) {
    if (!stroke.smooth) stroke.smooth.emplace();
    keep_clearance_between_layers(stroke.limits);
  }
  keep_clearance_between_layers(job.limits);
  return job;
}

Workcell with_motion_defaults(Workcell cell) {
  if (const auto given = cell.given_arm())
    throw InputError(cell.source, "arm '" + cell.arms[*given].name +
                                      "': its motion is given, of which no motion in time is made "
                                      "yet: allowed are two arms that are planned");
  for (std::size_t k = 0; k < 2; ++k) {
    if (!cell.arms[k].smooth && cell.leader_of(k) < 0) cell.arms[k].smooth.emplace();
    keep_clearance_between_layers(cell.arms[k].limits);
  }
  return cell;
}

}  // namespace swivel
