// SPDX-License-Identifier: BSD-3-Clause
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "swivel/core/base/rpy.hpp"
#include "swivel/core/study/placement.hpp"
#include "swivel/io/problems/problem.hpp"

namespace swivel::io {

namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
const char* const kAllowed =
    "a pose written with xyz: [x, y, z] and rpy: [roll, pitch, yaw], and hold: {JOINT: position}, "
    "of plain numbers without anchors or aliases";

std::string list(const Vector3d& v) {
  return "[" + csv_number(v.x()) + ", " + csv_number(v.y()) + ", " + csv_number(v.z()) + "]";
}

/// Collects replacements in a YAML text, by their places.
class TextEdits {
 public:
  TextEdits(std::string text, std::string source)
      : text_(std::move(text)), source_(std::move(source)) {}

  void vector(const YAML::Node& object, const char* key, const Vector3d& value) {
    const YAML::Node node = object[key];
    if (!node) return insert(object, std::string(key) + ": " + list(value));
    if (!node.IsSequence() || node.size() != 3) fail(object, key);
    for (std::size_t k = 0; k < 3; ++k)
      word(node[k], csv_number(value[static_cast<Eigen::Index>(k)]), key);
  }
  /// Sets positions of joints under `hold` of the section `robot`.
  void hold(const YAML::Node& robot, const std::map<std::string, double>& positions) {
    const YAML::Node node = robot["hold"];
    if (node && !node.IsMap()) fail(robot, "hold");
    std::string more;
    for (const auto& [joint, position] : positions) {
      if (node && node[joint])
        word(node[joint], csv_number(position), "hold");
      else
        more += (more.empty() ? "" : ", ") + quoted(joint) + ": " + csv_number(position);
    }
    if (more.empty()) return;
    if (!node)
      insert(robot, "hold: {" + more + "}");
    else if (node.size() > 0)
      insert(node, more);
    else
      fail(robot, "hold");
  }
  /// Replaces quat: [...] by rpy: [...].
  void quaternion(const YAML::Node& object, const Vector3d& rpy) {
    const YAML::Node node = object["quat"];
    const std::size_t begin = place(node), end = text_.find(']', begin) + 1;
    const bool plain =
        node.Style() == YAML::EmitterStyle::Flow && text_[begin] == '[' && end != 0 &&
        text_.substr(begin, end - begin).find_first_of("#&*\"'") == std::string::npos;
    if (!plain) fail(node, "quat");
    for (const auto& entry : object)
      if (entry.first.Scalar() == "quat") word(entry.first, "rpy", "quat");
    edits_.push_back({begin, end - begin, list(rpy)});
  }
  [[nodiscard]] std::string text() {
    // From the end on; of two edits at one place, the insertion comes last.
    std::sort(edits_.begin(), edits_.end(), [](const Edit& a, const Edit& b) {
      return std::pair(a.at, a.size) > std::pair(b.at, b.size);
    });
    std::string result = text_;
    for (const Edit& edit : edits_) result.replace(edit.at, edit.size, edit.text);
    return result;
  }
  [[noreturn]] void fail(const YAML::Node& node, const std::string& key) const {
    bad_input(at_line(source_, node.Mark().line + 1), key + ": cannot be changed in place",
              kAllowed);
  }

 private:
  struct Edit {
    std::size_t at, size;
    std::string text;
  };
  [[nodiscard]] std::size_t place(const YAML::Node& node) const {
    const std::size_t begin = text_.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
    const auto at = begin + static_cast<std::size_t>(std::max(0, node.Mark().pos));
    if (at >= text_.size()) fail(node, "it");
    return at;
  }
  void word(const YAML::Node& node, const std::string& text, const char* key) {
    if (!node.IsScalar()) fail(node, key);
    const std::size_t at = place(node), size = node.Scalar().size();
    if (text_.compare(at, size, node.Scalar()) != 0) fail(node, key);
    edits_.push_back({at, size, text});
  }
  /// Returns a key, in quotes where it is not a plain word.
  static std::string quoted(const std::string& key) {
    const bool plain = std::all_of(key.begin(), key.end(), [](unsigned char c) {
      return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '/' || c == '.';
    });
    return plain ? key : YAML::Dump(YAML::Node(key));
  }
  void insert(const YAML::Node& map, const std::string& entry) {
    const std::size_t at = place(map);
    if (text_[at] == '{')
      edits_.push_back({at + 1, 0, entry + ", "});
    else
      edits_.push_back(
          {at, 0, entry + '\n' + std::string(static_cast<std::size_t>(map.Mark().column), ' ')});
  }

