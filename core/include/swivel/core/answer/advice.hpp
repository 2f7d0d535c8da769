// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// One change of a problem that has no path, and what planning the changed problem gave.
struct Advice {
  enum class Change {
    kFreeStart,       ///< no start given
    kFreeRoll,        ///< path.roll without bounds: a tool that may stand turned about its axis as it likes
    kFiner,           ///< half the steps of the lattice, and Resolution::arcs
    kClearance,       ///< limits.clearance, and self_clearance where that is what bars
    kJointMargin,     ///< limits.joint_margin
    kManipulability,  ///< limits.manipulability
    kArmSlope,        ///< limits.arm_slope
    kRollSlope,       ///< limits.roll_slope
    kJointStep,       ///< limits.joint_step
    kToolSpeed,       ///< limits.tool_speed
    kToolTurnSpeed,   ///< limits.tool_turn_speed
    kPathError,       ///< limits.tool_path_error
    kAngleError,      ///< limits.tool_angle_error
    kStepError,       ///< limits.step_error
    kDepth,           ///< an object whose bodies that may touch it (SceneObject::allow) may be deeper in it
    kMoveObject,      ///< an object elsewhere, and the path with it where the path is given in its frame
    kWithoutObject,   ///< an object gone
  };
  enum class Outcome {
    kSolved,
    kFurther,  ///< no path either, but one comes further
    kNoHelp,   ///< no path, and none comes further
    kUnknown,  ///< not decided in time, or not tried
  };

  static constexpr double kMostMove = 0.02;  ///< m, of kMoveObject

  Change change = Change::kFreeStart;
  std::string object;              ///< of the last three
  std::optional<double> from, to;  ///< of limits and kDepth: what was asked, and what this is about, in their units
  Vector3d offset{0, 0, 0};        ///< of kMoveObject, m, base frame; zero where none of the ways helps
  Outcome outcome = Outcome::kUnknown;
  std::optional<double> cost;       ///< of kSolved
  std::optional<double> reached_s;  ///< of those that have no path, m
};

/// The name in files: "free_start", "clearance", ...
[[nodiscard]] const char* to_string(Advice::Change change);
/// "solved", "further", "no_help", "unknown".
[[nodiscard]] const char* to_string(Advice::Outcome outcome);
/// The change in a phrase: "clearance of 3.75 mm instead of 5 mm", "'rail' moved by 10 mm along +y", "contact
/// with 'plate' up to 3.5 mm deep instead of 3 mm".
[[nodiscard]] std::string words(const Advice& advice);

}  // namespace swivel
