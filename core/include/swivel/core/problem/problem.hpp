// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/stroke.hpp"

namespace swivel {

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

/// One arm of a problem: its chain and what it carries, and what its tool does.
///
/// Its tool runs along `strokes`. Between two of them, from `home` before the first and back to it
/// after the last, the arm moves in joint space, where the tool follows no path: these moves are
/// transitions. One stroke without a name is a path: nothing comes before it or after it, and of
/// the members below `given` none is set.
///
/// Where a problem has two arms, each has one path. That path's `rolls` are unset, and its `steps`
/// too, unless the motion of the other arm is given.
struct ArmTask : Robot {
  std::string name;  ///< of one of two arms; else empty
  std::vector<Stroke> strokes;
  /// Joints at each row of a given motion, rad, base to tip: the arm moves straight in joint space
  /// from row to row, and is not planned. Its path has no waypoints then, limits and cost alone.
  /// Robot::roll of an arm of six joints is a whole circle then, and the seventh number of a row
  /// says how far these joints have turned the tool about its z axis. Empty: the arm is planned.
  std::vector<Config> given;
  /// What transitions keep: clearances on motions, joint margin, joint rates.
  Limits transition_limits;
  /// The joint configuration from which the arm starts and at which it ends, rad; unset: it starts
  /// at the first stroke and ends at the last one.
  std::optional<Config> home;
  StrokeOrder order = StrokeOrder::kGiven;
  /// Speed of the tool along strokes, m/s; unset: limits.tool_speed of the stroke.
  std::optional<double> process_speed;
  /// Speed of the tool along approach and retract, m/s; unset: the speed of the stroke.
  std::optional<double> approach_speed;
  /// The share of the joints' speeds that transitions may use, more than 0 and at most 1.
  double rapid = 1;
  /// Unset: each stroke is done in one run. Only with StrokeOrder::kGiven.
  std::optional<LiftOffs> lift;

  /// Returns the one stroke of an arm that has no more.
  [[nodiscard]] Stroke& path() { return strokes.front(); }
  [[nodiscard]] const Stroke& path() const { return strokes.front(); }
};

/// What a problem file says, with the files that it names loaded: one arm or two in a scene. Poses
/// are in base_link unless said otherwise. Source: io::load_problem().
///
/// Two arms are of one robot model and work at one time: at every waypoint both arms are at theirs,
/// and between two waypoints both paths are cut into the same number of steps. They have the same
/// model, base_link and `hold`.
///
/// The motion of one of two arms may be given; its rows are the layers then. Task::steps of the
/// other arm says at which rows its waypoints are: so many rows after the one before. Empty: it has
/// one waypoint for each row, or two, at the first and at the last row.
///
/// Task::path_frame of one of two arms may be the name of the other one. That other arm leads: its
/// tool, as its joints have turned it, carries the path of this arm, the follower. The leader has
/// no roll unless its motion is given: which roll the plan would choose is not known where the
/// follower's path is laid out.
struct Problem {
  std::string source;  ///< problem file, for messages
  std::vector<ArmTask> arms = std::vector<ArmTask>(1);
  std::vector<SceneObject> scene;
  std::vector<Variation> vary;
  /// Pairs of bodies, one of either arm, that may touch at any depth: names of links or of attached
  /// bodies.
  std::vector<std::array<std::string, 2>> may_touch;

  /// Returns the first arm: the only one, unless there are two.
  [[nodiscard]] ArmTask& arm() { return arms.front(); }
  [[nodiscard]] const ArmTask& arm() const { return arms.front(); }
  /// Returns the number of the arm that leads the arm of number `arm`, if one does: 1 - arm; else
  /// -1.
  [[nodiscard]] int leader_of(std::size_t arm) const {
    if (arms.size() != 2) return -1;
    const std::string& frame = arms[arm].path().path_frame;
    return !frame.empty() && frame == arms[1 - arm].name ? static_cast<int>(1 - arm) : -1;
  }
  /// Returns the number of the arm whose motion is given, if one is; else nothing.
  [[nodiscard]] std::optional<std::size_t> given_arm() const {
    for (std::size_t arm = 0; arm < arms.size(); ++arm)
      if (!arms[arm].given.empty()) return arm;
    return std::nullopt;
  }
};

/// Returns true if the problem is that of one path: one arm with one stroke that has no name.
[[nodiscard]] bool is_path(const Problem& problem);

/// A place at which the tool lifts off.
struct LiftOff {
  std::size_t stroke = 0;       ///< index in ArmTask::strokes
  double end = 0, resumed = 0;  ///< arc lengths of the stroke, m, where a run ends, the next begins
  bool operator==(const LiftOff&) const = default;
};

/// Returns the job whose strokes are the runs between lift-offs, in order: those of stroke "ring"
/// are named "ring/1", "ring/2", and so on. A run keeps approach, retract, speeds and limits of its
/// stroke, the last one also its `end`. `lift_offs` are in the order of the job. Throws
/// InvalidArgument for places that are not, that are beyond a stroke's ends, or that resume behind
/// the end of the run before.
[[nodiscard]] Problem with_lift_offs(const Problem& job, const std::vector<LiftOff>& lift_offs);

/// Returns the number of lift-offs of a job that with_lift_offs() made.
[[nodiscard]] std::size_t lift_off_count(const Problem& problem);

/// Returns the index in ArmTask::strokes of the stroke with this name; none if the job has no such
/// stroke.
[[nodiscard]] std::optional<std::size_t> find_stroke(const Problem& problem,
                                                     const std::string& name);

/// Returns a run in words: "'ring'", or "'ring' backwards".
[[nodiscard]] std::string words(const StrokeRun& run, const Problem& problem);

/// Returns the problem that a path of an arm poses by itself: `path` is the task of one of its
/// strokes, as it is.
[[nodiscard]] PathProblem problem_of_path(const Problem& problem, const ArmTask& arm,
                                          const Task& path);

/// Returns the problem that one run of the arm's strokes poses by itself. Its path begins with the
/// approach and ends with the retract; its `source` names the stroke, unless is_path().
[[nodiscard]] PathProblem problem_of_run(const Problem& problem, const StrokeRun& run);

/// Returns a problem of two arms with an empty path each.
[[nodiscard]] Problem two_arms();
/// Returns the problem of one path.
[[nodiscard]] Problem one_path(const PathProblem& path);

/// Returns what transitions keep: ArmTask::transition_limits, with the least joint margin of these
/// and the strokes, since strokes begin and end there.
[[nodiscard]] Limits limits_of_transitions(const Problem& problem);

/// Throws InvalidArgument for a problem that makes no sense whatever the robot: arms that are not
/// one or two; what validate(PathProblem) refuses of any run of a stroke.
///
/// Where there is one arm, it refuses: no strokes, names of strokes that are empty (unless the
/// stroke is a path) or taken, a start in a stroke with a name, an end in a reversible one, a home
/// that is not finite, speeds that are not positive, feeds that are not one per waypoint, lift-offs
/// that cost less than nothing or overlap by less, in an order that is to be found, or with names
/// that have a slash.
///
/// Where there are two arms, it refuses: names of arms that are empty, equal or those of a scene
/// object or the base link; arms whose model, base_link or hold differ, which lead each other,
/// which have more than one path, or whose paths have different numbers of waypoints; two given
/// motions, or one of fewer than two rows, with joints that are not finite, or of an arm with a
/// path, a start, an end or a bounded roll; `steps` that do not lead to its last row; windows of
/// the roll at waypoints; a leader that is planned with a roll, or whose start may be off its path;
/// attached bodies of one name.
void validate(const Problem& problem);

}  // namespace swivel
