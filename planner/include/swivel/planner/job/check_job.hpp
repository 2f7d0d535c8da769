// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {

struct ArmMotion;

/// Proves a job from its problem alone, or tells what is wrong with it:
/// - every stroke is run once, in the order of the job unless that may be chosen, and from the last
///   waypoint to the first only if it is reversible;
/// - each run keeps what check_trajectory() demands of its own problem (problem_of_run());
/// - between two runs there is one transition, before the first and after the last run one from and
///   to home, if there is a home; each begins where the part before ends, and ends where the next
///   one begins (1e-9 rad; the roll of a six-joint arm aside);
/// - on transitions, where joints move straight from row to row, joints are within their limits
///   less joint_margin (1e-9 rad) and nothing comes nearer than the clearance of motions, by FCL.
/// Throws InvalidArgument for what validate(Problem) refuses and unless the robot was prepared for
/// the job, InputError as plan_job() does, and Stopped.
[[nodiscard]] AnswerCheck check_job(const PreparedRobot& robot, const Problem& job,
                                    const std::vector<Part>& parts,
                                    const CheckOptions& options = {});

/// Proves a timed job from its problem alone, or tells what is wrong with it: as check_job() says
/// of parts, with runs judged as check_motion() judges them; the rates of transitions as
/// check_motion() judges rates, with Problem::rapid of the joints' speeds; that from sample to
/// sample the tool is no faster (0.1 %) than the fastest of the speeds that are asked for there, as
/// time_job() takes them from the job; and that events are at the first samples at or after the
/// begin and the end of each stroke. Throws as check_job() does.
[[nodiscard]] AnswerCheck check_job_motion(const PreparedRobot& robot, const Problem& job,
                                           const std::vector<StrokeRun>& order,
                                           const ArmMotion& motion,
                                           const CheckOptions& options = {});

/// Adds a failure to `result` for each run among the parts of a job of which `process`, by part and
/// row, is not what process_of_rows() returns: by its first such row. `process` may be empty for a
/// part that says nothing of it, and is not looked at for transitions and for strokes that the job
/// does not have. Throws InvalidArgument unless it has an item for each part and, where not empty,
/// one for each row of a run.
void check_process(const Problem& job, const std::vector<Part>& parts,
                   const std::vector<std::vector<bool>>& process, AnswerCheck& result);

/// Returns true if the tool begins at rows.front() nearer to the stroke's last waypoint than to its
/// first, by position and then by angle; where both are one pose, if the stroke is reversible and
/// the rows follow the waypoints from the last to the first more nearly.
[[nodiscard]] bool begins_at_last_waypoint(const PreparedRobot& robot, const Problem& job,
                                           std::size_t stroke,
                                           const std::vector<TrajectoryRow>& rows);

/// Returns the runs of which the samples of a job's motion are. `strokes` has the stroke of each
/// run in their order, as indices in Problem::strokes; one is run backwards if the tool begins at
/// its last waypoint (begins_at_last_waypoint()).
[[nodiscard]] std::vector<StrokeRun> runs_of_motion(const PreparedRobot& robot, const Problem& job,
                                                    const std::vector<std::size_t>& strokes,
                                                    const ArmMotion& motion);

}  // namespace swivel
