// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"

namespace swivel {

/// Where no posture follows from the rows of a trajectory.
struct NoMotion {
  double s = 0;  ///< m along the path
  std::string reason;
  bool too_near = false;  ///< bodies come too near: other joints might do
};

enum class JointRate { kSpeed, kAcceleration, kJerk };
[[nodiscard]] const char* to_string(JointRate rate);

/// What the joints can do: rad/s, rad/s^2, rad/s^3, all > 0. Infinite for the roll of the tool, which is no joint.
struct JointRates {
  Config speed = Config::Zero(), acceleration = Config::Zero(), jerk = Config::Zero();
  /// A rate that neither problem nor robot model states for some joints.
  struct Assumed {
    JointRate rate = JointRate::kJerk;
    std::array<bool, kDof> of = {};  ///< the joints it was assumed for
    std::string text;                ///< one line: what was assumed
  };
  std::vector<Assumed> assumed;
};

struct TimingOptions {
  double speed = 0;                            ///< m/s, of the tool along its path; > 0
  std::optional<double> turn_speed;            ///< rad/s; unset: as fast as the joints allow where the path only turns
  double rate = 250;                           ///< samples a second; > 0
  std::optional<double> chord = std::nullopt;  ///< m: slower where the tool would leave its path by more between samples; > 0
};

/// A sample of a motion: what a controller is sent.
struct TimedRow {
  double t = 0;  ///< s
  TrajectoryRow row;
  Config v = Config::Zero(), a = Config::Zero();  ///< rad/s, rad/s^2
};

/// A motion along a path in time, and what can be said of it.
struct TimedPath {
  std::vector<TimedRow> rows;  ///< at k / rate, the last at rest at the path's end
  double rate = 0;
  double speed = 0;     ///< m/s, asked of the tool along its path: what its user asked for, no more than limits.tool_speed
  bool roll = false;    ///< the last joint of rows is the roll of the tool (Chain::roll), which no controller moves
  double duration = 0;  ///< s, until the tool rests at the end; less than the last row's t by less than a sample
  double ideal = 0;     ///< s, at the speeds asked for (less where `chord` asks for less) from the first moment to the last
  /// The largest of a joint's differences between samples, by what the joint can do.
  struct Peak {
    double ratio = 0;
    int joint = 0;
    double t = 0, s = 0;
  };
  std::array<std::array<Peak, kDof>, 3> peaks;  ///< [JointRate][joint]
  /// A stretch that is slower than asked for, though the tool neither starts nor stops there.
  struct Slow {
    double from_s = 0, to_s = 0, from_t = 0, to_t = 0;
    double share = 1;  ///< of the speed asked for, at its slowest
    int joint = 0;
    JointRate reason = JointRate::kSpeed;  ///< of that joint
    std::string singular;       ///< "shoulder", "elbow" or "wrist" where one is within 0.3 rad of being singular, else empty
    double singular_angle = 0;  ///< rad, of it there
  };
  std::vector<Slow> slow;
  /// Where the tool comes to rest on its way, since the corner may not be rounded.
  struct Stop {
    double s = 0, t = 0;
    int waypoint = 0;
  };
  std::vector<Stop> stops;
  int rounded = 0;                                 ///< corners
  double rounded_position = 0, rounded_angle = 0;  ///< m and rad, the most by which a corner's curve leaves the polyline
  double between_position = 0, between_angle = 0;  ///< m and rad, tool off its path where joints move straight between samples
  int rounds = 0;                                  ///< of verifying and slowing down
  std::vector<std::string> warnings;
};

/// A motion, or why there is none.
struct TimingResult {
  std::optional<TimedPath> motion;
  std::optional<NoMotion> failure;  ///< unless there is a motion
};

}  // namespace swivel
