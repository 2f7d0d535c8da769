// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/timed_path.hpp"

namespace swivel {

/// A moment at which the tool's process is switched on or off: the first sample at or after the
/// begin of a stroke, or at or after its end.
struct ProcessEvent {
  double t = 0;            ///< s
  std::size_t stroke = 0;  ///< index in ArmTask::strokes
  double s = 0;            ///< m along the run's path, its approach included
  bool on = false;
};

/// The motion of one arm in time: its runs and transitions one after the other, with rest in
/// between. Measures besides rows, rate, duration, roll and warnings are of an arm with one run; of
/// several, each is in `runs`.
struct ArmMotion : TimedPath {
  std::string name;  ///< of one arm of two
  /// Index in ArmAnswer::parts of the part to which each row leads; the first row belongs to the
  /// first part. The row between a run and a transition has the run's s, arm angle and branch;
  /// other rows of transitions have none. Empty where there is one part.
  std::vector<std::size_t> part;
  std::vector<ProcessEvent> events;  ///< in the order of their times
  /// The motion of each run, without its rows, in the order of parts. Empty where there is one
  /// part.
  std::vector<TimedPath> runs;
};

/// The motion of all arms by one clock, from rest to rest.
struct Motion {
  /// Rows of two arms are at the same times t = k / rate. `slow` of an arm has the stretches that
  /// its joints cause, `stops` of both are the same moments.
  std::vector<ArmMotion> arms;
  double rate = 0;      ///< samples a second
  double duration = 0;  ///< time until all tools rest at the end, s
  double ideal = 0;     ///< time of two arms with the faster tool at the speed asked for, s
  /// Number of waypoints that two arms pass without a stop though the ratio of the tools' speeds
  /// changes there.
  int blended = 0;
  /// Number of the arm whose path the other one's tool carries, if there is one, and the most by
  /// which its tool is off that path at samples, m and rad.
  std::optional<std::size_t> follower;
  double follower_position = 0, follower_angle = 0;
  std::vector<std::string> warnings;  ///< of both arms together; each arm has its own besides
};

/// The result of timing an answer: a motion, or why there is none.
struct MotionTiming {
  std::optional<Motion> motion;
  /// Set unless there is a motion; s is that of the arm and the part that have none.
  std::optional<NoMotion> failure;
  std::size_t failed_arm = 0;
  std::size_t failed_part = 0;       ///< index in ArmAnswer::parts
  double time_ms = 0, check_ms = 0;  ///< spent on timing and on collision checking
};

}  // namespace swivel
