// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

/// Where a run of a stroke belongs that is done in several runs, because no single one finishes it.
struct StrokePiece {
  std::string stroke;  ///< name of the stroke
  double begin = 0;    ///< arc length of the stroke at which this run of it begins, m
  /// Waypoints of the stroke before that place: arm angles of grids are measured along all of it.
  std::vector<Waypoint> before;
  bool operator==(const StrokePiece&) const = default;
};

/// One run of the tool on the workpiece: a task with a name. Its `start`, `start_at`, `rolls` and
/// `steps` are unset, unless it is the one path of its arm (ArmTask). Its `end` is the posture in
/// which the run ends, after the retract; a reversible stroke has none. Where it is `closed`, the
/// run ends after the retract in the joints in which it begins before the approach, and both lines
/// are equal.
struct Stroke : Task {
  std::string name;
  /// True: the tool may run from the last waypoint to the first.
  bool reversible = false;
  /// Where the tool stands before the stroke and after it, m, in the tool frame of the waypoint at
  /// which the run begins or ends; e.g. (0, 0, -0.05) for 50 mm against the tool's z axis. The tool
  /// comes and leaves on a straight line without turning. Zero: no such line.
  Vector3d approach = Vector3d::Zero(), retract = Vector3d::Zero();
  /// Speed of the tool along the stroke, m/s, instead of ArmTask::process_speed.
  std::optional<double> process_speed;
  /// Speed of the tool along approach and retract, m/s, instead of ArmTask::approach_speed.
  std::optional<double> approach_speed;
  /// Speed of the tool from each waypoint to the next, m/s, instead of process_speed; empty: none.
  std::vector<double> feed;
  /// Set by with_lift_offs() alone.
  std::optional<StrokePiece> piece;
};

/// Returns the arc length, m, that is added to the s of a run's rows to be that of its whole
/// stroke; 0 unless the stroke is done in several runs.
[[nodiscard]] inline double s_of_piece(const Stroke& stroke) {
  return stroke.piece ? stroke.piece->begin : 0;
}

/// A stroke of a job in one of its directions.
struct StrokeRun {
  std::size_t stroke = 0;  ///< index in ArmTask::strokes
  bool reversed = false;   ///< from the last waypoint to the first
  bool operator==(const StrokeRun&) const = default;
};

/// Returns the waypoints of a run in the stroke's path frame, with those at which its approach
/// begins and its retract ends.
[[nodiscard]] std::vector<Waypoint> waypoints_of_run(const Stroke& stroke, bool reversed);

/// Returns which rows of a run's waypoints_of_run() belong to the stroke: the first and the last.
struct ProcessWaypoints {
  std::size_t first = 0, last = 0;
};
[[nodiscard]] ProcessWaypoints process_waypoints(const Stroke& stroke);

}  // namespace swivel
