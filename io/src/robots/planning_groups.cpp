// SPDX-License-Identifier: BSD-3-Clause
#include <tinyxml2.h>

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "files/bad_input.hpp"
#include "files/xml.hpp"
#include "robots/joints_to.hpp"
#include "swivel/io/robots/robot.hpp"

namespace swivel::io {

namespace {

/// Collects the joints of groups, by index in the model.
class GroupJoints {
 public:
  GroupJoints(const tinyxml2::XMLElement& root, const RobotModel& robot) : robot_(robot) {
    for (auto* e = root.FirstChildElement("group"); e; e = e->NextSiblingElement("group"))
      if (const char* const name = e->Attribute("name")) groups_.emplace(name, e);
  }
  /// Returns the joints of a group, fixed ones among them. What the robot does not have counts for
  /// nothing, and so does a group that contains itself.
  [[nodiscard]] const std::set<int>& of(const std::string& group, int depth = 0) {
    constexpr int kMostDepth = 100;  // groups within groups
    const auto [found, fresh] = joints_.try_emplace(group);
    if (depth > kMostDepth) bad_input("SRDF text", "groups within groups", "at most 100 levels");
    const auto element = groups_.find(group);
    if (!fresh || element == groups_.end()) return found->second;
    std::set<int> joints;
    for (auto* e = element->second->FirstChildElement(); e; e = e->NextSiblingElement())
      add(*e, depth, joints);
    return joints_[group] = std::move(joints);
  }

 private:
  void add(const tinyxml2::XMLElement& part, int depth, std::set<int>& joints) {
    const std::string_view kind = part.Name();
    const auto named = [&](const char* attribute) {
      const char* const value = part.Attribute(attribute);
      return std::string(value ? value : "");
    };
    if (kind == "joint") {
      if (const int joint = robot_.find_joint(named("name")); joint >= 0) joints.insert(joint);
    } else if (kind == "link") {
      if (const int link = robot_.find_link(named("name")); link >= 0) add_above(link, joints);
    } else if (kind == "group") {
      const std::set<int> inner = of(named("name"), depth + 1);
      joints.insert(inner.begin(), inner.end());
    } else if (kind == "chain") {
      const int base = robot_.find_link(named("base_link"));
      std::set<int> above;
      int link = base < 0 ? -1 : robot_.find_link(named("tip_link"));
      while (link >= 0 && link != base) link = add_above(link, above);
      if (link >= 0) joints.insert(above.begin(), above.end());
    }
  }
  /// Adds the joint that carries a link, if there is one. Returns the link above, -1 at the root.
  int add_above(int link, std::set<int>& joints) const {
    const int joint = robot_.links[static_cast<std::size_t>(link)].parent_joint;
    if (joint < 0) return -1;
    joints.insert(joint);
    return robot_.joints[static_cast<std::size_t>(joint)].parent_link;
  }

  const RobotModel& robot_;
  std::map<std::string, const tinyxml2::XMLElement*> groups_;
  std::map<std::string, std::set<int>> joints_;
};

PlanningGroup group_of(const std::string& name, const std::set<int>& joints,
                       const RobotModel& robot) {
  const auto joint = [&](int k) -> const Joint& {
    return robot.joints[static_cast<std::size_t>(k)];
  };
  PlanningGroup group{name, {}, "", ""};
  std::vector<int> deepest;  // joints from the root to the tip
  for (const int k : joints)
    if (auto way = joints_to(robot, joint(k).child_link); way.size() > deepest.size())
      deepest = std::move(way);
  std::erase_if(deepest, [&](int k) { return !joints.contains(k); });
  if (!joints.empty() && deepest.size() == joints.size()) {
    const auto link = [&](int k) { return robot.links[static_cast<std::size_t>(k)].name; };
    group.base_link = link(joint(deepest.front()).parent_link);
    group.tip_link = link(joint(deepest.back()).child_link);
  } else {
    deepest.assign(joints.begin(), joints.end());
  }
  for (const int k : deepest)
    if (joint(k).movable()) group.joints.push_back(joint(k).name);
  return group;
}

}  // namespace

std::vector<PlanningGroup> planning_groups(const std::string& srdf, const RobotModel& robot) {
  std::vector<PlanningGroup> groups;
  if (srdf.empty()) return groups;
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLElement& root = load_robot_xml(XmlSource{"SRDF text", srdf}, "SRDF", document);
  GroupJoints joints(root, robot);
  for (auto* e = root.FirstChildElement("group"); e; e = e->NextSiblingElement("group"))
    if (const char* const name = e->Attribute("name"))
      groups.push_back(group_of(name, joints.of(name), robot));
  return groups;
}

}  // namespace swivel::io
