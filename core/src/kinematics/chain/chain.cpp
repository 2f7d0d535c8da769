// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/robot_key_error.hpp"

namespace swivel {

namespace {

/// Returns the turn about the line through p along the unit vector a.
Chain::Turn turn_about(const Vector3d& a, const Vector3d& p) {
  const Matrix3d along = a * a.transpose(), across = Matrix3d::Identity() - along;
  Matrix3d cross;
  cross << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  Chain::Turn turn;
  turn.still << along, across * p, 0, 0, 0, 1;
  turn.cosine << across, -across * p, 0, 0, 0, 0;
  turn.sine << cross, -cross * p, 0, 0, 0, 0;
  return turn;
}

/// Returns the shift along the unit vector a: its "sine" is the position itself.
Chain::Turn shift_along(const Vector3d& a) {
  Chain::Turn shift{Eigen::Matrix4d::Identity(), Eigen::Matrix4d::Zero(), Eigen::Matrix4d::Zero()};
  shift.sine.col(3).head<3>() = a;
  return shift;
}

Pose at(const Chain::Turn& turn, double cosine, double sine) {
  return Pose(turn.still + cosine * turn.cosine + sine * turn.sine);
}

/// The displacement of what a follower carries, given the displacement `parent` of the group that
/// carries the follower.
Pose displacement_of(const Chain::Follower& follower, const Config& q, const Pose& parent) {
  const double motion = follower.multiplier * q[follower.leader];
  if (follower.slides) return parent * Eigen::Translation3d(motion * follower.axis);
  return product(parent, at(follower.turn, std::cos(motion), std::sin(motion)));
}

Pose joint_motion(const Joint& joint, double position) {
  switch (joint.type) {
    case Joint::Type::kFixed:
      return Pose::Identity();
    case Joint::Type::kPrismatic:
      return Pose(Eigen::Translation3d(joint.axis * position));
    default:
      return Pose(Eigen::AngleAxisd(position, joint.axis));
  }
}

[[noreturn]] void fail(const RobotModel& robot, const std::string& what) {
  throw InputError(robot.source, what);
}
/// Throws RobotKeyError about a key of the section `robot` of a problem.
[[noreturn]] void fail_key(const RobotModel& robot, const char* key, const std::string& fault,
                           const std::string& entry = {}) {
  throw RobotKeyError(robot.source, key, fault, entry);
}

/// The way through the tree of links from base to tip: up to the nearest link that carries both,
/// which may be the base itself, then down.
struct KinematicPath {
  std::vector<int> links, joints;  // joint k leads from link k to link k + 1
  std::size_t up = 0;              // so many joints lead from child to parent
};
KinematicPath kinematic_path_between(const RobotModel& robot, int base, int tip) {
  const auto above = [&](int link) {
    std::vector<int> links{link};
    for (int joint;
         (joint = robot.links[static_cast<std::size_t>(links.back())].parent_joint) >= 0;)
      links.push_back(robot.joints[static_cast<std::size_t>(joint)].parent_link);
    return links;
  };
  std::vector<int> up = above(base), down = above(tip);
  int common = -1;
  for (; !up.empty() && !down.empty() && up.back() == down.back(); up.pop_back(), down.pop_back())
    common = up.back();
  if (common < 0)
    fail_key(
        robot, "tip_link",
        "'" + robot.links[static_cast<std::size_t>(tip)].name + "' is not joined to base_link '" +
            robot.links[static_cast<std::size_t>(base)].name + "': allowed are links of one tree");
  KinematicPath way;
  way.up = up.size();
  way.links = std::move(up);
  way.links.push_back(common);
  way.links.insert(way.links.end(), down.rbegin(), down.rend());
  for (std::size_t k = 0; k + 1 < way.links.size(); ++k)
    way.joints.push_back(
        robot.links[static_cast<std::size_t>(way.links[k < way.up ? k : k + 1])].parent_joint);
  return way;
}

int require_link(const RobotModel& robot, const char* key, const std::string& name) {
  const int link = robot.find_link(name);
  if (link < 0)
    fail_key(robot, key, "unknown link '" + name + "': allowed are the links of the robot");
  return link;
}

/// The joint that leads a joint that mimics, directly or through others: position = multiplier *
/// leader's + offset.
struct Lead {
  int leader = -1;
  double multiplier = 1, offset = 0;
};
/// Returns the lead of each joint; a joint that mimics none leads itself. Throws InputError where a
/// joint mimics itself.
std::vector<Lead> leads_of(const RobotModel& robot) {
  std::vector<Lead> leads(robot.joints.size());
  for (std::size_t j = 0; j < robot.joints.size(); ++j)
    if (!robot.joints[j].mimic) leads[j].leader = static_cast<int>(j);
  // Leaders may mimic others, in any order of the file: a joint waits for its leader.
  std::vector<std::size_t> waiting;
  for (std::size_t first = 0; first < robot.joints.size(); ++first) {
    for (std::size_t j = first; leads[j].leader < 0;
         j = static_cast<std::size_t>(robot.joints[j].mimic->joint)) {
      if (waiting.size() == robot.joints.size())
        fail(robot, "joint '" + robot.joints[j].name + "' mimics itself: allowed is another");
      waiting.push_back(j);
    }
    for (; !waiting.empty(); waiting.pop_back()) {
      const Joint::Mimic& mimic = *robot.joints[waiting.back()].mimic;
      const Lead& next = leads[static_cast<std::size_t>(mimic.joint)];
      leads[waiting.back()] = {next.leader, mimic.multiplier * next.multiplier,
                               mimic.multiplier * next.offset + mimic.offset};
    }
  }
  return leads;
}

bool is_in(const std::vector<int>& arm, int joint) {
  return std::find(arm.begin(), arm.end(), joint) != arm.end();
}

bool is_bounded(const Joint& joint) {
  return joint.type == Joint::Type::kRevolute || joint.type == Joint::Type::kPrismatic;
}

bool is_outside(const Joint& joint, double position) {
  constexpr double kRounding = 1e-9;
  return is_bounded(joint) &&
         (position < joint.lower - kRounding || position > joint.upper + kRounding);
}

std::string limits_allowed(const Joint& joint) {
  return "is outside its limits: allowed is " + formatted("%.9g", joint.lower) + " to " +
         formatted("%.9g", joint.upper);
}

/// Returns the positions of all joints with the arm at 0: those given by `hold`, else 0 or the
/// nearest limit; joints that mimic others follow. Throws RobotKeyError where `hold` names a joint
/// that cannot be held, or a position outside its limits.
std::vector<double> held_positions(const RobotModel& robot,
                                   const std::map<std::string, double>& hold,
                                   const std::vector<int>& arm, const std::vector<Lead>& leads) {
  std::vector<double> position(robot.joints.size(), 0.0);
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const Joint& joint = robot.joints[j];
    if (is_bounded(joint) && !is_in(arm, static_cast<int>(j)))
      position[j] = std::clamp(0.0, joint.lower, joint.upper);
  }
  for (const auto& [name, value] : hold) {
    const int j = robot.find_joint(name);
    const auto refuse = [&, &name = name](const std::string& fault) {
      fail_key(robot, "hold", "joint '" + name + "' " + fault, name);
    };
    if (j < 0)
      fail_key(robot, "hold", "unknown joint '" + name + "': allowed are the joints of the robot",
               name);
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    if (!joint.movable()) refuse("is fixed: allowed are movable joints");
    if (joint.mimic)
      refuse(
          "mimics another: allowed is that one, '" +
          robot.joints[static_cast<std::size_t>(leads[static_cast<std::size_t>(j)].leader)].name +
          "'");
    if (is_outside(joint, value))
      refuse("at " + formatted("%.9g", value) + " " + limits_allowed(joint));
    position[static_cast<std::size_t>(j)] = value;
  }
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const Joint& joint = robot.joints[j];
    if (!joint.mimic) continue;
    const auto leader = static_cast<std::size_t>(leads[j].leader);
    position[j] = leads[j].multiplier * position[leader] + leads[j].offset;
    const std::string& name = robot.joints[leader].name;
    if (joint.movable() && hold.count(name) > 0 && is_outside(joint, position[j]))
      fail_key(robot, "hold",
               "joint '" + name + "' at " + formatted("%.9g", position[leader]) + ": joint '" +
                   joint.name + "', which mimics it, is then at " + formatted("%.9g", position[j]) +
                   " and " + limits_allowed(joint),
               name);
  }
  return position;
}

