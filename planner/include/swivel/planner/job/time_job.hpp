// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/motion.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/refine_job.hpp"
#include "swivel/planner/plan/plan_options.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"

namespace swivel {

class PreparedRobot;
struct ProblemView;

/// Throws InputError if a stroke has no speed at which time_job() could time it, and
/// InvalidArgument for options that time_job() does not have.
void require_speeds(const Problem& job, const TimingOptions& options);

/// Times a planned job from rest to rest and proves its samples. Runs are timed by
/// time_trajectory(): along a stroke at TimingOptions::speed, or where that is 0 at the feed of the
/// waypoint, else the stroke's process_speed, else the job's, else limits.tool_speed; along
/// approach and retract at approach_speed. limits.tool_speed is kept everywhere. Transitions are
/// timed by time_joint_moves(). The tool rests between parts and at the corners of transitions. The
/// job is completed by with_motion_defaults(). Throws InputError where a stroke has no speed or a
/// joint no speed limit, InvalidArgument as plan_job() does, for parts that are not those of the
/// job, for a rate or a speed that is none, and for TimingOptions::speeds; Stopped.
[[nodiscard]] MotionTiming time_job(const PreparedRobot& robot, const Problem& job,
                                    const std::vector<Part>& parts, const TimingOptions& options,
                                    const Budget& budget = {});

/// Parts of a job whose runs were refined, and their motion in time.
struct RefinedJobMotion {
  std::vector<Part> parts;
  RefinedRuns refinement;
  MotionTiming timing;
  double refine_ms = 0;  ///< spent on refining
};
/// Refines the runs among parts as refine_job() does, and times the parts as time_job() does. Where
/// bodies come too near between samples of a run, that run is refined again with more clearance at
/// rows. Throws as both do.
[[nodiscard]] RefinedJobMotion refine_and_time_job(const PreparedRobot& robot, const Problem& job,
                                                   std::vector<Part> parts,
                                                   const TimingOptions& options,
                                                   const RefineOptions& refining = {},
                                                   const Budget& budget = {});

/// Plans a job, then refines its runs if `refined` is true, and times it if `timing` is set: all
/// within the time-out of `options`, and proved if options.check. A job to be timed is completed by
/// with_motion_defaults(), and where its cheapest runs jump from branch to branch at a singularity,
/// planned again without such steps, if that is possible; for one to be refined alone,
/// keep_clearance_between_layers() should have been applied to the limits of its strokes. Answer
/// has refinement and motion where there is a job, unless Answer::stopped. Throws as plan_job() and
/// time_job() do, InputError of a stroke without a speed before planning. `view`, if given, gets
/// what was found out about the runs.
[[nodiscard]] Answer plan_job_motion(const PreparedRobot& robot, const Problem& job,
                                     const PlanOptions& options, bool refined,
                                     const std::optional<TimingOptions>& timing,
                                     ProblemView* view = nullptr);

}  // namespace swivel
