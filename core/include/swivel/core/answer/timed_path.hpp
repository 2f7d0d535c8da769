// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"

namespace swivel {

/// A place where no joints follow from the rows of a trajectory, and why.
struct NoMotion {
  double s = 0;  ///< m along the path
  std::string reason;
  bool too_near = false;  ///< bodies come too near: other joints might help
};

/// A derivative of a joint's position that has a limit.
enum class JointRate { kSpeed, kAcceleration, kJerk };
/// Returns "speed", "acceleration" or "jerk".
[[nodiscard]] const char* to_string(JointRate rate);

/// The limits of the joints' rates: rad/s, rad/s^2, rad/s^3, all > 0. They are infinite for the
/// roll of the tool, which is no joint.
struct JointRates {
  Config speed = Config::Zero(), acceleration = Config::Zero(), jerk = Config::Zero();
  /// A rate that neither problem nor robot model states for some joints.
  struct Assumed {
    JointRate rate = JointRate::kJerk;
    std::array<bool, kDof> of = {};  ///< joints that it was assumed for
    std::string text;                ///< what was assumed, in one line
  };
  std::vector<Assumed> assumed;
};
/// A speed of the tool that holds from a place of the path on.
struct SpeedFrom {
  double s = 0;      ///< m along the path
  double speed = 0;  ///< m/s; > 0
};
/// How time_path() times a motion.
struct TimingOptions {
  double speed = 0;  ///< m/s of the tool along its path; > 0
  /// Other speeds, each from its place to that of the next; ascending. Before the first, `speed`
  /// holds.
  std::vector<SpeedFrom> speeds = {};
  /// Most turning speed of the tool, rad/s; unset: as fast as the joints allow where the path only
  /// turns.
  std::optional<double> turn_speed;
  double rate = 250;  ///< samples a second; > 0
  /// The motion is slower where the tool, the joints moving straight between samples, would leave
  /// its path by more than this, m; > 0.
  std::optional<double> chord = std::nullopt;
};

/// A sample of a motion, as a controller is sent it.
struct TimedRow {
  double t = 0;  ///< s
  TrajectoryRow row;
  Config v = Config::Zero(), a = Config::Zero();  ///< rad/s, rad/s^2
};

/// A motion along a path in time, and its measures.
struct TimedPath {
  std::vector<TimedRow> rows;  ///< at t = k / rate, the last at rest at the path's end
  double rate = 0;
  /// Speed asked of the tool along its path, m/s: what the user asked for, at most
  /// limits.tool_speed.
  double speed = 0;
  /// The last joint of rows is the roll of the tool (Chain::roll), which no controller moves.
  bool roll = false;
  /// Time until the tool rests at the end, s; the last row's t is later by less than a sample.
  double duration = 0;
  /// Time at the speeds asked for (less where `chord` asks for less) from the first moment to the
  /// last, s.
  double ideal = 0;
  /// The largest difference of a joint between samples, as a part of its rate limit, and where it
  /// is.
  struct Peak {
    double ratio = 0;
    int joint = 0;
    double t = 0, s = 0;
  };
  std::array<std::array<Peak, kDof>, 3> peaks;  ///< [JointRate][joint]
  /// A stretch that is slower than asked for, though the tool neither starts nor stops there, and
  /// the joint and rate that cause it.
  struct Slow {
    double from_s = 0, to_s = 0, from_t = 0, to_t = 0;
    double share = 1;  ///< part of the speed asked for, at its slowest
    int joint = 0;
    JointRate reason = JointRate::kSpeed;  ///< rate of that joint
    /// Part of the arm, "shoulder", "elbow" or "wrist", that is within 0.3 rad of being singular
    /// there; empty: none.
    std::string singular;
    double singular_angle = 0;  ///< its distance from singular, rad
  };
  std::vector<Slow> slow;
  /// A corner where the tool comes to rest on its way, since it may not be rounded.
  struct Stop {
    double s = 0, t = 0;
    int waypoint = 0;
  };
  std::vector<Stop> stops;
  int rounded = 0;  ///< corners that are rounded
  /// The most by which a rounded corner leaves the polyline, m and rad.
  double rounded_position = 0, rounded_angle = 0;
  /// The most by which the tool is off its path half-way between samples, where joints move
  /// straight from one to the next, m and rad.
  double between_position = 0, between_angle = 0;
  int rounds = 0;  ///< rounds of verifying and slowing down
  std::vector<std::string> warnings;
};

/// The result of time_path(): a motion, or why there is none.
struct TimingResult {
  std::optional<TimedPath> motion;
  std::optional<NoMotion> failure;  ///< set unless there is a motion
};

}  // namespace swivel