/// Lists the movable joints between base and tip that are none of the arm's, from the base on.
std::vector<HeldJoint> held_between(const RobotModel& robot, const KinematicPath& way,
                                    const std::vector<int>& arm,
                                    const std::map<std::string, double>& hold,
                                    const std::vector<Lead>& leads,
                                    const std::vector<double>& position) {
  std::vector<HeldJoint> held;
  for (const int j : way.joints) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    if (!joint.movable() || is_in(arm, j)) continue;
    const Joint& leader =
        robot.joints[static_cast<std::size_t>(leads[static_cast<std::size_t>(j)].leader)];
    held.push_back({joint.name, position[static_cast<std::size_t>(j)],
                    joint.type == Joint::Type::kPrismatic, hold.count(leader.name) > 0,
                    joint.mimic ? leader.name : ""});
  }
  return held;
}

/// Narrows the limits of a joint of the arm, of position and rates, to what a joint that mimics it
/// can do. Throws InputError where no position is left.
void narrow(const RobotModel& robot, const Joint& follower, const Lead& lead, JointLimit& limit) {
  const double m = lead.multiplier;
  if (m == 0) return;
  const std::string& leader = robot.joints[static_cast<std::size_t>(lead.leader)].name;
  if (is_bounded(follower)) {
    const double a = (follower.lower - lead.offset) / m, b = (follower.upper - lead.offset) / m;
    if (limit.continuous)
      limit.lower = -std::numeric_limits<double>::infinity(), limit.upper = -limit.lower;
    limit.continuous = false;
    limit.lower = std::max(limit.lower, std::min(a, b));
    limit.upper = std::min(limit.upper, std::max(a, b));
    if (limit.lower > limit.upper)
      fail(robot, "joint '" + follower.name + "' mimics '" + leader +
                      "' of the arm, and no position of it is within the limits of both: allowed "
                      "are limits that meet");
  }
  const auto rate = [&](double& leaders, double own) {
    if (own > 0) leaders = leaders > 0 ? std::min(leaders, own / std::abs(m)) : own / std::abs(m);
  };
  rate(limit.velocity, follower.velocity);
  rate(limit.acceleration, follower.acceleration);
  rate(limit.jerk, follower.jerk);
}

