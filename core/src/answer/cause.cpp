// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/answer/cause.hpp"

#include <cmath>
#include <cstdio>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

std::string range(double low, double high) {
  const std::string first = formatted("%.3g", low), last = formatted("%.3g", high);
  return first == last ? first : first + " to " + last;
}

constexpr double kMillimetres = 1e3;

}  // namespace

std::optional<double> Cause::by() const {
  if (!value || !limit) return std::nullopt;
  return std::abs(*value - *limit);
}

const char* Cause::unit() const {
  switch (kind) {
    case Kind::kReach:
    case Kind::kPair:
    case Kind::kContact:
    case Kind::kPathError:
      return "m";
    case Kind::kLimit:
    case Kind::kJointStep:
    case Kind::kSpeed:
      return slides ? "m" : "rad";
    case Kind::kAngleError:
    case Kind::kStepError:
    case Kind::kArmSlope:
    case Kind::kRollSlope:
      return "rad";
    default:
      return "";
  }
}

bool Cause::same_thing(const Cause& other) const {
  return kind == other.kind && side == other.side && joint == other.joint &&
         other_joints == other.other_joints && unwinds == other.unwinds &&
         (object.empty() ? bodies == other.bodies : true) && object == other.object &&
         between_layers == other.between_layers && check == other.check;
}

const char* to_string(Cause::Kind kind) {
  switch (kind) {
    case Cause::Kind::kReach:
      return "reach";
    case Cause::Kind::kSingular:
      return "singular";
    case Cause::Kind::kLimit:
      return "limit";
    case Cause::Kind::kManipulability:
      return "manipulability";
    case Cause::Kind::kPair:
      return "pair";
    case Cause::Kind::kContact:
      return "contact";
    case Cause::Kind::kArmSlope:
      return "arm_slope";
    case Cause::Kind::kRollSlope:
      return "roll_slope";
    case Cause::Kind::kJointStep:
      return "joint_step";
    case Cause::Kind::kSpeed:
      return "speed";
    case Cause::Kind::kPathError:
      return "path_error";
    case Cause::Kind::kAngleError:
      return "angle_error";
    case Cause::Kind::kStepError:
      return "step_error";
    case Cause::Kind::kNotClosed:
      return "not_closed";
    case Cause::Kind::kCheck:
      return "check";
    case Cause::Kind::kNotAsked:
      return "not_asked";
    case Cause::Kind::kNone:
      break;
  }
  return "none";
}

const char* to_string(Cause::Side side) {
  return side == Cause::Side::kLower ? "lower" : side == Cause::Side::kUpper ? "upper" : "";
}

std::string words(const Cause& cause) {
  switch (cause.kind) {
    case Cause::Kind::kReach:
      return "no IK";
    case Cause::Kind::kSingular:
      return "singular";
    case Cause::Kind::kLimit:
      return cause.other_joints ? "joint limits" : "joint " + cause.joint;
    case Cause::Kind::kManipulability:
      return "manipulability";
    case Cause::Kind::kPair:
    case Cause::Kind::kContact:
      return cause.bodies[0] + " - " + cause.bodies[1] +
             (cause.between_layers ? " between layers" : "");
    case Cause::Kind::kArmSlope:
      return "arm slope";
    case Cause::Kind::kRollSlope:
      return "roll slope";
    case Cause::Kind::kJointStep:
      return "joint step";
    case Cause::Kind::kSpeed:
      return "tool speed";
    case Cause::Kind::kPathError:
      return "tool-path error";
    case Cause::Kind::kAngleError:
      return "tool-angle error";
    case Cause::Kind::kStepError:
      return "step error";
    case Cause::Kind::kNotClosed:
      return "no path closes";
    case Cause::Kind::kCheck:
      return "check " + cause.check + (cause.between_layers ? " between layers" : "");
    case Cause::Kind::kNotAsked:
      return "not asked for";
    case Cause::Kind::kNone:
      break;
  }
  return "not known: time was up";
}

std::string figures(const Cause& cause, std::optional<double> most) {
  const auto by = cause.by();
  if (!by) return "";
  const auto misses = [&](double unit) {
    return range(unit * *by, unit * std::max(*by, most.value_or(*by)));
  };
  const auto of = [&](const char* format, double unit) {
    return formatted(format, unit * *cause.value, unit * *cause.limit);
  };
  switch (cause.kind) {
    case Cause::Kind::kReach:
      return (cause.side == Cause::Side::kUpper ? "out of reach by "
                                                : "too near to the shoulder by ") +
             (*by < 10 ? misses(kMillimetres) + " mm" : misses(1) + " m");
    case Cause::Kind::kLimit:
      if (cause.slides)
        return (cause.other_joints ? cause.joint + ": " : "") + misses(kMillimetres) +
               " mm beyond " + formatted("%.4g mm", kMillimetres * *cause.limit);
      return (cause.other_joints ? cause.joint + ": " : "") + misses(kDegrees) + " deg beyond " +
             formatted("%.2f deg", kDegrees * *cause.limit) +
             (cause.unwinds ? ": at the end of its range, it would have to unwind by a turn" : "");
    case Cause::Kind::kPair:
      if (*cause.limit >= 0) return of("%.3g mm apart, asked %.3g mm", kMillimetres);
      return of("%.3g mm deep, allowed %.3g mm", -kMillimetres) +
             (cause.over ? formatted(": %.3g mm less what motions need", kMillimetres * *cause.over)
                         : "");
    case Cause::Kind::kContact:
      return *cause.limit > 0 ? formatted("they touch, asked %.3g mm", kMillimetres * *cause.limit)
                              : std::string("they touch");
    case Cause::Kind::kRollSlope:
      return cause.joint +
             formatted(": %.3g rad in %.3g mm, allowed %.3g rad: roll_slope %.3g rad/m",
                       *cause.value, kMillimetres * *cause.over, *cause.limit,
                       *cause.limit / *cause.over);
    case Cause::Kind::kJointStep:
      return cause.joint + ": " +
             (cause.slides ? of("%.3g mm in one layer, allowed %.3g mm", kMillimetres)
                           : of("%.3g rad in one layer, allowed %.3g rad", 1)) +
             ": of a layer, so a smaller ds may help";
    case Cause::Kind::kSpeed:
      return cause.joint + ": " +
             (cause.slides ? of("%.3g mm, allowed %.3g mm", kMillimetres)
                           : of("%.3g rad, allowed %.3g rad", 1));
    case Cause::Kind::kPathError:
      return of("%.3g mm, allowed %.3g mm", kMillimetres);
    case Cause::Kind::kArmSlope:
    case Cause::Kind::kAngleError:
    case Cause::Kind::kStepError:
      return of("%.3g rad, allowed %.3g rad", 1);
    case Cause::Kind::kManipulability:
      return of("%.3g, asked %.3g", 1);
    default:
      return "";
  }
}

}  // namespace swivel
