// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/motion.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/job/check_job.hpp"
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
/// job, for a rate or a speed that is none, and for TimingOptions::speeds and chord; Stopped.
[[nodiscard]] MotionTiming time_job(const PreparedRobot& robot, const Problem& job,
                                    const std::vector<Part>& parts, const TimingOptions& options,
                                    const Budget& budget = {});

/// Plans a job completed by with_motion_defaults(), and times it. A job whose cheapest runs jump
/// from branch to branch at a singularity is planned again without such steps, if that is possible.
/// The time-out of `options` covers everything. Throws as plan_job() and time_job() do, InputError
/// of a stroke without a speed before planning. `view`, if given, gets what was found out about the
/// runs. Answer::motion has the motion in time, where there is a job, unless Answer::stopped.
[[nodiscard]] Answer plan_job_motion(const PreparedRobot& robot, const Problem& job,
                                     const PlanOptions& options, const TimingOptions& timing,
                                     ProblemView* view = nullptr);

}  // namespace swivel