/// Throws InputError where a follower stands elsewhere after a whole turn of a leader that can make
/// one: a posture is known by its joints up to whole turns of such joints.
void require_same_after_a_turn(const RobotModel& robot, const Chain& chain,
                               const Chain::Follower& follower) {
  const JointLimit& limit = chain.limit[static_cast<std::size_t>(follower.leader)];
  if (limit.slides) return;
  if (!limit.continuous && limit.upper - limit.lower < kTwoPi - 1e-3) return;
  if (!follower.slides && follower.multiplier == std::round(follower.multiplier)) return;
  fail(robot, "joint '" + follower.name + "' mimics '" +
                  chain.joint_names[static_cast<std::size_t>(follower.leader)] +
                  "' of the arm, which can make a whole turn, and stands elsewhere after one: not "
                  "supported: allowed are a range of "
                  "less than a turn, or a multiplier that is a whole number on a joint that turns");
}

/// Sets the group of each link, outwards from the way. Joints outside the way that mimic the arm's
/// become followers of the chain.
void group_links(const RobotModel& robot, const KinematicPath& way, const std::vector<int>& arm,
                 const std::vector<Lead>& leads, ArmModel& model) {
  constexpr int kUnknown = -1;
  const auto group_of = [&](int link) -> int& {
    return model.links[static_cast<std::size_t>(link)].group;
  };
  for (LinkPlacement& placement : model.links) placement.group = kUnknown;
  std::vector<int> order;  // links whose group is known
  int on_way = 0;
  for (std::size_t k = 0; k < way.links.size(); ++k) {
    on_way += k > 0 && is_in(arm, way.joints[k - 1]);
    group_of(way.links[k]) = on_way;
    order.push_back(way.links[k]);
  }
  Chain& chain = model.chain;
  const auto beyond = [&](int j, int group, double sign) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    const Lead& lead = leads[static_cast<std::size_t>(j)];
    const auto leader = std::find(arm.begin(), arm.end(), lead.leader);
    if (!joint.movable() || !joint.mimic || leader == arm.end()) return group;
    Chain::Follower follower;
    follower.name = joint.name;
    follower.parent = group;
    follower.root = chain.root_of(group);
    follower.leader = static_cast<int>(leader - arm.begin());
    follower.multiplier = lead.multiplier;
    follower.slides = joint.type == Joint::Type::kPrismatic;
    const Pose frame = model.links[static_cast<std::size_t>(joint.parent_link)].pose * joint.origin;
    follower.axis = sign * (frame.linear() * joint.axis).normalized();
    follower.point = frame.translation();
    follower.turn = turn_about(follower.axis, follower.point);
    narrow(robot, joint, lead, chain.limit[static_cast<std::size_t>(follower.leader)]);
    chain.followers.push_back(std::move(follower));
    return static_cast<int>(kDof + chain.followers.size());
  };
  std::vector<std::vector<int>> below(robot.links.size());
  for (std::size_t j = 0; j < robot.joints.size(); ++j)
    below[static_cast<std::size_t>(robot.joints[j].parent_link)].push_back(static_cast<int>(j));
  for (std::size_t k = 0; k < order.size(); ++k) {
    const int link = order[k], group = group_of(link);
    const auto go = [&](int j, int to, double sign) {
      if (group_of(to) != kUnknown) return;
      group_of(to) = beyond(j, group, sign);
      order.push_back(to);
    };
    for (const int j : below[static_cast<std::size_t>(link)])
      go(j, robot.joints[static_cast<std::size_t>(j)].child_link, 1);
    if (const int j = robot.links[static_cast<std::size_t>(link)].parent_joint; j >= 0)
      go(j, robot.joints[static_cast<std::size_t>(j)].parent_link, -1);
  }
  for (const Chain::Follower& follower : chain.followers)
    require_same_after_a_turn(robot, chain, follower);
}

