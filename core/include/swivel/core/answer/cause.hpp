// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <string>

namespace swivel {

/// One thing that removes nodes or edges of a lattice, as a value: docs/model.md "Nodes", "Edges". Words are made by words() and
/// figures(), for people alone; nothing reads them back.
struct Cause {
  enum class Kind {
    kNone,            ///< not found
    kReach,           ///< the pose is too far for the arm (Side::kUpper), or too near (Side::kLower)
    kSingular,        ///< axes or centres in line
    kLimit,           ///< a joint beyond its limit less the margin
    kManipulability,  ///< of Yoshikawa
    kPair,            ///< two bodies nearer than they must keep
    kContact,         ///< two bodies that touch: no smaller clearance would help
    kArmSlope,        ///< moves that exist change the arm angle by more than allowed
    kRollSlope,       ///< they turn the tool about its z axis by more than limits.roll_slope allows
    kJointStep,       ///< by more than limits.joint_step
    kSpeed,           ///< faster than a joint can, at the tool speed asked
    kPathError,       ///< limits.tool_path_error
    kAngleError,      ///< limits.tool_angle_error
    kStepError,       ///< limits.step_error
    kCheck,           ///< a StateCheck of the caller's refuses it
  };
  enum class Side { kNone, kLower, kUpper };

  Kind kind = Kind::kNone;
  Side side = Side::kNone;    ///< of kReach and kLimit
  std::string joint;          ///< of kLimit, kRollSlope, kJointStep and kSpeed
  bool other_joints = false;  ///< of kLimit: every node has several joints beyond their limits; `joint` is the furthest
  /// Set for kLimit where the joint stands within its range but the path goes on past its end: it would have to unwind by a turn.
  bool unwinds = false;
  std::array<std::string, 2> bodies;  ///< of kPair and kContact
  bool between_layers = false;        ///< of those and of kCheck: on motions only
  std::string object;  ///< of those: a scene object that several bodies come too near to; `bodies` is one pair of them
  /// What it is at the node or edge that misses least, and what is allowed: rad for joints and angles, else m; of manipulability
  /// without a unit. None where it was not measured.
  std::optional<double> value, limit;
  /// Of kRollSlope: the travel for which `limit` is allowed, m. Of kPair where a depth is allowed: that depth, m, of which `limit`
  /// leaves a part to the motions between layers.
  std::optional<double> over;
  std::string check;  ///< of kCheck: its name

  bool operator==(const Cause&) const = default;

  /// By how much; none where it was not measured.
  [[nodiscard]] std::optional<double> by() const;
  /// The unit of value and limit: "m", "rad", or "".
  [[nodiscard]] const char* unit() const;
  /// The same thing, whatever its value.
  [[nodiscard]] bool same_thing(const Cause& other) const;
};

/// The name in files: "limit", "pair", ...; "none".
[[nodiscard]] const char* to_string(Cause::Kind kind);
/// "lower", "upper"; "" of none.
[[nodiscard]] const char* to_string(Cause::Side side);
/// One phrase: "no IK", "singular", "joint <name>", "joint limits", "<body> - <body>", "joint step", ...; "not known: time was up"
/// of none.
[[nodiscard]] std::string words(const Cause& cause);
/// By how much, for people: "out of reach by 3 mm", "0.4 deg beyond -117.00 deg"; "" where it was not measured. `most`: of several
/// places, the most that it misses by; the least is the cause's own.
[[nodiscard]] std::string figures(const Cause& cause, std::optional<double> most = {});

}  // namespace swivel
