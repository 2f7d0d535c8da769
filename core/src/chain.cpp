// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <set>

#include "swivel/core/arm.hpp"
#include "swivel/core/input_error.hpp"

namespace swivel {

namespace {

/// About the line through p along a.
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

Pose at(const Chain::Turn& turn, double cosine, double sine) {
  return Pose(turn.still + cosine * turn.cosine + sine * turn.sine);
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
  throw InputError(robot.source + ": " + what);
}

/// The way through the tree of links from base to tip: up to the link that both hang from, which may be the base itself, then down.
struct Way {
  std::vector<int> links, joints;  // joint k leads from link k to link k + 1
  std::size_t up = 0;              // so many joints lead from child to parent
};
Way way_between(const RobotModel& robot, int base, int tip) {
  const auto above = [&](int link) {
    std::vector<int> links{link};
    for (int joint; (joint = robot.links[static_cast<std::size_t>(links.back())].parent_joint) >= 0;)
      links.push_back(robot.joints[static_cast<std::size_t>(joint)].parent_link);
    return links;
  };
  std::vector<int> up = above(base), down = above(tip);
  int common = -1;
  for (; !up.empty() && !down.empty() && up.back() == down.back(); up.pop_back(), down.pop_back()) common = up.back();
  if (common < 0)
    fail(robot, "robot.tip_link: '" + robot.links[static_cast<std::size_t>(tip)].name + "' is not joined to base_link '" +
                    robot.links[static_cast<std::size_t>(base)].name + "': allowed are links of one tree");
  Way way;
  way.up = up.size();
  way.links = std::move(up);
  way.links.push_back(common);
  way.links.insert(way.links.end(), down.rbegin(), down.rend());
  for (std::size_t k = 0; k + 1 < way.links.size(); ++k)
    way.joints.push_back(robot.links[static_cast<std::size_t>(way.links[k < way.up ? k : k + 1])].parent_joint);
  return way;
}

int require_link(const RobotModel& robot, const std::string& key, const std::string& name) {
  const int link = robot.find_link(name);
  if (link < 0) fail(robot, key + ": unknown link '" + name + "': allowed are the links of this file");
  return link;
}

/// Mimic joints follow their leaders, which may follow others, in any order. `position` holds that of all other joints.
void place_mimics(const RobotModel& robot, const std::vector<int>& arm, std::vector<double>& position) {
  std::vector<char> known(robot.joints.size());
  for (std::size_t j = 0; j < robot.joints.size(); ++j) known[j] = !robot.joints[j].mimic;
  std::vector<std::size_t> waiting;
  for (std::size_t first = 0; first < robot.joints.size(); ++first) {
    for (std::size_t j = first; !known[j]; j = static_cast<std::size_t>(robot.joints[j].mimic->joint)) {
      if (waiting.size() == robot.joints.size())
        fail(robot, "joint '" + robot.joints[j].name + "' mimics itself: allowed is another");
      waiting.push_back(j);
    }
    for (; !waiting.empty(); waiting.pop_back()) {
      const Joint& joint = robot.joints[waiting.back()];
      if (std::find(arm.begin(), arm.end(), joint.mimic->joint) != arm.end())
        fail(robot, "joint '" + joint.name + "' mimics a joint of the arm: not supported: hold it by removing the mimic element");
      position[waiting.back()] =
          joint.mimic->multiplier * position[static_cast<std::size_t>(joint.mimic->joint)] + joint.mimic->offset;
      known[waiting.back()] = 1;
    }
  }
}

/// Positions of all joints with the arm at 0: given, else 0 or the nearest limit; mimic joints follow.
std::vector<double> held_positions(const RobotModel& robot, const std::map<std::string, double>& hold,
                                   const std::vector<int>& arm) {
  std::vector<double> position(robot.joints.size(), 0.0);
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const Joint& joint = robot.joints[j];
    const bool bounded = joint.type == Joint::Type::kRevolute || joint.type == Joint::Type::kPrismatic;
    if (bounded && std::find(arm.begin(), arm.end(), static_cast<int>(j)) == arm.end())
      position[j] = std::clamp(0.0, joint.lower, joint.upper);
  }
  for (const auto& [name, value] : hold) {
    const int j = robot.find_joint(name);
    if (j < 0) fail(robot, "robot.hold: unknown joint '" + name + "': allowed are the joints of this file");
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    if (!joint.movable()) fail(robot, "robot.hold: joint '" + name + "' is fixed: allowed are movable joints");
    if (joint.mimic) fail(robot, "robot.hold: joint '" + name + "' mimics another: hold that one");
    if (joint.type != Joint::Type::kContinuous && (value < joint.lower - 1e-9 || value > joint.upper + 1e-9))
      fail(robot, "robot.hold: joint '" + name + "' at " + std::to_string(value) + " is outside its limits: allowed is " +
                      std::to_string(joint.lower) + " to " + std::to_string(joint.upper));
    position[static_cast<std::size_t>(j)] = value;
  }
  place_mimics(robot, arm, position);
  return position;
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
    const double angle = q[static_cast<Eigen::Index>(k)];
    G[k + 1] = product(G[k], at(turn[k], std::cos(angle), std::sin(angle)));
  }
}