/// Throws InputError where a joint on the way from base to tip is floating or planar.
void require_joints_of_one_degree(const RobotModel& robot, const KinematicPath& way,
                                  const std::string& base_link, const std::string& tip_link) {
  for (const int j : way.joints)
    if (robot.joints[static_cast<std::size_t>(j)].type == Joint::Type::kFree)
      fail(robot, "joint '" + robot.joints[static_cast<std::size_t>(j)].name + "' between '" +
                      base_link + "' and '" + tip_link +
                      "' is floating or planar: allowed between base_link and tip_link are fixed, "
                      "revolute, continuous and prismatic");
}

/// The joints of an arm, from the base on; `seven` is false where there are six and the roll of the
/// tool takes the place of the seventh.
struct ArmJoints {
  std::vector<int> joints;
  bool seven = true;
};

/// Throws InputError where more of the arm's joints slide than may: one of seven that are all there
/// are between base and tip, none of six. `between`: how many could be the arm's.
void require_slides_allowed(const RobotModel& robot, const ArmJoints& arm, std::size_t between) {
  constexpr double kLongest = 1000;  // m
  const Joint* slide = nullptr;
  for (const int j : arm.joints) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    if (joint.type != Joint::Type::kPrismatic) continue;
    if (!arm.seven)
      fail(robot, "joint '" + joint.name + "' is prismatic: the arm's six joints must turn");
    if (slide != nullptr)
      fail(robot, "joints '" + slide->name + "' and '" + joint.name +
                      "' are prismatic: allowed is one such joint among the arm's seven");
    if (!(joint.upper - joint.lower <= kLongest))
      fail(robot, "joint '" + joint.name +
                      "' is prismatic, with limits over 1000 m apart: allowed is at most that");
    slide = &joint;
  }
  if (slide != nullptr && between > kDof)
    fail(robot, "joint '" + slide->name + "' is prismatic, and " + std::to_string(between) +
                    " joints move between base and tip: allowed with one that slides are seven: "
                    "the file's robot.hold must say where one of them stands (--hold then says "
                    "where else)");
}

