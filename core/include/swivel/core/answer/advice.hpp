// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// One change of a problem that has no answer, and what planning the changed problem gave.
struct Advice {
  enum class Change {
    kFreeStart,       ///< no start is given
    kFreeEnd,         ///< no end is given
    kFreeRoll,        ///< path.roll without bounds: the tool may be turned about its axis freely
    kFiner,           ///< half the steps of the lattice, and Resolution::arcs
    kClearance,       ///< limits.clearance, and self_clearance where that stands in the way
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
    /// A greater depth to which bodies that may touch an object (SceneObject::allow) may be in it.
    kDepth,
    kMoveObject,     ///< an object moved, and the path with it if it is given in its frame
    kWithoutObject,  ///< an object removed
    kHold,           ///< a joint between base and tip that is held, held elsewhere
    kTurnedOver,     ///< the tool turned over: its frame by 180 deg about its x axis
    kLeads,          ///< of two arms: the arm leads, and its leader so far follows
    kMovePaths,      ///< of two arms: the path of one moved, or those of both alike
    // The changes below are of problems with strokes.
    kWithoutStrokes,  ///< some left out
    kReversed,        ///< one run from its last waypoint to its first
    kBestOrder,       ///< order: best
    kHome,            ///< another home
    kApproach,        ///< a longer approach of one, against the tool's z axis
    kRetract,         ///< a longer retract of one, against the tool's z axis
    kLines,           ///< longer approaches and retracts of all
  };
  /// What planning the changed problem gave.
  enum class Outcome {
    kSolved,
    kFurther,  ///< no path either, but one comes further
    kNoHelp,   ///< no path, and none comes further
    kUnknown,  ///< not decided in time, or not tried
  };

  static constexpr double kMostMove = 0.08;      ///< most that kMoveObject moves an object, m
  static constexpr double kMostPathMove = 0.04;  ///< most that kMovePaths moves paths, m

  Change change = Change::kFreeStart;
  /// Name of the object, for kDepth, kMoveObject and kWithoutObject; of the joint, for kHold.
  std::string object;
  bool slides = false;  ///< for kHold: the joint is prismatic
  /// For limits, kDepth and kHold: the value of the problem, and the changed one, in the problem's
  /// units.
  std::optional<double> from, to;
  /// For kMoveObject and kMovePaths: the move in the base frame, m; zero where none helps.
  Vector3d offset{0, 0, 0};
  /// For kMoveObject and kWithoutObject: a second object that is moved or removed as well, and its
  /// move; empty: none is.
  std::string also = {};
  Vector3d also_offset{0, 0, 0};
  /// Name of the arm that is changed where there are two; for kLeads, of the one that leads. Empty:
  /// both arms are changed, or the scene is.
  std::string arm = {};
  /// Names of the strokes that are changed; for kHome, kBestOrder and kLines none.
  std::vector<std::string> strokes = {};
  std::optional<double> length = {};  ///< for kApproach, kRetract and kLines, m
  /// For kHome, rad; none where no home was found to try. Of an arm of six joints whose tool may
  /// not turn the seventh number is infinite: there is none.
  std::optional<Config> home = {};
  /// What planning gave; kFurther is only given for one path.
  Outcome outcome = Outcome::kUnknown;
  std::optional<double> cost = {};  ///< for kSolved: cost of the answer
  /// If there is no path, of one path alone: how far one comes, m along it.
  std::optional<double> reached_s = {};
};

/// What would help a stroke, or one of two arms, that has no path by itself.
struct AdviceAlone {
  std::string name;  ///< of the stroke or the arm
  bool is_arm = false;
  std::vector<Advice> advice;
};

/// What would help a problem that has no answer.
struct AdviceList {
  std::vector<Advice> changes;     ///< what helps first
  std::vector<AdviceAlone> alone;  ///< of strokes or arms without a path by themselves
};

/// Returns the name of a change in files: "free_start", "clearance", ...
[[nodiscard]] const char* to_string(Advice::Change change);
/// Returns "solved", "further", "no_help" or "unknown".
[[nodiscard]] const char* to_string(Advice::Outcome outcome);
/// Returns the change in a phrase: "clearance of 3.75 mm instead of 5 mm", "'rail' moved by 10 mm
/// along +y", "no 'rail' and no 'post'", "contact with 'plate' up to 3.5 mm deep instead of 3 mm";
/// of strokes "stroke 'ring' left out", "a retract of 50 mm behind stroke 'ring'"; of two arms
/// "'left': a free start", "'right' leads", "both paths moved by 20 mm along +z".
[[nodiscard]] std::string words(const Advice& advice);

}  // namespace swivel