Pose Chain::tool(const Config& q) const {
  return displacements(q)[kDof] * home;
}

Vector3d Chain::tool_point(const Config& cosine, const Config& sine) const {
  Eigen::Vector4d p = home.matrix().col(3);
  for (std::size_t k = kDof; k-- > 0;)
    p = at(turn[k], cosine[static_cast<Eigen::Index>(k)], sine[static_cast<Eigen::Index>(k)]).matrix() * p;
  return p.head<3>();
}

Eigen::Matrix<double, 6, kDof> Chain::jacobian(const Config& q) const {
  const auto G = displacements(q);
  const Vector3d tool_point = G[kDof] * home.translation();
  Eigen::Matrix<double, 6, kDof> J;
  for (std::size_t k = 0; k < kDof; ++k) {
    const Vector3d a = G[k].linear() * axis[k];
    const auto column = static_cast<Eigen::Index>(k);
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

std::vector<std::string> limit_warnings(const Chain& chain) {
  std::vector<std::string> warnings;
  for (std::size_t j = 0; j < kDof; ++j)
    if (chain.limit[j].wide())
      warnings.push_back("joint '" + chain.joint_names[j] +
                         "' has limits over 64 turns apart: it is planned as a continuous joint");
  return warnings;
}

ArmModel build_arm(const RobotModel& robot, const std::string& base_link, const std::string& tip_link,
                   const std::map<std::string, double>& hold, const Pose& tool, const std::optional<Roll>& roll) {
  const int base = require_link(robot, "robot.base_link", base_link);
  const int tip = require_link(robot, "robot.tip_link", tip_link);
  const Way way = way_between(robot, base, tip);
  std::vector<int> arm;
  for (const int j : way.joints) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    if (joint.movable() && !joint.mimic && hold.count(joint.name) == 0) arm.push_back(j);
  }
  // A seventh joint that turns makes the roll one coordinate more.
  const bool seven = arm.size() >= kDof &&
                     (!roll || robot.joints[static_cast<std::size_t>(arm[arm.size() - kDof])].type != Joint::Type::kPrismatic);
  const std::size_t joints = seven || !roll ? kDof : kDof - 1;
  if (!roll && arm.size() == kDof - 1)
    fail(robot, "robot.tip_link: the arm from '" + base_link + "' to '" + tip_link +
                    "' has six joints: allowed with a tool that may turn about its own z axis: add `roll: free`, or [lower, upper] "
                    "in rad, to `path`");
  if (arm.size() < joints)
    fail(robot, "robot.tip_link: only " + std::to_string(arm.size()) + " movable joints that are not held between '" + base_link +
                    "' and '" + tip_link + "': allowed are at least seven, or six with path.roll");
  arm.erase(arm.begin(), arm.end() - static_cast<std::ptrdiff_t>(joints));
  for (const int j : arm)
    if (robot.joints[static_cast<std::size_t>(j)].type == Joint::Type::kPrismatic)
      fail(robot, "joint '" + robot.joints[static_cast<std::size_t>(j)].name + "' is prismatic: the arm's " +
                      (seven ? "seven" : "six") + " joints must turn");
  const std::vector<double> position = held_positions(robot, hold, arm);

  // Parents come before children only by luck in a file: a link waits, with its children so far, for its parent.
  ArmModel model;
  model.links.resize(robot.links.size());
  std::vector<char> known(robot.links.size(), 0);
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
      const LinkPlacement& parent = model.links[static_cast<std::size_t>(joint.parent_link)];
      LinkPlacement& placement = model.links[static_cast<std::size_t>(waiting.back())];
      placement.pose = parent.pose * joint.origin * joint_motion(joint, position[static_cast<std::size_t>(j)]);
    }
  }
  const Pose root_in_base = model.links[static_cast<std::size_t>(base)].pose.inverse(Eigen::Isometry);
  for (LinkPlacement& placement : model.links) placement.pose = root_in_base * placement.pose;

  // A link moves with the link of the way that it hangs from; what hangs from none, with the one that all of them hang from.
  constexpr int kUnknown = -1;
  for (LinkPlacement& placement : model.links) placement.group = kUnknown;
  int group = 0;
  for (std::size_t k = 0; k < way.links.size(); ++k) {
    group += k > 0 && std::find(arm.begin(), arm.end(), way.joints[k - 1]) != arm.end();
    model.links[static_cast<std::size_t>(way.links[k])].group = group;
  }
  const int above_all = model.links[static_cast<std::size_t>(way.links[way.up])].group;
  for (std::size_t link = 0; link < robot.links.size(); ++link) {
    auto from = link;
    int j = 0;
    while (model.links[from].group == kUnknown && (j = robot.links[from].parent_joint) >= 0)
      from = static_cast<std::size_t>(robot.joints[static_cast<std::size_t>(j)].parent_link);
    model.links[link].group = model.links[from].group == kUnknown ? above_all : model.links[from].group;
  }

  Chain& chain = model.chain;
  for (std::size_t k = 0; k < joints; ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(arm[k])];
    const Pose frame = model.links[static_cast<std::size_t>(joint.parent_link)].pose * joint.origin;
    chain.joint_names[k] = joint.name;
    const auto place = static_cast<std::size_t>(std::find(way.joints.begin(), way.joints.end(), arm[k]) - way.joints.begin());
    chain.axis[k] = (place < way.up ? -1.0 : 1.0) * (frame.linear() * joint.axis).normalized();
    chain.point[k] = frame.translation();
    chain.turn[k] = turn_about(chain.axis[k], chain.point[k]);
    chain.limit[k] = {joint.lower,        joint.upper, joint.velocity, joint.type == Joint::Type::kContinuous,
                      joint.acceleration, joint.jerk};
  }
  chain.home = model.links[static_cast<std::size_t>(tip)].pose * tool;
  if (roll && seven) {
    chain.free_roll = roll;
  } else if (roll) {
    // X_6(q) Rot(z, -roll) is the waypoint where X_6 has turned the tool by the roll.
    chain.roll = true;
    chain.joint_names.back() = robot.find_joint("roll") < 0 ? "roll" : "tool_roll";
    chain.axis.back() = -chain.home.linear().col(2);
    chain.point.back() = chain.home.translation();
    chain.turn.back() = turn_about(chain.axis.back(), chain.point.back());
    chain.limit.back() = {roll->lower, roll->upper, 0, roll->circle()};
  }
  return model;
}

}  // namespace swivel
