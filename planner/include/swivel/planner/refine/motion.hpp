// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/refined.hpp"
#include "swivel/core/answer/timed_path.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"

namespace swivel {

/// A timed motion that a controller can run, or the reason why there is none.
struct MotionResult : TimingResult {
  double time_ms = 0, check_ms = 0;  ///< spent on timing and on collision checking
};

/// Times a trajectory of the problem (`rows` at its layers), and proves what a controller does with
/// it: joints move straight from sample to sample. Samples keep limits, manipulability and
/// clearance (within 0.05 mm); with `edges: continuous`, every pair keeps its clearance of motions
/// between samples (within 0.05 mm). The problem is completed by with_motion_defaults(). Throws
/// InvalidArgument and InputError as plan() does, InvalidArgument for rows that are not at layers,
/// and Stopped.
[[nodiscard]] MotionResult time_trajectory(const PreparedRobot& robot, const PathProblem& problem,
                                           const std::vector<TrajectoryRow>& rows,
                                           const TimingOptions& options, const Budget& budget = {});

/// The result of plan_motion(): a path, and if asked for, its refinement and its timed motion.
struct MotionPlan {
  /// The plan. If it is solved, trajectory, cost and measures describe the path that is executed;
  /// lattice.cost stays that of the lattice's path.
  PlanResult result;
  std::vector<TrajectoryRow> lattice_path;  ///< the path that was refined or timed
  std::optional<Refined> refinement;        ///< set if asked for and there is a path
  /// set if asked for and there is a path; has a `failure` if the time was up
  std::optional<MotionResult> motion;
  bool stopped = false;  ///< there is a path, but time ran out before the rest was done
};
/// Returns the answer to a problem of one path from the plan of its path and motion. `timing` is
/// how the motion was asked for.
[[nodiscard]] Answer answer_of(MotionPlan plan, const std::optional<TimingOptions>& timing);

/// Plans the planner's problem, then refines the path if `refined` is true, and times it if
/// `timing` is set. With timing, a path that jumps from branch to branch at a singularity is
/// planned again without such steps, if that is possible; and if bodies come too near between
/// layers, the path is refined again with more clearance at the layers. The time-out of `options`
/// covers everything; what is known when it passes stays. The caller's own check also applies to
/// the refined path, but not to samples; with a cost of the caller's own, paths are not refined.
/// The problem should be one with_motion_defaults(). Throws as Planner::plan() does.
[[nodiscard]] MotionPlan plan_motion(Planner& planner, const PlanOptions& options, bool refined,
                                     const std::optional<TimingOptions>& timing);

/// Returns the rows of a trajectory solved again at their arm angles, for a problem whose tool path
/// differs from the one that was planned because problem.smooth has changed. Throws InputError if
/// an arm angle has no solution there, and InvalidArgument if the robot was not prepared for the
/// problem.
[[nodiscard]] std::vector<TrajectoryRow> rows_on_path(const PreparedRobot& robot,
                                                      const PathProblem& problem,
                                                      const std::vector<TrajectoryRow>& rows);

}  // namespace swivel
