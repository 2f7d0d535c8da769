// SPDX-License-Identifier: BSD-3-Clause
#include "robots/joint_limits.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "schema/yaml_value.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/nearest_name.hpp"

namespace swivel::io {

namespace {

constexpr double kRounded = 1e-6;  // rad or m by which files may differ from the URDF

std::string range_text(double lower, double upper) {
  return formatted("[%.6g, %.6g]", lower, upper);
}

/// Returns what is wrong with the name of a joint that should move.
std::optional<LimitFault> fault_of_name(const RobotModel& robot, const std::string& name) {
  const int index = robot.find_joint(name);
  if (index >= 0 && robot.joints[static_cast<std::size_t>(index)].movable()) return std::nullopt;
  std::vector<std::string> known;
  for (const Joint& joint : robot.joints)
    if (joint.movable()) known.push_back(joint.name);
  const std::string allowed = "a joint of " + robot.source + " that moves";
  if (index >= 0) return LimitFault{"joint '" + name + "' does not move", allowed};
  return LimitFault{"unknown joint '" + name +
                        (known.empty() ? "'" : "', nearest is '" + nearest_name(name, known) + "'"),
                    allowed};
}

Joint& joint_of(RobotModel& robot, const std::string& name) {
  return robot.joints[static_cast<std::size_t>(robot.find_joint(name))];
}

/// The words of one joint in MoveIt's file.
class JointWords {
 public:
  JointWords(const std::string& joint, const YamlValue& value) : joint_(joint) {
    for (auto& [word, entry] : value.entries()) entries_.emplace(word, entry);
  }
  /// Returns a number that holds, > 0: its word is there, and `has` is not false.
  [[nodiscard]] std::optional<double> rate(const char* word, const char* has) {
    const auto number = find(word);
    if (is_off(has) || !number) return std::nullopt;
    const double value = number->number();
    if (!(value > 0)) number->fail("is " + formatted("%.6g", value), "a number > 0");
    return value;
  }
  [[nodiscard]] std::optional<YamlValue> find(const char* word) {
    const auto found = entries_.find(word);
    if (found == entries_.end()) return std::nullopt;
    read_.push_back(word);
    return found->second;
  }
  /// Returns whether a word like has_velocity_limits is there and false.
  [[nodiscard]] bool is_off(const char* has) {
    const auto value = find(has);
    return value && !value->boolean();
  }
  /// Returns the place and the name of a word that nothing has read, and that is not one of those
  /// which say nothing of motions here.
  [[nodiscard]] std::optional<std::string> unread() const {
    static constexpr const char* kNotOfMotions[] = {"has_effort_limits", "max_effort",
                                                    "angle_wraparound"};
    for (const auto& [word, value] : entries_)
      if (std::find(read_.begin(), read_.end(), word) == read_.end() &&
          std::find(std::begin(kNotOfMotions), std::end(kNotOfMotions), word) ==
              std::end(kNotOfMotions))
        return value.where() + ": of joint '" + joint_ + "' is not known and not kept";
    return std::nullopt;
  }

 private:
  std::string joint_;
  std::map<std::string, YamlValue> entries_;
  std::vector<std::string> read_;
};

/// Reads MoveIt's file into a robot.
class JointLimitsReader {
 public:
  explicit JointLimitsReader(RobotModel& robot) : robot_(robot) {}

  void read(const YamlValue& root) {
    bool found = false;
    for (const auto& [key, value] : root.entries()) {
      if (key != "joint_limits") {
        warn(value.where() + ": is not kept" +
             (key.find("scaling_factor") != std::string::npos
                  ? ", rates are those of the joints (`limits.joint_speed` narrows them)"
                  : ""));
        continue;
      }
      found = true;
      if (!value.is_null())
        for (const auto& [joint, words] : value.entries()) read_joint(joint, words);
    }
    if (!found) root.fail("has no joint_limits", "a map joint_limits: joint → its limits");
    if (!unlimited_.empty())
      warn(root.where() + ": has_velocity_limits is false of " + unlimited_ +
           ": the speeds of the URDF are kept");
  }

 private:
  void warn(const std::string& text) { robot_.warnings.push_back(text); }

