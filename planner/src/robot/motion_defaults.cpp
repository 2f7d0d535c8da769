// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/robot/motion_defaults.hpp"

namespace swivel {

void keep_clearance_between_layers(Limits& limits) {
  if (!limits.edge_clearance && !limits.self_clearance) limits.edge_clearance = limits.clearance;
}

Problem with_motion_defaults(Problem problem) {
  if (!problem.smooth) problem.smooth.emplace();
  keep_clearance_between_layers(problem.limits);
  return problem;
}

}  // namespace swivel
