// SPDX-License-Identifier: BSD-3-Clause
#include "srdf.hpp"

#include <set>
#include <string>

#include "bad_input.hpp"
#include "swivel/core/bounds.hpp"
#include "xml.hpp"

namespace swivel::io {

namespace {

using Pair = std::pair<std::string, std::string>;

constexpr std::size_t kMostPairs = 1'000'000;

std::string attribute(const tinyxml2::XMLElement& element, const char* name, const std::string& file) {
  const char* const value = element.Attribute(name);
  if (value == nullptr || !is_valid_name(value))
    bad_input(at_line(file, element.GetLineNum()),
              std::string("<") + element.Name() + "> without " + name + ", or with a broken one",
              std::string("a link name in every ") + name + ", " + kValidName);
  return value;
}

Pair ordered(std::string a, std::string b) {
  return a < b ? Pair{std::move(a), std::move(b)} : Pair{std::move(b), std::move(a)};
}

}  // namespace

void load_srdf(const XmlSource& srdf, RobotModel& robot) {
  const std::string file = srdf.file.string();
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLElement& root = load_robot_xml(srdf, "SRDF", document);
  const auto for_each = [&](const char* name, const auto& visit) {
    for (auto* e = root.FirstChildElement(name); e != nullptr; e = e->NextSiblingElement(name)) visit(*e);
  };
  const auto pair_of = [&](const tinyxml2::XMLElement& e) {
    return ordered(attribute(e, "link1", file), attribute(e, "link2", file));
  };
  // As MoveIt reads them: defaults first, then pairs enabled again, then pairs disabled.
  std::set<Pair> disabled;
  const auto disable = [&](const Pair& pair, const tinyxml2::XMLElement& e) {
    disabled.insert(pair);
    if (disabled.size() > kMostPairs)
      bad_input(at_line(file, e.GetLineNum()), "disables too many pairs", "at most " + std::to_string(kMostPairs));
  };
  for_each("disable_default_collisions", [&](const auto& e) {
    const std::string link = attribute(e, "link", file);
    for (const Link& other : robot.links)
      if (other.name != link) disable(ordered(link, other.name), e);
  });
  for_each("enable_collisions", [&](const auto& e) { disabled.erase(pair_of(e)); });
  for_each("disable_collisions", [&](const auto& e) { disable(pair_of(e), e); });
  robot.has_srdf = true;
  robot.disabled_pairs.assign(disabled.begin(), disabled.end());
}

}  // namespace swivel::io
