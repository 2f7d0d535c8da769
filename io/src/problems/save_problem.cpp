// SPDX-License-Identifier: BSD-3-Clause
// Writes problem files: changes of the file that a problem was loaded from, or whole ones.
#include <yaml-cpp/yaml.h>

#include <functional>
#include <map>
#include <set>

#include "files/bad_input.hpp"
#include "files/files.hpp"
#include "problems/problem_difference.hpp"
#include "problems/problem_reader.hpp"
#include "problems/problem_values.hpp"
#include "schema/yaml_edit.hpp"
#include "schema/yaml_text.hpp"
#include "schema/yaml_value.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/io/files/files.hpp"
#include "swivel/io/problems/problem.hpp"

namespace swivel::io {

namespace fs = std::filesystem;

namespace {

void read_text(const std::string& text, const fs::path& file, PathProblem& problem) {
  problem = ProblemReader(file, parse_yaml(text, file.string(), problem_schema()).section()).read();
}
void read_text(const std::string& text, const fs::path& file, Problem& job) {
  job = read_job(file, parse_yaml(text, file.string(), problem_schema()).section());
}

/// Calls `visit` with every value of a problem file that is the name of a file or folder, and the
/// words for it.
void for_each_name(YAML::Node root,
                   const std::function<void(const std::string& key, YAML::Node value)>& visit) {
  const auto value = [&](const YAML::Node& section, const char* key, const std::string& words) {
    if (!section.IsMap()) return;
    const YAML::Node named = section[key];
    if (named.IsDefined() && named.IsScalar()) visit(words + key, named);
  };
  const auto meshes = [&](const YAML::Node& bodies, const std::string& words) {
    if (bodies.IsDefined() && bodies.IsSequence())
      for (const YAML::Node& body : bodies) value(body, "mesh", words);
  };
  const YAML::Node& all = root;
  const YAML::Node robot = all["robot"];
  value(robot, "urdf", "robot.");
  value(robot, "srdf", "robot.");
  if (const YAML::Node packages = robot["packages"]; packages.IsDefined() && packages.IsMap())
    for (const auto& package : packages)
      visit("robot.packages." + package.first.Scalar(), package.second);
  meshes(robot["attached"], "robot.attached.");
  if (const YAML::Node path = all["path"]; path.IsDefined()) value(path, "file", "path.");
  if (const YAML::Node strokes = all["strokes"]; strokes.IsDefined() && strokes.IsSequence())
    for (const YAML::Node& stroke : strokes) value(stroke["path"], "file", "strokes.path.");
  meshes(all["scene"], "scene.");
  if (const YAML::Node limits = all["limits"]; limits.IsDefined()) value(limits, "file", "limits.");
}

/// Returns a text of a file in the folder `from` for a file in the folder `to`: relative names of
/// files mean the same files.
std::string moved_text(const std::string& text, const std::string& source, const fs::path& from,
                       const fs::path& to) {
  if (canonical_folder(from) == canonical_folder(to)) return text;
  const YAML::Node root = YAML::Load(text);
  const YAML::Node moved = YAML::Clone(root);
  for_each_name(moved, [&](const std::string&, YAML::Node value) {
    if (fs::path(value.Scalar()).is_relative()) value = name_seen_from(to, from / value.Scalar());
  });
  return changed_text(text, source, root, moved, problem_schema());
}

/// Returns the names of the bodies in the scene of a file that are fixed to a link or not, in their
/// order.
std::vector<std::string> names_in_scene(const YAML::Node& root) {
  std::vector<std::string> names;
  const YAML::Node scene = root["scene"];
  if (scene.IsDefined() && scene.IsSequence())
    for (const YAML::Node& body : scene)
      if (body.IsMap() && body["name"].IsDefined()) names.push_back(body["name"].Scalar());
  return names;
}

/// Returns the names of the strokes of a file that have a key.
std::set<std::string> strokes_with(const YAML::Node& root, const char* key) {
  std::set<std::string> names;
  if (const YAML::Node strokes = root["strokes"]; strokes.IsDefined() && strokes.IsSequence())
    for (const YAML::Node& stroke : strokes)
      if (static_cast<const YAML::Node&>(stroke)[key].IsDefined())
        names.insert(stroke["name"].Scalar());
  return names;
}

/// Returns all keys of a problem, in the way in which the file `root` states them.
YAML::Node values_of(const PathProblem& problem, const fs::path& folder, const YAML::Node& root,
                     const std::string& file) {
  return problem_values(problem, folder, names_in_scene(root), file);
}
YAML::Node values_of(const Problem& job, const fs::path& folder, const YAML::Node& root,
                     const std::string& file) {
  const JobLayout layout{root["path"].IsDefined(), names_in_scene(root),
                         strokes_with(root, "approach"), strokes_with(root, "retract")};
  return job_values(job, folder, layout, file);
}

/// Takes the roll out of the path of `was` where the file does not state it: a file of axes alone
/// frees it, and waypoints in its place do not.
void forget_given_roll(YAML::Node was, const YAML::Node& is, const YAML::Node& in_file) {
  const YAML::Node& before = was;
  if (!same_values(before["waypoints"], is["waypoints"]) && !in_file["roll"].IsDefined())
    was.remove("roll");
}
std::map<std::string, YAML::Node> by_name(const YAML::Node& strokes) {
  std::map<std::string, YAML::Node> all;
  for (const YAML::Node& stroke : strokes) all.emplace(stroke["name"].Scalar(), stroke);
  return all;
}
void forget_given_rolls(YAML::Node was, const YAML::Node& is, const YAML::Node& root) {
  if (root["path"].IsDefined()) return forget_given_roll(was["path"], is["path"], root["path"]);
  const auto now = by_name(is["strokes"]), in_file = by_name(root["strokes"]);
  for (auto& [name, stroke] : by_name(was["strokes"]))
    if (const auto found = now.find(name); found != now.end())
      forget_given_roll(YAML::Node(stroke)["path"], found->second["path"],
                        in_file.at(name)["path"]);
}

/// Returns the text of the file that a problem was loaded from, with what has changed since.
template <class Subject>
std::string changed_file(const Subject& subject, const std::string& text, const fs::path& source) {
  Subject before;
  read_text(text, source, before);
  const YAML::Node root = YAML::Load(text);
  const fs::path folder = source.parent_path();
  const YAML::Node was = values_of(before, folder, root, source.string()),
                   is = values_of(subject, folder, root, source.string());
  forget_given_rolls(was, is, root);
  return changed_text(text, source.string(), was, is, problem_schema());
}

/// Returns the robot of the one arm of a problem.
const Robot& robot_of(const PathProblem& problem) {
  return problem;
}
const Robot& robot_of(const Problem& problem) {
  return problem.arm();
}

template <class Subject>
std::string text_of(const Subject& subject, const fs::path& file) {
  const fs::path folder = file.parent_path();
  if (subject.source.empty())
    return document_text(
        without_defaults(values_of(subject, folder, YAML::Node(YAML::NodeType::Map), file.string()),
                         robot_of(subject)));
  const fs::path source = subject.source;
  const std::string text =
      read_file(source, "problem file, from which the problem was loaded", kMostYamlBytes);
  return moved_text(changed_file(subject, text, source), source.string(), source.parent_path(),
                    folder);
}

/// Throws InputError if a problem file would replace a file that it names.
void require_none_of_its_files(const std::string& text, const fs::path& file) {
  for_each_name(YAML::Load(text), [&](const std::string& key, const YAML::Node& value) {
    std::error_code error;
    if (fs::equivalent(file.parent_path() / value.Scalar(), file, error) && !error)
      bad_input(file.string(), "is the file that " + key + " names", "a file of its own");
  });
}

/// Sets the seventh numbers of limits and cost as files are read that have six.
void settle(Limits& limits) {
  for (auto* const rates : {&limits.joint_speed, &limits.joint_acceleration, &limits.joint_jerk})
    if (*rates) (*rates)->back() = (**rates)[kDof - 2];
}
void settle(Task& task) {
  settle(task.limits);
  if (task.cost.weights) task.cost.weights->back() = 0;
}
void settle(PathProblem& problem) {
  settle(static_cast<Task&>(problem));
}
void settle(Problem& job) {
  settle(job.arm().transition_limits);
  for (Stroke& stroke : job.arm().strokes) settle(static_cast<Task&>(stroke));
}

/// Returns the text of a problem file once it is proved to give what it is to give.
template <class Subject>
std::string proved_text(const Subject& subject, const fs::path& file) {
  validate(subject);
  std::string text = text_of(subject, file);
  require_none_of_its_files(text, file);
  const std::string where = file.string();
  Subject written;
  try {
    read_text(text, file, written);
  } catch (const InputError& error) {
    throw InputError(where + ": cannot be written: it would be refused: " + error.what());
  }
  Subject same = subject;
  if (coordinates_of(robot_of(subject)) < kDof) settle(same);
  if (const std::string differs = difference(same, written); !differs.empty())
    bad_input(where, "cannot be written: a file would not give the same " + differs,
              "what docs/formats.md has, from files that are as they were when they were loaded");
  return text;
}

}  // namespace

std::string problem_text(const PathProblem& problem, const fs::path& file) {
  return proved_text(problem, file);
}
std::string problem_text(const Problem& problem, const fs::path& file) {
  if (problem.arms.size() == 2)
    throw InvalidArgument("arms: a problem of two arms: allowed to be written are those of one");
  return is_path(problem) ? problem_text(problem_of_run(problem, {0, false}), file)
                          : proved_text(problem, file);
}

void save_problem(const PathProblem& problem, const fs::path& file) {
  write_file(file, problem_text(problem, file));
}
void save_problem(const Problem& problem, const fs::path& file) {
  write_file(file, problem_text(problem, file));
}

}  // namespace swivel::io