/// Chooses the arm's joints: the last seven on the way to the tip that move and are neither held
/// nor mimic another; the last six where there is no seventh, with `roll` where none turns. Throws
/// InputError where there are too few, or more of them slide than may.
ArmJoints choose_arm_joints(const RobotModel& robot, const KinematicPath& way,
                            const std::string& base_link, const std::string& tip_link,
                            const std::map<std::string, double>& hold,
                            const std::optional<Roll>& roll) {
  std::vector<int> arm;
  for (const int j : way.joints) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    if (joint.movable() && !joint.mimic && hold.count(joint.name) == 0) arm.push_back(j);
  }
  // A seventh joint that turns makes the roll one coordinate more.
  const bool seven =
      arm.size() >= kDof &&
      (!roll || robot.joints[static_cast<std::size_t>(arm[arm.size() - kDof])].type !=
                    Joint::Type::kPrismatic);
  const std::size_t joints = seven ? kDof : kDof - 1;
  if (arm.size() < joints)
    fail_key(robot, "tip_link",
             "only " + std::to_string(arm.size()) + " movable joints that are not held between '" +
                 base_link + "' and '" + tip_link + "': allowed are at least six");
  const std::size_t between = arm.size();
  arm.erase(arm.begin(), arm.end() - static_cast<std::ptrdiff_t>(joints));
  ArmJoints chosen{std::move(arm), seven};
  require_slides_allowed(robot, chosen, between);
  return chosen;
}

/// Throws InputError where a joint on the way from base to tip mimics one of the arm's: the tool
/// would move by that joint in two places.
void require_tool_moves_once(const RobotModel& robot, const KinematicPath& way,
                             const std::vector<int>& arm, const std::vector<Lead>& leads,
                             const std::string& base_link, const std::string& tip_link) {
  for (const int j : way.joints) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    const int leader = leads[static_cast<std::size_t>(j)].leader;
    if (joint.movable() && joint.mimic && is_in(arm, leader))
      fail(robot, "joint '" + joint.name + "', between '" + base_link + "' and '" + tip_link +
                      "', mimics '" + robot.joints[static_cast<std::size_t>(leader)].name +
                      "' of the arm: not supported: the tool would move by that joint in two "
                      "places; allowed are such joints on "
                      "links that do not carry the tool");
  }
}

/// Returns the poses of all links in the frame of link `base`, with the joints at `position`.
std::vector<LinkPlacement> place_links(const RobotModel& robot, int base,
                                       const std::vector<double>& position) {
  std::vector<LinkPlacement> links(robot.links.size());
  std::vector<char> known(robot.links.size(), 0);
  // A file may list a child before its parent: such links wait until the parent is placed.
  std::vector<int> waiting;
  for (std::size_t first = 0; first < robot.links.size(); ++first) {
    for (int link = static_cast<int>(first); !known[static_cast<std::size_t>(link)];) {
      known[static_cast<std::size_t>(link)] = 1;
      const int j = robot.links[static_cast<std::size_t>(link)].parent_joint;
      if (j < 0) break;
      waiting.push_back(link);
      link = robot.joints[static_cast<std::size_t>(j)].parent_link;
    }
    for (; !waiting.empty(); waiting.pop_back()) {
      const int j = robot.links[static_cast<std::size_t>(waiting.back())].parent_joint;
      const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
      const LinkPlacement& parent = links[static_cast<std::size_t>(joint.parent_link)];
      LinkPlacement& placement = links[static_cast<std::size_t>(waiting.back())];
      placement.pose =
          parent.pose * joint.origin * joint_motion(joint, position[static_cast<std::size_t>(j)]);
    }
  }
  const Pose root_in_base = links[static_cast<std::size_t>(base)].pose.inverse(Eigen::Isometry);
  for (LinkPlacement& placement : links) placement.pose = root_in_base * placement.pose;
  return links;
}

