// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/stated.hpp"
#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/base/budget.hpp"

namespace swivel {

class PreparedRobot;
struct PathProblem;

/// Computes what a trajectory's file does not state about its rows (s, arm angle, branch, roll of
/// the tool) from their joints and the problem, so that check_trajectory() can judge them, and
/// returns the rows. Stated values stay.
///
/// s is where the path has the tool's pose (1e-6 m and rad). If it has the pose at several places,
/// rows are matched to places so that as many as possible come in the order of the path, each as
/// early as it can. A row whose tool is nowhere on the path gets the nearest place between those of
/// its neighbouring rows, and fails the check by that distance. If more rows lie on the rounded
/// path of with_motion_defaults(problem) than on the problem's own path, places are those of the
/// rounded path. For a tool that may turn about its own axis, the roll is the one that the joints
/// give, with the turn that is nearest to that of the row before.
///
/// Throws InvalidArgument and InputError as check_trajectory() does, InputError if the last joint
/// is not stated and is not the roll, and Stopped.
[[nodiscard]] std::vector<TrajectoryRow> complete_rows(const PreparedRobot& robot,
                                                       const PathProblem& problem,
                                                       std::vector<TrajectoryRow> rows,
                                                       const Stated& stated,
                                                       const Budget& budget = {});

/// Computes what the file of a timed motion does not state about its rows, for check_motion(), and
/// returns the rows. The tool follows the rounded path of with_motion_defaults(problem); speeds and
/// accelerations follow from the joints and times, with rest before the first row and after the
/// last. Times must ascend. Throws InvalidArgument, InputError and Stopped as complete_rows() does.
[[nodiscard]] std::vector<TimedRow> complete_motion(const PreparedRobot& robot,
                                                    const PathProblem& problem,
                                                    std::vector<TimedRow> rows,
                                                    const Stated& stated,
                                                    const Budget& budget = {});

/// Returns rows at the layers of the path, which refine() and time_trajectory() need, from rows at
/// any places of it. A row at a layer stays as it is. At a layer between two rows, Newton steps of
/// least norm move the joints on the straight line between them onto the path's pose. Rows that all
/// stand at layers are returned unchanged. Throws InvalidArgument, InputError and Stopped as
/// complete_rows() does, and InputError for a row whose tool is further than 1e-6 m or rad from the
/// path or that goes back, for rows that do not reach from the path's beginning to its end, and for
/// rows without the joints that the problem gives as its start or end.
[[nodiscard]] std::vector<TrajectoryRow> rows_at_layers(const PreparedRobot& robot,
                                                        const PathProblem& problem,
                                                        const std::vector<TrajectoryRow>& rows,
                                                        const Stated& stated,
                                                        const Budget& budget = {});

}  // namespace swivel
