// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/motion/path_motion.hpp"
#include "swivel/core/timing/shared_travel.hpp"

namespace swivel {

/// One of the arms that move by one clock. What it points to must outlive it.
struct TimedArm {
  const PathMotion* motion = nullptr;
  const JointRates* rates = nullptr;
  const TimingOptions* options = nullptr;
  /// The travel over the common parameter; null: the travel is the parameter.
  const SharedTravel* travel = nullptr;
  /// The arm whose tool carries the path of this one: the speeds asked of this arm's tool are those
  /// relative to it. Null: they are those in the base frame.
  const TimedArm* leader = nullptr;
  /// Most speeds of the tool in the base frame, m/s and rad/s, of an arm with a leader.
  std::optional<double> most_speed = std::nullopt, most_turn_speed = std::nullopt;
};

/// The motions of arms by one clock, or why there are none.
struct ArmsTiming {
  /// One for each arm, with rows at the same times. `duration`, `ideal` and `rounds` are those of
  /// all together; `slow` has the stretches that a joint of the arm causes; `stops` those of all,
  /// with the s of the arm.
  std::vector<TimedPath> motions;
  std::optional<NoMotion> failure;  ///< set unless there are motions
  std::size_t failed_arm = 0;
};

/// Times one or two arms as time_path() says, by one law of the common parameter over time: from
/// rest to rest, as fast as was found while every joint of every arm keeps its rates and no tool is
/// faster than its options ask. Samples are taken at the rate of the first arm's options. `rests`:
/// layers at which all arms rest. Deterministic. Throws Stopped.
[[nodiscard]] ArmsTiming time_arms(std::span<const TimedArm> arms, const std::vector<int>& rests,
                                   const Budget& budget = {});

}  // namespace swivel
