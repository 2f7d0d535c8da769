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

/// One run of the tool on the workpiece, as a job has many of them: a task with a name. Its
/// `start`, `start_at`, `rolls` and `steps` are unset. Its `end` is the posture in which the run
/// ends, after the retract; a reversible stroke has none. Where it is `closed`, the run ends after
/// the retract in the joints in which it begins before the approach, and both lines are equal.
struct Stroke : Task {
  std::string name;
  /// True: the tool may run from the last waypoint to the first.
  bool reversible = false;
  /// Where the tool stands before the stroke and after it, m, in the tool frame of the waypoint at
  /// which the run begins or ends; e.g. (0, 0, -0.05) for 50 mm against the tool's z axis. The tool
  /// comes and leaves on a straight line without turning. Zero: no such line.
  Vector3d approach = Vector3d::Zero(), retract = Vector3d::Zero();
  /// Speed of the tool along the stroke, m/s, instead of Job::process_speed.
  std::optional<double> process_speed;
  /// Speed of the tool along approach and retract, m/s, instead of Job::approach_speed.
  std::optional<double> approach_speed;
  /// Speed of the tool from each waypoint to the next, m/s, instead of process_speed; empty: none.
  std::vector<double> feed;
  /// Set by with_lift_offs() alone.
  std::optional<StrokePiece> piece;
};

/// Lift-offs: a stroke that no single run finishes may be done in several, between which the tool
/// leaves the workpiece.
struct LiftOffs {
  double cost = 0;  ///< of each lift-off, in units of the metric; >= 0
  /// m along the stroke: the next run begins at least so much before the end of the one before it,
  /// at a layer of the path, but not before the stroke itself; >= 0.
  double overlap = 0;
  bool operator==(const LiftOffs&) const = default;
};

/// In which order the strokes of a job are run: as they are listed, or in the cheapest order that
/// is found, reversible ones in either direction.
enum class StrokeOrder { kGiven, kBest };

/// A job: strokes with transitions between them, from a home configuration and back to it.
/// Transitions are moves in joint space, on which the tool follows no path. Everything but the
/// strokes' tasks is shared by all strokes.
struct Job : Robot {
  std::string source;  ///< problem file, for messages
  std::vector<SceneObject> scene;
  std::vector<Variation> vary;
  std::vector<Stroke> strokes;
  /// What transitions keep: clearances on motions, joint margin, joint rates.
  Limits limits;
  /// The joint configuration from which the job starts and at which it ends, rad; unset: it starts
  /// at the first stroke and ends at the last one.
  std::optional<Config> home;
  StrokeOrder order = StrokeOrder::kGiven;
  /// Speed of the tool along strokes, m/s; unset: limits.tool_speed.
  std::optional<double> process_speed;
  /// Speed of the tool along approaches and retracts, m/s; unset: that of the stroke.
  std::optional<double> approach_speed;
  /// The share of the joints' speeds that transitions may use, more than 0 and at most 1.
  double rapid = 1;
  /// Unset: each stroke is done in one run. Only with StrokeOrder::kGiven.
  std::optional<LiftOffs> lift;
};

/// A place at which the tool lifts off.
struct LiftOff {
  std::size_t stroke = 0;       ///< index in Job::strokes
  double end = 0, resumed = 0;  ///< arc lengths of the stroke, m, where a run ends, the next begins
  bool operator==(const LiftOff&) const = default;
};

/// Returns the job whose strokes are the runs between lift-offs, in order: those of stroke "ring"
/// are named "ring/1", "ring/2", and so on. A run keeps approach, retract, speeds and limits of its
/// stroke, the last one also its `end`. `lift_offs` are in the order of the job. Throws
/// InvalidArgument for places that are not, that are beyond a stroke's ends, or that resume behind
/// the end of the run before.
[[nodiscard]] Job with_lift_offs(const Job& job, const std::vector<LiftOff>& lift_offs);

/// Returns the number of lift-offs of a job that with_lift_offs() made.
[[nodiscard]] std::size_t lift_off_count(const Job& job);

/// Returns the arc length, m, that is added to the s of a run's rows to be that of its whole
/// stroke; 0 unless the stroke is done in several runs.
[[nodiscard]] inline double s_of_piece(const Stroke& stroke) {
  return stroke.piece ? stroke.piece->begin : 0;
}

/// Returns the index in Job::strokes of the stroke with this name; none if the job has no such
/// stroke.
[[nodiscard]] std::optional<std::size_t> find_stroke(const Job& job, const std::string& name);

/// A stroke of a job in one of its directions.
struct StrokeRun {
  std::size_t stroke = 0;  ///< index in Job::strokes
  bool reversed = false;   ///< from the last waypoint to the first
  bool operator==(const StrokeRun&) const = default;
};

/// Returns the waypoints of a run in the stroke's path frame, with those at which its approach
/// begins and its retract ends.
[[nodiscard]] std::vector<Waypoint> waypoints_of_run(const Stroke& stroke, bool reversed);

/// Returns the problem that one run of a job poses by itself. Its path begins with the approach and
/// ends with the retract; its `source` names the stroke.
[[nodiscard]] PathProblem problem_of_run(const Job& job, const StrokeRun& run);

/// Returns which rows of a run's waypoints_of_run() belong to the stroke: the first and the last.
struct ProcessWaypoints {
  std::size_t first = 0, last = 0;
};
[[nodiscard]] ProcessWaypoints process_waypoints(const Stroke& stroke);

/// Returns what transitions keep: the job's limits, with the least joint margin of the job and its
/// strokes, since strokes begin and end there.
[[nodiscard]] Limits limits_of_transitions(const Job& job);

/// Throws InvalidArgument for a job that makes no sense whatever the robot: what
/// validate(PathProblem) refuses of any of its runs, no strokes, names that are empty or taken, a
/// start in a stroke, an end in a reversible one, a home that is not finite, speeds that are not
/// positive, feeds that are not one per waypoint, lift-offs that cost less than nothing or overlap
/// by less, in an order that is to be found, or with names that have a slash.
void validate(const Job& job);

}  // namespace swivel
