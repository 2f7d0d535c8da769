// SPDX-License-Identifier: BSD-3-Clause
#include "robots/srdf.hpp"

#include <set>
#include <string>
#include <string_view>

#include "files/bad_input.hpp"
#include "files/xml.hpp"
#include "robots/xml_words.hpp"
#include "swivel/core/messages/bounds.hpp"

namespace swivel::io {

namespace {

using Pair = std::pair<std::string, std::string>;

constexpr std::size_t kMostPairs = 1'000'000;

/// https://wiki.ros.org/srdf, with what MoveIt 2 (enable_collisions, disable_default_collisions,
/// joint_property) and Tesseract (group_tcps, the configurations of plugins) have besides. What
/// says which pairs are tested refuses what it does not know.
const XmlElement& srdf_format() {
  constexpr auto kWarned = XmlElement::Unknown::kWarnedOf;
  constexpr auto kRefused = XmlElement::Unknown::kRefused;
  const auto many = [](const char* name, std::vector<const char*> attributes,
                       std::vector<XmlElement> children = {}) {
    return XmlElement{name, std::move(attributes), std::move(children), {}, kWarned, true};
  };
  static const XmlElement format{
      "robot",
      {"name", "version"},
      {{"disable_collisions", {"link1", "link2", "reason"}, {}, {}, kRefused, true},
       {"enable_collisions", {"link1", "link2", "reason"}, {}, {}, kRefused, true},
       {"disable_default_collisions", {"link", "reason"}, {}, {}, kRefused, true},
       {"passive_joint", {"name"}, {}, {}, kRefused, true},
       many("group", {"name"},
            {many("link", {"name"}), many("joint", {"name"}),
             many("chain", {"base_link", "tip_link"}), many("group", {"name"})}),
       many("group_state", {"name", "group"}, {many("joint", {"name", "value"})}),
       many("end_effector", {"name", "group", "parent_link", "parent_group"}),
       many("virtual_joint", {"name", "type", "parent_frame", "child_link"}),
       many("joint_property", {"joint_name", "property_name", "value"}),
       many("link_sphere_approximation", {"link"}, {many("sphere", {"center", "radius"})})},
      {"group_tcps", "kinematics_plugin_config", "contact_managers_plugin_config"},
      kWarned};
  return format;
}

/// Warns of a file that is another robot's, by its name: MoveIt refuses it, but users give robots
/// names of their own.
void check_robot_name(const tinyxml2::XMLElement& root, const RobotModel& robot,
                      const std::string& file, XmlWarnings& warnings) {
  constexpr std::size_t kMost = 200;
  const char* const name = root.Attribute("name");
  if (name == nullptr || robot.name == name) return;
  const auto shown = [](std::string_view text) {
    return "'" + printable(text.substr(0, kMost)) + "'";
  };
  warnings.add(at_line(file, root.GetLineNum()), "is of robot " + shown(name) +
                                                     ", and the URDF of " + shown(robot.name) +
                                                     ": are they of one robot?");
}

/// Warns of links and joints that neither the robot nor `others` (left out of it, or virtual) have.
class Names {
 public:
  Names(const RobotModel& robot, std::set<std::string> others, const std::string& file,
        XmlWarnings& warnings)
      : others_(std::move(others)), file_(file), warnings_(warnings) {
    for (const Link& link : robot.links) links_.insert(link.name);
    for (const Joint& joint : robot.joints) joints_.insert(joint.name);
  }
  void check(const tinyxml2::XMLElement& element) const {
    const std::string_view kind = element.Name();
    for (const char* attribute :
         {"link1", "link2", "link", "base_link", "tip_link", "parent_link", "child_link"})
      require(element, attribute, links_, "link");
    require(element, "joint_name", joints_, "joint");
    if (kind == "link") require(element, "name", links_, "link");
    if (kind == "joint" || kind == "passive_joint") require(element, "name", joints_, "joint");
    if (kind != "robot" && kind != "group" && kind != "group_state")
      return;  // what the others hold names nothing
    for (const auto* child = element.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement())
      check(*child);
  }

 private:
  void require(const tinyxml2::XMLElement& element, const char* attribute,
               const std::set<std::string>& known, const char* kind) const {
    const char* const name = element.Attribute(attribute);
    if (name == nullptr || known.contains(name) || others_.contains(name)) return;
    constexpr std::size_t kMost = 200;
    warnings_.add(at_line(file_, element.GetLineNum()),
                  std::string("names ") + kind + " '" +
                      printable(std::string_view(name).substr(0, kMost)) +
                      "', which the robot does not have");
  }

  std::set<std::string> links_, joints_, others_;
  const std::string& file_;
  XmlWarnings& warnings_;
};

std::string attribute(const tinyxml2::XMLElement& element, const char* name,
                      const std::string& file) {
  const char* const value = element.Attribute(name);
  if (value == nullptr || !is_valid_name(value))
    bad_input(at_line(file, element.GetLineNum()),
              std::string("<") + element.Name() + "> without " + name + ", or with a broken one",
              std::string("a name in every ") + name + ", " + kValidName);
  return value;
}

Pair ordered(std::string a, std::string b) {
  return a < b ? Pair{std::move(a), std::move(b)} : Pair{std::move(b), std::move(a)};
}

}  // namespace

void load_srdf(const XmlSource& srdf, RobotModel& robot, const std::set<std::string>& left_out) {
  const std::string file = srdf.file.string();
  if (!srdf.text) robot.files.srdf = std::filesystem::absolute(srdf.file).string();
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLElement& root = load_robot_xml(srdf, "SRDF", document);
  XmlWarnings warnings;
  check_robot_name(root, robot, file, warnings);
  check_words(root, srdf_format(), file, warnings);
  const auto for_each = [&](const char* name, const auto& visit) {
    for (auto* e = root.FirstChildElement(name); e != nullptr; e = e->NextSiblingElement(name))
      visit(*e);
  };
  const auto pair_of = [&](const tinyxml2::XMLElement& e) {
    return ordered(attribute(e, "link1", file), attribute(e, "link2", file));
  };
  // As MoveIt reads them: defaults first, then pairs enabled again, then pairs disabled.
  std::set<Pair> disabled;
  const auto disable = [&](const Pair& pair, const tinyxml2::XMLElement& e) {
    disabled.insert(pair);
    if (disabled.size() > kMostPairs)
      bad_input(at_line(file, e.GetLineNum()), "disables too many pairs",
                "at most " + std::to_string(kMostPairs));
  };
  for_each("disable_default_collisions", [&](const auto& e) {
    const std::string link = attribute(e, "link", file);
    for (const Link& other : robot.links)
      if (other.name != link) disable(ordered(link, other.name), e);
  });
  for_each("enable_collisions", [&](const auto& e) { disabled.erase(pair_of(e)); });
  for_each("disable_collisions", [&](const auto& e) { disable(pair_of(e), e); });
  for_each("passive_joint", [&](const auto& e) {
    if (const int joint = robot.find_joint(attribute(e, "name", file)); joint >= 0)
      robot.joints[static_cast<std::size_t>(joint)].passive = true;
  });
  std::set<std::string> others = left_out;
  for_each("virtual_joint", [&](const auto& e) {
    if (const char* const name = e.Attribute("name")) others.insert(name);
  });
  Names(robot, std::move(others), file, warnings).check(root);
  for (std::string& warning : warnings.list()) robot.warnings.push_back(std::move(warning));
  robot.has_srdf = true;
  robot.disabled_pairs.assign(disabled.begin(), disabled.end());
}

}  // namespace swivel::io
