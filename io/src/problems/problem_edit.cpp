// SPDX-License-Identifier: BSD-3-Clause
#include <yaml-cpp/yaml.h>

#include <map>
#include <string>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "schema/schema.hpp"
#include "schema/yaml_edit.hpp"
#include "swivel/core/study/placement.hpp"
#include "swivel/io/problems/problem.hpp"

namespace swivel::io {

namespace {

YAML::Node list_of(const Vector3d& v) {
  YAML::Node list;
  for (const double number : v) list.push_back(csv_number(number));
  return list;
}

/// States the pose `after` in an object of the scene that states `before`.
void state_pose(YAML::Node object, const Pose& before, const Pose& after) {
  if (before.translation() != after.translation()) object["xyz"] = list_of(after.translation());
  if (before.linear() == after.linear()) return;
  object.remove("quat");
  object["rpy"] = list_of(written_rpy(after.linear()));
}

}  // namespace

std::string with_poses(const std::string& text, const PathProblem& problem,
                       const PathProblem& placed) {
  if (placed.waypoints != problem.waypoints)
    bad_input(
        problem.source, "the path has moved, and the file has no pose of it but its waypoints'",
        "an object of the scene, or the robot's base before a path in the frame of an object");
  const YAML::Node root = YAML::Load(text);
  YAML::Node wanted = YAML::Clone(root);
  // The scene of a file may have bodies that are fixed to links besides.
  std::map<std::string, std::size_t> numbers;
  for (std::size_t k = 0; k < problem.scene.size(); ++k) numbers[problem.scene[k].name] = k;
  for (YAML::Node object : wanted["scene"])
    if (const auto k = numbers.find(object["name"].Scalar()); k != numbers.end())
      state_pose(object, problem.scene[k->second].pose, placed.scene[k->second].pose);
  for (const auto& [joint, position] : placed.hold)
    if (const auto was = problem.hold.find(joint);
        was == problem.hold.end() || was->second != position)
      wanted["robot"]["hold"][joint] = csv_number(position);
  const std::string result = changed_text(text, problem.source, root, wanted, problem_schema());
  if (!says(result, wanted))
    bad_input(at_line(problem.source, root["scene"].Mark().line + 1),
              "the poses of the scene cannot be changed in place",
              "poses of plain numbers without anchors and aliases");
  return result;
}

}  // namespace swivel::io
