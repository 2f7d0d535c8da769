// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/motion/timed_path.hpp"

namespace swivel {

/// The motion of two arms by one clock, from rest to rest.
struct WorkcellMotion {
  std::array<std::string, 2> names;
  /// The motion of each arm: rows of both are at the same times t = k / rate. `slow` of an arm has
  /// the stretches that its joints cause, `stops` of both are the same moments.
  std::array<TimedPath, 2> arms;
  double rate = 0;      ///< samples a second
  double duration = 0;  ///< time until both tools rest at the end, s
  double ideal = 0;     ///< time with the faster tool at the speed asked for throughout, s
  /// Waypoints that are passed without a stop though the ratio of the tools' speeds changes there.
  int blended = 0;
  /// Number of the arm whose path the other one's tool carries, if there is one, and the most by
  /// which its tool is off that path at samples, m and rad.
  std::optional<std::size_t> follower;
  double follower_position = 0, follower_angle = 0;
  std::vector<std::string> warnings;  ///< of both arms together; each arm has its own besides
};

/// The result of timing a workcell: a motion, or why there is none.
struct WorkcellTiming {
  std::optional<WorkcellMotion> motion;
  std::optional<NoMotion> failure;  ///< set unless there is a motion; s is that of failed_arm
  std::size_t failed_arm = 0;
  double time_ms = 0, check_ms = 0;  ///< spent on timing and on collision checking
};

}  // namespace swivel
