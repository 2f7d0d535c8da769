// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "swivel/core/answer/refined.hpp"
#include "swivel/core/motion/timed_path.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"

namespace swivel {

/// A trajectory made into a motion that a controller can run, or why that cannot be.
struct MotionResult : TimingResult {
  double time_ms = 0, check_ms = 0;  ///< of timing, and of looking for collisions
};

/// Times a trajectory of the problem (rows at its layers), and proves what a controller does with it: joints move straight from
/// sample to sample. At samples limits, manipulability and clearance hold (0.05 mm); between them, with `edges: continuous`, every
/// pair keeps its clearance of motions (0.05 mm). The problem counts with_motion_defaults(). Throws InvalidArgument and InputError
/// as plan() does, and for rows that are at no layer; Stopped.
[[nodiscard]] MotionResult time_trajectory(const PreparedRobot& robot, const Problem& problem,
                                           const std::vector<TrajectoryRow>& rows, const TimingOptions& options,
                                           const Budget& budget = {});

/// A path, and what is made of it.
struct MotionPlan {
  /// Of a solved problem: trajectory, cost and measures are those of the path that is executed; lattice.cost stays the lattice's.
  PlanResult result;
  std::vector<TrajectoryRow> lattice_path;  ///< what was refined
  std::optional<Refined> refinement;        ///< where it was asked for and there is a path
  std::optional<MotionResult> motion;       ///< the same; a `failure` where the time was up
  bool stopped = false;                     ///< with a path, before all that was asked for was done
};
/// Plans the planner's problem, refines the path if asked to, and times it if asked to. With timing, a path that jumps from branch
/// to branch at a singularity is planned again without such steps, where that can be; and where bodies come too near between
/// layers, the path is refined again with more clearance at them. The time-out is for everything; what is known when it passes
/// stays. The caller's own check is asked of the refined path as well, but not of samples; with a cost of the caller's own paths
/// are not refined. The problem should be one with_motion_defaults(). Throws as Planner::plan().
[[nodiscard]] MotionPlan plan_motion(Planner& planner, const PlanOptions& options, bool refined,
                                     const std::optional<TimingOptions>& timing);

/// The rows of a trajectory solved again at their arm angles where the tool's path is another one than they were planned on,
/// because problem.smooth has changed. Throws InputError where an arm angle has no solution there.
[[nodiscard]] std::vector<TrajectoryRow> rows_on_path(const PreparedRobot& robot, const Problem& problem,
                                                      const std::vector<TrajectoryRow>& rows);

}  // namespace swivel
