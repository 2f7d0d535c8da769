// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <vector>

#include "swivel/planner/plan/plan_view.hpp"

namespace swivel {

/// What a job's plan found out about its runs, for those who draw or measure it. Valid while the
/// robot of the plan lives; copies share what they refer to.
struct JobView {
  /// In the order of Answer::runs. The path of a run is that of the job. Where there is no job,
  /// a run that has no path by itself has the view of its own plan, and other runs have an empty
  /// path. Empty if the plan was stopped before there was a job or a verdict.
  std::vector<PlanView> runs;
  std::shared_ptr<const void> owner;  ///< of what the runs refer to, but the robot
};

}  // namespace swivel
