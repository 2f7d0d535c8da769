// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "swivel/core/answer/motion.hpp"
#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// Returns how far along the path each of its waypoints is, m from the first.
[[nodiscard]] std::vector<double> waypoint_distances(const PathProblem& problem);

/// Returns the moments at which the process is switched on and off in a timed run: at the first of
/// its rows at or after the stroke's first waypoint, and at or after its last one, turns there
/// included.
[[nodiscard]] std::array<ProcessEvent, 2> events_of_run(const Problem& job, const StrokeRun& run,
                                                        const PathProblem& problem,
                                                        std::span<const TimedRow> rows);

/// Returns the speeds that are asked for along a run of a stroke: the stroke's between its first
/// and its last waypoint, and those of approach and retract before and after; none where nothing
/// says one. `speed`, m/s, is that along the stroke, if given, instead of those of the job.
/// `problem` is problem_of_run(job, run).
struct RunSpeeds {
  double first = 0;               ///< m/s, before the first of `from`
  std::vector<SpeedFrom> from{};  ///< as TimingOptions::speeds
};
[[nodiscard]] std::optional<RunSpeeds> speeds_of_run(const Problem& job, const StrokeRun& run,
                                                     const PathProblem& problem,
                                                     std::optional<double> speed);

}  // namespace swivel