/// Sets names, axes and limits of the chain's joints, given the poses of the links with the arm at
/// 0. A joint that the way passes from child to parent turns the other way.
void set_chain_joints(const RobotModel& robot, const KinematicPath& way,
                      const std::vector<int>& arm, ArmModel& model) {
  Chain& chain = model.chain;
  for (std::size_t k = 0; k < arm.size(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(arm[k])];
    const Pose frame = model.links[static_cast<std::size_t>(joint.parent_link)].pose * joint.origin;
    chain.joint_names[k] = joint.name;
    const auto place = static_cast<std::size_t>(
        std::find(way.joints.begin(), way.joints.end(), arm[k]) - way.joints.begin());
    chain.axis[k] = (place < way.up ? -1.0 : 1.0) * (frame.linear() * joint.axis).normalized();
    chain.point[k] = frame.translation();
    const bool slides = joint.type == Joint::Type::kPrismatic;
    chain.turn[k] = slides ? shift_along(chain.axis[k]) : turn_about(chain.axis[k], chain.point[k]);
    chain.limit[k] = {
        joint.lower, joint.upper,        joint.velocity, joint.type == Joint::Type::kContinuous,
        slides,      joint.acceleration, joint.jerk};
  }
}

/// Makes the roll of the tool the seventh joint of an arm of six: X_6(q) Rot(z, -roll) is the
/// waypoint where X_6 has turned the tool by the roll. Without a range the roll stays 0.
void add_roll_joint(const RobotModel& robot, const std::optional<Roll>& roll, Chain& chain) {
  chain.roll = true;
  chain.roll_fixed = !roll;
  if (roll) chain.joint_names.back() = robot.find_joint("roll") < 0 ? "roll" : "tool_roll";
  chain.axis.back() = -chain.home.linear().col(2);
  chain.point.back() = chain.home.translation();
  chain.turn.back() = turn_about(chain.axis.back(), chain.point.back());
  // A roll that is fixed has no limit to come near to.
  chain.limit.back() =
      roll ? JointLimit{roll->lower, roll->upper, 0, roll->circle()} : JointLimit{0, 0, 0, true};
}

}  // namespace

std::array<Pose, kDof + 1> Chain::displacements(const Config& q) const {
  std::array<Pose, kDof + 1> G;
  G[0].setIdentity();
  displace(q, 0, kDof, G);
  return G;
}

void Chain::displace(const Config& q, int first, int last, std::array<Pose, kDof + 1>& G) const {
  for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last); ++k) {
    const double x = q[static_cast<Eigen::Index>(k)];
    G[k + 1] =
        product(G[k], limit[k].slides ? at(turn[k], 0, x) : at(turn[k], std::cos(x), std::sin(x)));
  }
}

Pose Chain::displacement(int group, const Config& q, const std::array<Pose, kDof + 1>& G) const {
  if (group <= static_cast<int>(kDof)) return G[static_cast<std::size_t>(group)];
  const Follower& follower = followers[static_cast<std::size_t>(group) - kDof - 1];
  return displacement_of(follower, q, displacement(follower.parent, q, G));
}

std::vector<Pose> Chain::all_displacements(const Config& q) const {
  const auto G = displacements(q);
  std::vector<Pose> all(G.begin(), G.end());
  for (const Follower& follower : followers)
    all.push_back(displacement_of(follower, q, all[static_cast<std::size_t>(follower.parent)]));
  return all;
}

int Chain::root_of(int group) const {
  return group <= static_cast<int>(kDof)
             ? group
             : followers[static_cast<std::size_t>(group) - kDof - 1].root;
}

