// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/motion/timed_path.hpp"

namespace swivel {

/// A moment at which the tool's process is switched on or off: the first sample at or after the
/// begin of a stroke, or at or after its end.
struct ProcessEvent {
  double t = 0;            ///< s
  std::size_t stroke = 0;  ///< index in Problem::strokes
  double s = 0;            ///< m along the run's path, its approach included
  bool on = false;
};

/// The motion of a whole job in time: its runs and transitions one after the other, with rest in
/// between.
struct JobMotion {
  std::vector<TimedRow> rows;  ///< at t = k / rate
  /// Index in Answer::parts of the part to which each row leads; the first row belongs to the
  /// first part. The row between a run and a transition has the run's s, arm angle and branch;
  /// other rows of transitions have none.
  std::vector<std::size_t> part;
  double rate = 0;                   ///< samples a second
  double duration = 0;               ///< s
  std::vector<ProcessEvent> events;  ///< in the order of their times
  /// Of each run, in the order of parts: its motion without rows.
  std::vector<TimedPath> runs;
  bool roll = false;  ///< the last joint of rows is the roll of the tool (Chain::roll)
  std::vector<std::string> warnings;
};

/// The result of timing a job: a motion, or the part that has none and why.
struct JobTimingResult {
  std::optional<JobMotion> motion;
  std::optional<NoMotion> failure;  ///< set unless there is a motion
  std::size_t failed_part = 0;      ///< index in Answer::parts, for `failure`
};

}  // namespace swivel