  std::string text_, source_;
  std::vector<Edit> edits_;
};

const std::set<std::string> kPoseKeys{"xyz", "rpy", "quat"}, kHoldKey{"hold"};

/// Returns true if two nodes are equal, with keys in the same order, apart from the keys `but` of
/// this map.
bool same(const YAML::Node& a, const YAML::Node& b, const std::set<std::string>& but = {}) {
  if (a.Type() != b.Type()) return false;
  if (a.IsScalar()) return a.Scalar() == b.Scalar();
  if (a.IsSequence()) {
    if (a.size() != b.size()) return false;
    for (std::size_t k = 0; k < a.size(); ++k)
      if (!same(a[k], b[k])) return false;
  }
  if (a.IsMap()) {
    const auto entries = [&](const YAML::Node& node) {
      std::vector<std::pair<YAML::Node, YAML::Node>> kept;
      for (const auto& entry : node)
        if (!but.contains(entry.first.Scalar())) kept.emplace_back(entry.first, entry.second);
      return kept;
    };
    const auto x = entries(a), y = entries(b);
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const auto& p, const auto& q) {
      return same(p.first, q.first) && same(p.second, q.second);
    });
  }
  return true;
}

/// Returns true if two documents are equal, except that the scene objects `moved` may have other
/// poses, and joints may be held elsewhere.
bool same_but_for_placement(const YAML::Node& a, const YAML::Node& b,
                            const std::set<std::size_t>& moved) {
  if (a.size() != b.size()) return false;
  auto other = b.begin();
  for (const auto& entry : a) {
    if (!same(entry.first, other->first)) return false;
    const YAML::Node x = entry.second, y = other->second;
    ++other;
    if (entry.first.Scalar() != "scene") {
      if (!same(x, y, entry.first.Scalar() == "robot" ? kHoldKey : std::set<std::string>{}))
        return false;
      continue;
    }
    if (x.size() != y.size()) return false;
    for (std::size_t k = 0; k < x.size(); ++k)
      if (!same(x[k], y[k], moved.contains(k) ? kPoseKeys : std::set<std::string>{})) return false;
  }
  return true;
}

Vector3d vector_of(const YAML::Node& node) {
  if (!node) return Vector3d::Zero();
  return {node[0].as<double>(), node[1].as<double>(), node[2].as<double>()};
}

bool kept(const YAML::Node& was, const YAML::Node& is, const char* key) {
  return was[key] ? is[key] && same(was[key], is[key]) : !is[key];
}

/// Returns true if `hold` of a section `robot` states these positions.
bool says_hold(const YAML::Node& robot, const std::map<std::string, double>& positions) {
  std::map<std::string, double> said;
  if (robot["hold"])
    for (const auto& entry : robot["hold"]) said[entry.first.Scalar()] = entry.second.as<double>();
  return said == positions;
}

/// Returns true if a text states what `root` does, with the poses of `placed` for the objects that
/// have moved and the positions of its joints that are held.
bool says(const std::string& text, const YAML::Node& root, const Problem& placed,
          const std::set<std::size_t>& moved) {
  try {
    const YAML::Node written = YAML::Load(text);
    return same_but_for_placement(root, written, moved) &&
           says_hold(written["robot"], placed.hold) &&
           std::all_of(moved.begin(), moved.end(), [&](std::size_t k) {
             const YAML::Node was = root["scene"][k], is = written["scene"][k];
             const Pose& pose = placed.scene[k].pose;
             const bool turned =
                 is["rpy"] && rotation_from_rpy(vector_of(is["rpy"])) == pose.linear();
             return vector_of(is["xyz"]) == pose.translation() &&
                    (turned || (kept(was, is, "rpy") && kept(was, is, "quat")));
           });
  } catch (const YAML::Exception&) {
    return false;
  }
}

}  // namespace

std::string with_poses(const std::string& text, const Problem& problem, const Problem& placed) {
  if (placed.waypoints != problem.waypoints)
    bad_input(
        problem.source, "the path has moved, and the file has no pose of it but its waypoints'",
        "an object of the scene, or the robot's base before a path in the frame of an object");
  const YAML::Node root = YAML::Load(text);
  TextEdits edits(text, problem.source);
  std::set<std::size_t> moved;
  for (std::size_t k = 0; k < problem.scene.size(); ++k) {
    const Pose &before = problem.scene[k].pose, &after = placed.scene[k].pose;
    const YAML::Node object = root["scene"][k];
    if (before.translation() != after.translation())
      edits.vector(object, "xyz", after.translation());
    if (before.linear() != after.linear()) {
      if (object["quat"])
        edits.quaternion(object, written_rpy(after.linear()));
      else
        edits.vector(object, "rpy", written_rpy(after.linear()));
    }
    if (before.matrix() != after.matrix()) moved.insert(k);
  }
  std::map<std::string, double> held;
  for (const auto& [joint, position] : placed.hold)
    if (const auto was = problem.hold.find(joint);
        was == problem.hold.end() || was->second != position)
      held[joint] = position;
  edits.hold(root["robot"], held);
  std::string result = edits.text();
  if ((!moved.empty() || !held.empty()) && !says(result, root, placed, moved)) {
    if (moved.empty()) edits.fail(root["robot"], "hold");
    edits.fail(root["scene"][*moved.begin()], "its pose");
  }
  return result;
}

}  // namespace swivel::io
