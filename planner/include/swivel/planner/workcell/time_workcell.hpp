// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "swivel/core/answer/motion.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "swivel/planner/workcell/refine_workcell.hpp"

namespace swivel {

/// Times trajectories of both arms, rows at the layers of their paths, by one clock, and proves
/// what a controller does with them: the joints of both arms move straight from sample to sample at
/// one time. Tools are on their paths at samples; both are at their first waypoints together, at
/// their second ones together, and so on. No tool is faster than `options.speed`; that of a
/// follower is its speed relative to the leader's tool. Nor is a tool faster in the base frame than
/// limits.tool_speed of its arm. So one of the tools is at its speed wherever joints allow it.
/// Every joint keeps its speed, acceleration and jerk. Samples keep limits, manipulability and
/// clearance, and motions between them the clearances of motions (within 0.05 mm), each arm by
/// itself and both between each other.
///
/// At a waypoint at which the ratio of the tools' speeds changes, it does so over up to 20 mm on
/// both sides; of a follower's path, over as little as keeps both tools within 0.05 mm of where
/// they belong at that moment. Where there is no room for that, or where the arms would come too
/// near to each other on the way, both stop there.
///
/// `prepared` is that of a workcell with_motion_defaults(). Throws InvalidArgument for another one,
/// for options that are not positive, and for `options.speeds`, InputError for rows that are not at
/// layers and for a joint without a speed limit, and Stopped.
[[nodiscard]] MotionTiming time_workcell(const PreparedWorkcell& prepared,
                                         const std::array<std::vector<TrajectoryRow>, 2>& rows,
                                         const TimingOptions& options, const Budget& budget = {});

/// Refined trajectories of both arms, and their motion in time.
struct RefinedWorkcellMotion {
  RefinedRuns refinement;
  MotionTiming timing;
  double refine_ms = 0;  ///< spent on refining
};
/// Refines trajectories of both arms as refine_workcell() does, and times them as time_workcell()
/// does. Where bodies come too near between samples, they are refined again with more clearance at
/// rows. `rows` may also be those of the workcell before with_motion_defaults(): they are solved
/// again at their arm angles on the rounded corners first. Throws as both do, and InputError where
/// an arm has no solution there.
[[nodiscard]] RefinedWorkcellMotion refine_and_time_workcell(
    const PreparedWorkcell& prepared, const std::array<std::vector<TrajectoryRow>, 2>& rows,
    const TimingOptions& options, const Budget& budget = {});

/// Plans a workcell, then refines the plan if `refined` is true, and times it if `timing` is set:
/// all within the time-out of `options`, and proved if options.check. Where bodies come too near
/// between rows of a refined plan that is timed, it is refined again with more clearance at rows.
/// `prepared` is that of a workcell with_motion_defaults() where it is timed; where it is refined
/// alone, keep_clearance_between_layers() should have been applied to the limits of its arms.
/// `view`: as of plan_workcell(). Throws as plan_workcell(), refine_workcell() and time_workcell()
/// do, std::logic_error if options.check finds an answer invalid.
[[nodiscard]] Answer plan_workcell_motion(const PreparedWorkcell& prepared,
                                          const PlanOptions& options, bool refined,
                                          const std::optional<TimingOptions>& timing,
                                          ProblemView* view = nullptr);

}  // namespace swivel
