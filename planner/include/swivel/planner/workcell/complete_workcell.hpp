// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "swivel/core/answer/stated.hpp"
#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/planner/workcell/prepared/prepared_workcell.hpp"

namespace swivel {

/// Computes what a file does not state of the rows of two arms, as complete_rows() does of one
/// path, and returns the rows. Throws as complete_rows() does, with the name of the arm.
[[nodiscard]] std::array<std::vector<TrajectoryRow>, 2> complete_rows(
    const PreparedWorkcell& prepared, std::array<std::vector<TrajectoryRow>, 2> rows,
    const std::array<Stated, 2>& stated, const Budget& budget = {});

/// Computes what a file does not state of the motion of two arms, as complete_motion() does of one
/// path, and returns the rows. `prepared` is that of a workcell with_motion_defaults(). Throws as
/// complete_motion() does, with the name of the arm.
[[nodiscard]] std::array<std::vector<TimedRow>, 2> complete_motion(
    const PreparedWorkcell& prepared, std::array<std::vector<TimedRow>, 2> rows,
    const std::array<Stated, 2>& stated, const Budget& budget = {});

/// Returns rows at the layers of both arms' paths from those of a motion, whose times are left
/// aside, for time_workcell(). `prepared` is that of a workcell with_motion_defaults(). Throws as
/// rows_at_layers() does of one path, with the name of the arm.
[[nodiscard]] std::array<std::vector<TrajectoryRow>, 2> rows_at_layers(
    const PreparedWorkcell& prepared, const std::array<std::vector<TimedRow>, 2>& rows,
    const std::array<Stated, 2>& stated, const Budget& budget = {});

}  // namespace swivel
