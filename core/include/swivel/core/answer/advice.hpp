// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// One change of a problem that has no path, and what planning the changed problem gave.
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
    kLeads,          ///< of workcells: the arm leads, and its leader so far follows
    kMovePaths,      ///< of workcells: the path of an arm moved, or those of both alike
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
  Outcome outcome = Outcome::kUnknown;
  std::optional<double> cost;       ///< for kSolved: cost of the path
  std::optional<double> reached_s;  ///< if there is no path: how far one comes, m along it
};

/// Returns the name of a change in files: "free_start", "clearance", ...
[[nodiscard]] const char* to_string(Advice::Change change);
/// Returns "solved", "further", "no_help" or "unknown".
[[nodiscard]] const char* to_string(Advice::Outcome outcome);
/// Returns the change in a phrase: "clearance of 3.75 mm instead of 5 mm", "'rail' moved by 10 mm
/// along +y", "no 'rail' and no 'post'", "contact with 'plate' up to 3.5 mm deep instead of 3 mm".
[[nodiscard]] std::string words(const Advice& advice);

/// One change of a job that cannot be planned, and what planning the changed job gave.
struct JobAdvice {
  enum class Change {
    kWithoutStrokes,  ///< some strokes left out
    kReversed,        ///< a stroke run from its last waypoint to its first
    kBestOrder,       ///< order: best
    kHome,            ///< another home
    kApproach,        ///< a longer approach of a stroke, against the tool's z axis
    kRetract,         ///< a longer retract of a stroke, against the tool's z axis
    kLines,           ///< longer approaches and retracts of all strokes
  };
  Change change = Change::kWithoutStrokes;
  std::vector<std::string> strokes;  ///< names; of kHome, kBestOrder and kLines none
  std::optional<double> length;      ///< of kApproach, kRetract and kLines, m
  std::optional<Config> home;        ///< of kHome, rad; none where no home was found to try
  /// kSolved: there is a job; kNoHelp: there is none; kUnknown: not decided in time, or not tried.
  Advice::Outcome outcome = Advice::Outcome::kUnknown;
  std::optional<double> cost;  ///< of kSolved
};

/// What would help a stroke of a job by itself, which has no path.
struct StrokeAdvice {
  std::string stroke;
  std::vector<Advice> advice;
};

/// What would help a job that cannot be planned.
struct AdviceOnJob {
  std::vector<JobAdvice> job;
  std::vector<StrokeAdvice> strokes;
};

/// One change of a workcell that has no plan, and what planning the changed workcell gave. Its
/// outcome is never kFurther, and `reached_s` is unset.
struct WorkcellAdvice : Advice {
  /// Name of the arm that is changed, of kLeads of the arm that leads; empty: both arms, or the
  /// scene.
  std::string arm = {};
};

/// What would help an arm of a workcell by itself, which has no path.
struct ArmAdvice {
  std::string arm;
  std::vector<Advice> advice;
};

/// What would help a workcell that has no plan.
struct AdviceOnWorkcell {
  std::vector<WorkcellAdvice> cell;
  std::vector<ArmAdvice> arms;
};

/// What would help a problem that has no answer: one path, strokes or two arms.
using AnyAdvice = std::variant<std::vector<Advice>, AdviceOnJob, AdviceOnWorkcell>;

/// Returns the name of a change in files: "without_strokes", "reversed", "best_order", "home",
/// "approach", "retract", "lines".
[[nodiscard]] const char* to_string(JobAdvice::Change change);
/// Returns the change in a phrase: "stroke 'ring' left out", "a retract of 50 mm behind stroke
/// 'ring'".
[[nodiscard]] std::string words(const JobAdvice& advice);
/// Returns the advice for the terminal, a line for each change.
[[nodiscard]] std::string advice_text(const AdviceOnJob& advice);
/// Returns the change in a phrase: "'left': a free start", "'right' leads", "'left': path moved by
/// 10 mm along +y", "both paths moved by 20 mm along +z".
[[nodiscard]] std::string words(const WorkcellAdvice& advice);
/// Returns the advice for the terminal, a line for each change.
[[nodiscard]] std::string advice_text(const AdviceOnWorkcell& advice);

}  // namespace swivel