  void read_joint(const std::string& name, const YamlValue& value) {
    if (const auto fault = fault_of_name(robot_, name)) {
      warn(value.where() + ": " + fault->what + ": not kept");
      return;
    }
    if (value.is_null()) return;
    JointWords words(name, value);
    Joint& joint = joint_of(robot_, name);
    const bool speeds_off = words.is_off("has_velocity_limits");
    if (speeds_off && joint.velocity > 0)
      unlimited_.append(unlimited_.empty() ? "'" : ", '").append(name).append("'");
    if (const auto rate = words.rate("max_velocity", "has_velocity_limits")) joint.velocity = *rate;
    const auto speeding = words.rate("max_acceleration", "has_acceleration_limits"),
               slowing = words.rate("max_deceleration", "has_deceleration_limits");
    if (speeding || slowing)
      joint.acceleration = std::min(speeding.value_or(*(slowing ? slowing : speeding)),
                                    slowing.value_or(*(speeding ? speeding : slowing)));
    if (const auto rate = words.rate("max_jerk", "has_jerk_limits")) joint.jerk = *rate;
    read_range(value, words, joint);
    if (const auto unread = words.unread()) warn(*unread);
  }

  void read_range(const YamlValue& place, JointWords& words, const Joint& joint) {
    const auto least = words.find("min_position"), most = words.find("max_position");
    if (words.is_off("has_position_limits") || (!least && !most)) return;
    const bool bounded = joint.type != Joint::Type::kContinuous;
    if (!bounded && (!least || !most))
      place.fail("states one of min_position and max_position of a continuous joint", "both");
    Joint::Range range{least ? least->number() : joint.lower, most ? most->number() : joint.upper};
    if (bounded && (range.lower < joint.lower - kRounded || range.upper > joint.upper + kRounded)) {
      warn(place.where() + ": " + range_text(range.lower, range.upper) + " of joint '" +
           joint.name + "' reaches beyond " + range_text(joint.lower, joint.upper) +
           " of the URDF, which is kept");
      range = {std::max(range.lower, joint.lower), std::min(range.upper, joint.upper)};
    }
    if (const auto fault = narrow_range(robot_, joint.name, range))
      place.fail(fault->what, fault->allowed);
  }

  RobotModel& robot_;
  std::string unlimited_;  // names of joints whose speeds the file calls unlimited
};

const Schema& joint_limits_schema() {
  // Files of other programs: any words, which the reader knows or warns of.
  static const Schema schema = map(
      either(number(), or_null(map(or_null(map(either(either(number(), boolean()), text())))))));
  return schema;
}

}  // namespace

std::optional<LimitFault> narrow_range(RobotModel& robot, const std::string& name,
                                       const Joint::Range& range) {
  if (auto fault = fault_of_name(robot, name)) return fault;
  Joint& joint = joint_of(robot, name);
  if (!(range.lower < range.upper))
    return LimitFault{range_text(range.lower, range.upper) + " is empty",
                      "[lower, upper] with lower < upper"};
  if (joint.type == Joint::Type::kContinuous) {
    joint.type = Joint::Type::kRevolute;
    joint.lower = range.lower;
    joint.upper = range.upper;
    return std::nullopt;
  }
  if (range.lower < joint.lower - kRounded || range.upper > joint.upper + kRounded)
    return LimitFault{range_text(range.lower, range.upper) + " reaches beyond the joint's limits",
                      "a range within " + range_text(joint.lower, joint.upper)};
  joint.lower = std::max(joint.lower, range.lower);
  joint.upper = std::min(joint.upper, range.upper);
  return std::nullopt;
}

std::optional<LimitFault> keep_off_limits(RobotModel& robot, const std::string& name,
                                          double margin) {
  if (auto fault = fault_of_name(robot, name)) return fault;
  Joint& joint = joint_of(robot, name);
  if (joint.type == Joint::Type::kContinuous) return std::nullopt;
  if (!(joint.lower + margin < joint.upper - margin))
    return LimitFault{"leaves no range for joint '" + name + "'",
                      formatted("less than %.6g", (joint.upper - joint.lower) / 2)};
  joint.lower += margin;
  joint.upper -= margin;
  return std::nullopt;
}

void read_joint_limits(const std::filesystem::path& yaml, RobotModel& robot) {
  robot.files.joint_limits = std::filesystem::absolute(yaml).string();
  JointLimitsReader(robot).read(load_yaml(yaml, joint_limits_schema()));
}

void keep_limits(const RobotOptions& options, RobotModel& robot) {
  if (!options.joint_limits.empty()) read_joint_limits(options.joint_limits, robot);
  for (const auto& [joint, range] : options.limits)
    if (const auto fault = narrow_range(robot, joint, range))
      throw InputError(robot.source + ": limits of joint '" + joint + "': " + fault->what +
                       ": allowed is " + fault->allowed);
  robot.files.limits = options.limits;
}

}  // namespace swivel::io