Chain::Joints Chain::joints_between(int group_a, int group_b) const {
  const int root_a = root_of(group_a), root_b = root_of(group_b);
  Joints joints{std::min(root_a, root_b), std::max(root_a, root_b)};
  const auto add = [&](int joint) {
    joints = joints.first == joints.last
                 ? Joints{joint, joint + 1}
                 : Joints{std::min(joints.first, joint), std::max(joints.last, joint + 1)};
  };
  for (int group : {group_a, group_b})
    while (group > static_cast<int>(kDof)) {
      const Follower& follower = followers[static_cast<std::size_t>(group) - kDof - 1];
      add(follower.leader);
      group = follower.parent;
    }
  return joints;
}

int Chain::slide() const {
  for (int k = 0; k < kDof; ++k)
    if (limit[static_cast<std::size_t>(k)].slides) return k;
  return -1;
}

Pose Chain::tool(const Config& q) const {
  return displacements(q)[kDof] * home;
}

Vector3d Chain::tool_point(const Config& cosine, const Config& sine) const {
  Eigen::Vector4d p = home.matrix().col(3);
  for (std::size_t k = kDof; k-- > 0;)
    p = at(turn[k], cosine[static_cast<Eigen::Index>(k)], sine[static_cast<Eigen::Index>(k)])
            .matrix() *
        p;
  return p.head<3>();
}

Eigen::Matrix<double, 6, kDof> Chain::jacobian(const Config& q) const {
  const auto G = displacements(q);
  const Vector3d tool_point = G[kDof] * home.translation();
  Eigen::Matrix<double, 6, kDof> J = Eigen::Matrix<double, 6, kDof>::Zero();
  for (std::size_t k = 0; k < coordinates(); ++k) {
    const Vector3d a = G[k].linear() * axis[k];
    const auto column = static_cast<Eigen::Index>(k);
    if (limit[k].slides) {
      J.col(column) << a, Vector3d::Zero();
      continue;
    }
    J.block<3, 1>(0, column) = a.cross(tool_point - G[k] * point[k]);
    J.block<3, 1>(3, column) = a;
  }
  return J;
}

double Chain::manipulability(const Config& q) const {
  const auto J = jacobian(q);
  const Eigen::Matrix<double, 6, 6> JJt = J * J.transpose();
  return std::sqrt(std::max(0.0, JJt.determinant()));
}

std::array<double, kDof> joint_weights(const Cost& cost, const Chain& chain) {
  if (cost.weights) return *cost.weights;
  std::array<double, kDof> weights;
  weights.fill(1);
  if (chain.roll) weights.back() = 0;
  return weights;
}

std::vector<std::string> limit_warnings(const Chain& chain) {
  std::vector<std::string> warnings;
  for (std::size_t j = 0; j < kDof; ++j)
    if (chain.limit[j].wide())
      warnings.push_back("joint '" + chain.joint_names[j] +
                         "' has limits over 64 turns apart: it is planned as a continuous joint");
  return warnings;
}

ArmModel build_arm(const RobotModel& robot, const std::string& base_link,
                   const std::string& tip_link, const std::map<std::string, double>& hold,
                   const Pose& tool, const std::optional<Roll>& roll) {
  const int base = require_link(robot, "base_link", base_link);
  const int tip = require_link(robot, "tip_link", tip_link);
  const KinematicPath way = kinematic_path_between(robot, base, tip);
  require_joints_of_one_degree(robot, way, base_link, tip_link);
  const ArmJoints arm = choose_arm_joints(robot, way, base_link, tip_link, hold, roll);
  const std::vector<Lead> leads = leads_of(robot);
  require_tool_moves_once(robot, way, arm.joints, leads, base_link, tip_link);
  const std::vector<double> position = held_positions(robot, hold, arm.joints, leads);

  ArmModel model;
  model.links = place_links(robot, base, position);
  set_chain_joints(robot, way, arm.joints, model);
  group_links(robot, way, arm.joints, leads, model);
  model.held = held_between(robot, way, arm.joints, hold, leads, position);
  Chain& chain = model.chain;
  chain.home = model.links[static_cast<std::size_t>(tip)].pose * tool;
  if (roll && arm.seven)
    chain.free_roll = roll;
  else if (!arm.seven)
    add_roll_joint(robot, roll, chain);
  return model;
}

}  // namespace swivel
