// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/answer/advice.hpp"

#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "answer/stroke_words.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

struct Limit {
  Advice::Change change;
  const char* key;
  const char* phrase;
  const char* unit;
  double scale;  // how many of the unit shown make one of the limit's
};
constexpr Limit kLimits[] = {
    {Advice::Change::kClearance, "clearance", "clearance", "mm", 1e3},
    {Advice::Change::kJointMargin, "joint_margin", "joint margin", "deg", kDegrees},
    {Advice::Change::kManipulability, "manipulability", "manipulability", "", 1},
    {Advice::Change::kArmSlope, "arm_slope", "arm slope", "rad/m", 1},
    {Advice::Change::kRollSlope, "roll_slope", "roll slope", "rad/m", 1},
    {Advice::Change::kJointStep, "joint_step", "joint step", "rad", 1},
    {Advice::Change::kToolSpeed, "tool_speed", "tool speed", "m/s", 1},
    {Advice::Change::kToolTurnSpeed, "tool_turn_speed", "tool turn speed", "rad/s", 1},
    {Advice::Change::kPathError, "tool_path_error", "tool-path error", "mm", 1e3},
    {Advice::Change::kAngleError, "tool_angle_error", "tool angle error", "deg", kDegrees},
    {Advice::Change::kStepError, "step_error", "step error", "rad", 1},
};

/// Returns an offset in words: "10 mm along +y", three numbers for a slanted one, "up to 20 mm" for
/// zero, where no way was better than another. `most_tried`: the longest that is tried, m.
std::string words(const Vector3d& offset, double most_tried) {
  if (offset.isZero(0)) return formatted("up to %.3g mm", 1e3 * most_tried);
  Eigen::Index axis = 0;
  const double most = offset.cwiseAbs().maxCoeff(&axis);
  if (offset.norm() > most * (1 + 1e-9))
    return formatted("(%.3g, %.3g, %.3g) mm", 1e3 * offset.x(), 1e3 * offset.y(), 1e3 * offset.z());
  return formatted("%.3g mm along %c%c", 1e3 * most, offset[axis] < 0 ? '-' : '+',
                   static_cast<char>('x' + axis));
}

}  // namespace

const char* to_string(Advice::Change change) {
  for (const Limit& limit : kLimits)
    if (limit.change == change) return limit.key;
  switch (change) {
    case Advice::Change::kFreeStart:
      return "free_start";
    case Advice::Change::kFreeEnd:
      return "free_end";
    case Advice::Change::kFreeRoll:
      return "free_roll";
    case Advice::Change::kFiner:
      return "finer";
    case Advice::Change::kDepth:
      return "allow";
    case Advice::Change::kMoveObject:
      return "move_object";
    case Advice::Change::kWithoutObject:
      return "without_object";
    case Advice::Change::kHold:
      return "hold";
    case Advice::Change::kTurnedOver:
      return "turned_over";
    case Advice::Change::kLeads:
      return "leads";
    case Advice::Change::kMovePaths:
      return "move_paths";
    case Advice::Change::kWithoutStrokes:
      return "without_strokes";
    case Advice::Change::kReversed:
      return "reversed";
    case Advice::Change::kBestOrder:
      return "best_order";
    case Advice::Change::kHome:
      return "home";
    case Advice::Change::kApproach:
      return "approach";
    case Advice::Change::kRetract:
      return "retract";
    case Advice::Change::kLines:
      return "lines";
    default:
      return "?";
  }
}

const char* to_string(Advice::Outcome outcome) {
  switch (outcome) {
    case Advice::Outcome::kSolved:
      return "solved";
    case Advice::Outcome::kFurther:
      return "further";
    case Advice::Outcome::kNoHelp:
      return "no_help";
    case Advice::Outcome::kUnknown:
      return "unknown";
  }
  return "?";
}

namespace {

/// Returns a change of strokes in a phrase; nothing for another change.
std::optional<std::string> words_of_strokes(const Advice& advice) {
  switch (advice.change) {
    case Advice::Change::kWithoutStrokes:
      return stroke_or_strokes(advice.strokes) + " left out";
    case Advice::Change::kReversed:
      return stroke_or_strokes(advice.strokes) + " run backwards";
    case Advice::Change::kBestOrder:
      return "order: best";
    case Advice::Change::kApproach:
      return formatted("an approach of %.0f mm to ", 1e3 * advice.length.value_or(0)) +
             stroke_or_strokes(advice.strokes);
    case Advice::Change::kRetract:
      return formatted("a retract of %.0f mm behind ", 1e3 * advice.length.value_or(0)) +
             stroke_or_strokes(advice.strokes);
    case Advice::Change::kLines:
      return formatted("approach and retract of %.0f mm at all strokes",
                       1e3 * advice.length.value_or(0));
    case Advice::Change::kHome: {
      if (!advice.home) return "another home";
      std::string text;
      for (const double joint : advice.home->coordinates())
        if (std::isfinite(joint)) text += (text.empty() ? "" : ", ") + formatted("%.4f", joint);
      return "home: {joints: [" + text + "]}";
    }
    default:
      return std::nullopt;
  }
}

/// Returns the change without the arm that it is of.
std::string words_of_change(const Advice& advice) {
  if (auto of_strokes = words_of_strokes(advice)) return *std::move(of_strokes);
  for (const Limit& limit : kLimits)
    if (limit.change == advice.change) {
      const auto shown = [&](const std::optional<double>& value) {
        return value
                   ? formatted("%.3g%s%s", limit.scale * *value, *limit.unit ? " " : "", limit.unit)
                   : std::string("none");
      };
      return std::string(limit.phrase) + " of " + shown(advice.to) + " instead of " +
             shown(advice.from);
    }
  switch (advice.change) {
    case Advice::Change::kFreeStart:
      return "a free start";
    case Advice::Change::kFreeEnd:
      return "a free end";
    case Advice::Change::kFreeRoll:
      return "a tool free to turn about its axis (path.roll)";
    case Advice::Change::kFiner:
      return "half the steps of the lattice, and nodes on narrow arcs (`resolution`)";
    case Advice::Change::kDepth:
      return "contact with '" + advice.object +
             formatted("' up to %.3g mm deep instead of %.3g mm", 1e3 * *advice.to,
                       1e3 * *advice.from);
    case Advice::Change::kMoveObject:
      return "'" + advice.object + "' moved by " + words(advice.offset, Advice::kMostMove) +
             (advice.also.empty() ? ""
                                  : " and '" + advice.also + "' by " +
                                        words(advice.also_offset, Advice::kMostMove));
    case Advice::Change::kHold:
      return "'" + advice.object + "' held " +
             (advice.to ? formatted("at %.3g", *advice.to) : std::string("elsewhere than")) +
             formatted(advice.to ? " instead of %.3g %s" : " at %.3g %s", *advice.from,
                       advice.slides ? "m" : "rad");
    case Advice::Change::kTurnedOver:
      return "the tool turned over, by 180 deg about its x axis (robot.tool)";
    case Advice::Change::kLeads:
      return "leads";
    case Advice::Change::kMovePaths:
      return (advice.arm.empty() ? "both paths" : "path") + std::string(" moved by ") +
             words(advice.offset, Advice::kMostPathMove);
    default:
      return "no '" + advice.object + "'" +
             (advice.also.empty() ? "" : " and no '" + advice.also + "'");
  }
}

}  // namespace

std::string words(const Advice& advice) {
  const std::string change = words_of_change(advice);
  if (advice.arm.empty()) return change;
  return "'" + advice.arm + (advice.change == Advice::Change::kLeads ? "' " : "': ") + change;
}

}  // namespace swivel
