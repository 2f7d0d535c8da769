// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/stated.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/motion/timed_path.hpp"

namespace swivel {

class PreparedRobot;
struct Problem;

/// Works out what a trajectory's file does not state of its rows from their joints and the problem, so that check_trajectory() can
/// be asked about them: s, arm angle, branch, the roll of the tool.
///
/// s is where the path has the tool's pose (1e-6 m and rad). Where it has the pose at several places, rows are matched to places
/// such that as many as possible come in the order of the path, each as early as it can be. A row whose tool is nowhere on the path
/// gets the place that comes nearest between those of the rows beside it, and fails the check by that distance. Where more rows are
/// on the rounded path of with_motion_defaults(problem) than on the problem's own, places are those of the rounded path. A tool
/// that may turn about its own axis stands turned as its joints have it, by the turn that is nearest to that of the row before.
/// What is stated stays.
///
/// Throws InvalidArgument and InputError as check_trajectory() does, and InputError where the last joint is not stated and is no
/// roll; Stopped.
[[nodiscard]] std::vector<TrajectoryRow> complete_rows(const PreparedRobot& robot, const Problem& problem,
                                                       std::vector<TrajectoryRow> rows, const Stated& stated,
                                                       const Budget& budget = {});

/// Works out what the file of a motion does not state, for check_motion(): the tool follows the rounded path of
/// with_motion_defaults(problem); speeds and accelerations are those that the joints have over the times, at rest before the first
/// row and after the last. Times must ascend. Throws as complete_rows() does.
[[nodiscard]] std::vector<TimedRow> complete_motion(const PreparedRobot& robot, const Problem& problem, std::vector<TimedRow> rows,
                                                    const Stated& stated, const Budget& budget = {});

/// Makes rows at any places of the path into rows at its layers, as refine() and time_trajectory() take them: a row at a layer
/// stays as it is; at a layer between two rows, joints on the straight line between them are moved onto the path's pose by Newton
/// steps of least norm. Rows that all stand at layers are returned unchanged. Throws as complete_rows() does, and InputError for a
/// row whose tool is further than 1e-6 m or rad from the path, that goes back, or with which the path does not begin and end.
[[nodiscard]] std::vector<TrajectoryRow> rows_at_layers(const PreparedRobot& robot, const Problem& problem,
                                                        const std::vector<TrajectoryRow>& rows, const Stated& stated,
                                                        const Budget& budget = {});

}  // namespace swivel
