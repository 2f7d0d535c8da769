// SPDX-License-Identifier: BSD-3-Clause

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

/// Calls visit(joint of the model, its limit in the chain) for every joint of the arm that the
/// model has. The roll is no joint of the robot and is left out.
template <class Visit>
void for_each_joint(const RobotModel& robot, const Chain& chain, const Visit& visit) {
  for (std::size_t j = 0; j < kDof - (chain.roll ? 1 : 0); ++j)
    if (const int joint = robot.find_joint(chain.joint_names[j]); joint >= 0)
      visit(robot.joints[static_cast<std::size_t>(joint)], chain.limit[j]);
}

std::string text(double number) {
  return formatted("%.6g", number);
}

std::string range(double lower, double upper) {
  return text(lower) + " to " + text(upper);
}

std::string place(const RobotModel& robot, const Joint& joint) {
  return joint.line > 0 ? robot.source + ":" + std::to_string(joint.line) : robot.source;
}

/// Collects the joints that share one fault, and names them in one sentence.
struct Joints {
  std::string names;
  int count = 0;
  const Joint* first = nullptr;
  void add(const Joint& joint) {
    names.append(names.empty() ? "'" : ", '").append(joint.name).append("'");
    if (++count == 1) first = &joint;
  }
  [[nodiscard]] std::string sentence(const RobotModel& robot, const char* one, const char* several,
                                     const std::string& rest) const {
    return place(robot, *first) + ": joint" + (count > 1 ? "s " : " ") + names + " " +
           (count > 1 ? several : one) + rest;
  }
};

/// Adds a line for every joint of the arm whose range is narrower than its own, since joints that
/// mimic it cannot follow further.
void add_narrowed(const RobotModel& robot, const Chain& chain, std::vector<std::string>& warnings) {
  constexpr double kRounding = 1e-9;  // rad or m
  for (std::size_t j = 0; j < kDof - (chain.roll ? 1 : 0); ++j) {
    const int index = robot.find_joint(chain.joint_names[j]);
    const JointLimit& limit = chain.limit[j];
    if (index < 0 || limit.continuous) continue;
    const Joint& joint = robot.joints[static_cast<std::size_t>(index)];
    const bool turns_for_ever = joint.type == Joint::Type::kContinuous;
    if (!turns_for_ever && limit.lower <= joint.lower + kRounding &&
        limit.upper >= joint.upper - kRounding)
      continue;
    std::string followers;
    for (const Chain::Follower& follower : chain.followers)
      if (follower.leader == static_cast<int>(j))
        followers.append(followers.empty() ? "'" : ", '").append(follower.name).append("'");
    const char* const unit = joint.type == Joint::Type::kPrismatic ? " m" : " rad";
    warnings.push_back(place(robot, joint) + ": joint '" + joint.name + "' is planned within " +
                       range(limit.lower, limit.upper) + unit +
                       (turns_for_ever ? "" : ", not " + range(joint.lower, joint.upper) + unit) +
                       ": the limits of what mimics it allow no more (" + followers + ")");
  }
}

}  // namespace

std::vector<std::string> file_warnings(const RobotModel& robot, const Chain& chain) {
  std::vector<std::string> warnings = robot.warnings;
  Joints soft;
  std::string ranges;
  for_each_joint(robot, chain, [&](const Joint& joint, const JointLimit&) {
    if (!joint.hard) return;
    soft.add(joint);
    ranges.append(ranges.empty() ? "" : ", ")
        .append(range(joint.lower, joint.upper) + " of " +
                range(joint.hard->lower, joint.hard->upper) +
                (joint.type == Joint::Type::kPrismatic ? " m" : " rad"));
  });
  if (soft.count > 0)
    warnings.push_back(soft.sentence(robot, "keeps", "keep",
                                     " the soft limits of a safety_controller: " + ranges +
                                         " (`limits.soft_limits: false` leaves them out)"));
  add_narrowed(robot, chain, warnings);
  return warnings;
}

std::string joints_at_rest(const RobotModel& robot, const Chain& chain) {
  Joints passive, empty;
  for_each_joint(robot, chain, [&](const Joint& joint, const JointLimit& limit) {
    if (joint.passive) passive.add(joint);
    if (!limit.continuous && !(limit.lower < limit.upper)) empty.add(joint);
  });
  if (passive.count > 0)
    return passive.sentence(
        robot, "is a passive_joint", "are passive_joints",
        " of the SRDF, which no motor moves: allowed in the arm are others: name it in robot.hold");
  if (empty.count > 0)
    return empty.sentence(
        robot, "has", "have",
        " an empty range in the URDF (lower = upper = " + text(empty.first->lower) +
            (empty.first->type == Joint::Type::kPrismatic ? " m" : " rad") +
            "): allowed is lower < upper, or robot.hold for a joint that stands still");
  return {};
}

}  // namespace swivel
