// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <string>

namespace swivel {

/// A cause for which nodes or edges of a lattice are removed, as a value: docs/model.md "Nodes",
/// "Edges". words() and figures() describe it for people; nothing reads these texts back.
struct Cause {
  enum class Kind {
    kNone,            ///< not found
    kNotAsked,        ///< not sought, because it was not asked for (Evidence::cause)
    kReach,           ///< the pose is too far for the arm (Side::kUpper) or too near (kLower)
    kSingular,        ///< axes or joint centres are in line
    kLimit,           ///< a joint is beyond its limit less the margin
    kManipulability,  ///< the manipulability (Yoshikawa) is too small
    kPair,            ///< two bodies are nearer than they must keep
    kContact,         ///< two bodies touch: no smaller clearance would help
    kArmSlope,        ///< the arm angle would change by more than limits.arm_slope allows
    kRollSlope,       ///< the roll would change by more than limits.roll_slope allows
    kJointStep,       ///< a joint would move by more than limits.joint_step
    kSpeed,           ///< a joint would be too fast at the tool speed asked for
    kPathError,       ///< the tool would leave its path by more than limits.tool_path_error
    kAngleError,      ///< the tool would turn off its path by more than limits.tool_angle_error
    kStepError,       ///< the step error would exceed limits.step_error
    kNotClosed,       ///< of a closed path: paths reach the end, but in other joints than the begin
    kCheck,           ///< a StateCheck of the caller refuses it
  };
  enum class Side { kNone, kLower, kUpper };

  Kind kind = Kind::kNone;
  Side side = Side::kNone;  ///< for kReach and kLimit
  std::string joint;        ///< for kLimit, kRollSlope, kJointStep and kSpeed: name of the joint
  /// For kLimit: every node has several joints beyond their limits; `joint` is the furthest.
  bool other_joints = false;
  /// For kLimit: the joint stands within its range, but the path goes on past its end, so that it
  /// would have to unwind by a turn.
  bool unwinds = false;
  bool slides = false;                ///< `joint` is prismatic: m stands for rad
  std::array<std::string, 2> bodies;  ///< for kPair and kContact: names of the bodies
  bool between_layers = false;        ///< for kPair, kContact, kCheck: on motions alone
  /// For kPair and kContact: name of a scene object that several bodies come too near to; `bodies`
  /// is one pair of them.
  std::string object;
  /// The value at the node or edge that misses least, and the limit: rad for joints and angles, m
  /// for lengths and joints that slide, no unit for manipulability. None where it was not measured.
  /// `value` is, where a joint leaves its range as the path ends, the furthest outside that the
  /// joint would reach before it came back.
  std::optional<double> value, limit;
  /// For kRollSlope: the travel for which `limit` is allowed, m. For kPair where a depth is
  /// allowed: that depth, m; `limit` is less by what the motions between layers need.
  std::optional<double> over;
  std::string check;  ///< for kCheck: name of the check

  bool operator==(const Cause&) const = default;

  /// Returns how far the value is from the limit, none where it was not measured.
  [[nodiscard]] std::optional<double> by() const;
  /// Returns the unit of value and limit: "m", "rad", or "".
  [[nodiscard]] const char* unit() const;
  /// Returns true if two causes are the same but for their values. Two that name the same object
  /// may name different bodies.
  [[nodiscard]] bool same_thing(const Cause& other) const;
};

/// Returns the name of a kind in files: "limit", "pair", ..., "none".
[[nodiscard]] const char* to_string(Cause::Kind kind);
/// Returns "lower", "upper", or "" for kNone.
[[nodiscard]] const char* to_string(Cause::Side side);
/// Returns the cause in a phrase: "no IK", "singular", "joint <name>", "joint limits", "<body> -
/// <body>", "joint step", ...; "not known: time was up" for kNone, "not asked for" for kNotAsked.
[[nodiscard]] std::string words(const Cause& cause);
/// Returns by how much the cause misses, for people: "out of reach by 3 mm", "0.4 deg beyond
/// -117.00 deg"; "" where it was not measured. `most` is the most that it misses by at one of
/// several places; the cause's own value is the least.
[[nodiscard]] std::string figures(const Cause& cause, std::optional<double> most = {});

}  // namespace swivel
