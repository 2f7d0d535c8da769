// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "swivel/core/time_path.hpp"
#include "swivel/planner/planner.hpp"

namespace swivel {

/// A trajectory made into a motion that a controller can run, or why that cannot be.
struct MotionResult {
  std::optional<TimedPath> motion;
  std::optional<NoMotion> failure;   ///< unless there is a motion
  double time_ms = 0, check_ms = 0;  ///< of timing, and of looking for collisions
};

/// Times a trajectory of the problem (rows at its layers), and proves what a controller does with it: joints move straight from
/// sample to sample. At samples limits, manipulability and clearance hold (0.05 mm); between them, with `edges: continuous`, every
/// pair keeps its clearance of motions. The tool follows the smoothed path of problem.smooth, PathSmoothing's defaults where that
/// is unset. Throws InvalidArgument and InputError as plan() does, and for rows that are at no layer; Stopped.
[[nodiscard]] MotionResult time_trajectory(const PreparedRobot& robot, const Problem& problem,
                                           const std::vector<TrajectoryRow>& rows, const TimingOptions& options,
                                           const Budget& budget = {});

/// The rows of a trajectory solved again at their arm angles where the tool's path is another one than they were planned on,
/// because problem.smooth has changed. Throws InputError where an arm angle has no solution there.
[[nodiscard]] std::vector<TrajectoryRow> rows_on_path(const PreparedRobot& robot, const Problem& problem,
                                                      const std::vector<TrajectoryRow>& rows);

}  // namespace swivel
