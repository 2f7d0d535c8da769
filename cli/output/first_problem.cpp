// SPDX-License-Identifier: BSD-3-Clause
#include "output/first_problem.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string_view>

#include "swivel/core/messages/formatted.hpp"

namespace swivel::cli {

namespace {

/// Returns a word as YAML reads it back as text: in double quotes unless it is plainly a name.
std::string yaml_text(const std::string& word) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("_-./").find(static_cast<char>(c)) != std::string_view::npos;
  };
  static constexpr std::string_view kReserved[] = {"true", "false", "null",  "yes",  "no", "on",
                                                   "off",  "True",  "False", "Null", "y",  "n"};
  const bool is_name = !word.empty() && std::ranges::all_of(word, plain) &&
                       (std::isalpha(static_cast<unsigned char>(word.front())) != 0 ||
                        word.front() == '_' || word.front() == '/' || word.starts_with("../")) &&
                       std::ranges::find(kReserved, word) == std::end(kReserved);
  if (is_name) return word;
  std::string text = "\"";
  for (const char c : word) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + '"';
}

/// Returns the name of a file as seen from the folder that another file is in.
std::string seen_from(const std::filesystem::path& name, const std::filesystem::path& file) {
  const std::filesystem::path folder =
      file == "-" ? std::filesystem::current_path() : std::filesystem::absolute(file).parent_path();
  const std::filesystem::path seen =
      std::filesystem::absolute(name).lexically_normal().lexically_relative(
          folder.lexically_normal());
  return yaml_text((seen.empty() ? std::filesystem::absolute(name) : seen).string());
}

/// Returns "[a, b, c]" of numbers.
template <class Numbers>
std::string list(const Numbers& numbers) {
  std::string text = "[";
  for (const double number : numbers)
    text += (text.size() > 1 ? ", " : "") + formatted("%.9g", number + 0.0);
  return text + "]";
}

/// Returns the section `robot` of the problem file.
std::string robot_section(const RobotFiles& files, const Robot& robot, const ArmModel& arm,
                          const std::filesystem::path& file) {
  std::string text = "robot:\n  urdf: " + seen_from(files.urdf, file) + '\n';
  if (!files.srdf.empty()) text += "  srdf: " + seen_from(files.srdf, file) + '\n';
  if (!files.packages.empty()) {
    text += "  packages:\n";
    for (const auto& [name, folder] : files.packages)
      text += "    " + yaml_text(name) + ": " + seen_from(folder, file) + '\n';
  }
  if (!files.without.empty()) {
    text += "  without:\n";
    for (const std::string& link : files.without) text += "    - " + yaml_text(link) + '\n';
  }
  text += "  base_link: " + yaml_text(robot.base_link) + '\n';
  text += "  tip_link: " + yaml_text(robot.tip_link) + '\n';
  std::map<std::string, double> hold = robot.hold;
  for (const HeldJoint& held : arm.held)
    if (held.leader.empty()) hold.try_emplace(held.name, held.position);
  if (!hold.empty()) {
    text += "  # Joints outside the arm stand still here, rad or m.\n  hold:\n";
    for (const auto& [name, position] : hold)
      text += "    " + yaml_text(name) + ": " + formatted("%.9g", position) + '\n';
  }
  return text +
         "  # The tool frame in tip_link: its z axis points out of the tool, towards the work.\n"
         "  tool: {xyz: [0, 0, 0], rpy: [0, 0, 0]}\n"
         "  # Bodies that the arm carries, such as:\n"
         "  # attached:\n"
         "  #   - {name: grinder, cylinder: {radius: 0.03, length: 0.2}, xyz: [0, 0, 0.1]}\n";
}

/// Returns the section `path`.
std::string path_section(const Robot& robot, const std::vector<Waypoint>& waypoints) {
  std::string text =
      "path:\n  # A first path that the arm can follow: positions of the tool frame, m, in\n"
      "  # base_link, and orientations as quaternions w, x, y, z. Or a table: `file: path.csv`.\n";
  if (robot.roll)
    text +=
        "  # The tool may turn about its own z axis. Without this line it stands as the waypoints "
        "have it.\n  roll: free\n";
  text += "  waypoints:\n";
  for (const Waypoint& waypoint : waypoints) {
    const Quaterniond& q = waypoint.orientation;
    const double quaternion[] = {q.w(), q.x(), q.y(), q.z()};
    text += "    - {xyz: " + list(waypoint.position) + ", quat: " + list(quaternion) + "}\n";
  }
  return text;
}

/// Returns the section `limits`.
std::string limits_section(const Robot& robot, const Chain& chain) {
  std::string text =
      "limits:\n  clearance: 0.005   # m, kept between the arm and everything around it\n"
      "  # joint_margin: 0.02   # rad, kept from the limits of each joint\n"
      "  # Ranges narrower than the URDF's, rad" +
      std::string(chain.slide() >= 0 ? " or m" : "") + ":\n  # joints:\n";
  for (std::size_t j = 0; j < kDof - (robot.roll ? 1U : 0U); ++j) {
    const JointLimit& limit = chain.limit[j];
    text += "  #   " + yaml_text(chain.joint_names[j]) + ": " +
            (limit.continuous ? std::string("[-3.14, 3.14]   # continuous\n")
                              : "[" + formatted("%.6g", limit.lower) + ", " +
                                    formatted("%.6g", limit.upper) + "]\n");
  }
  return text;
}

}  // namespace

std::string first_problem(const RobotFiles& files, const Robot& robot, const ArmModel& arm,
                          const std::vector<Waypoint>& waypoints,
                          const std::filesystem::path& file) {
  return "# A problem to begin with, written by `swivel info --write`. All keys: `swivel schema "
         "problem`.\n" +
         robot_section(files, robot, arm, file) + path_section(robot, waypoints) +
         "# What stands around, such as:\n# scene:\n"
         "#   - {name: table, box: [1, 1, 0.05], xyz: [0.6, 0, -0.1]}\n" +
         limits_section(robot, arm.chain);
}

}  // namespace swivel::cli
