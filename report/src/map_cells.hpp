// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "palette.hpp"
#include "swivel/report/lattice_map.hpp"

namespace swivel::detail {

/// Returns the colour of a node, "#rrggbb": one hue for each object that blocks.
[[nodiscard]] inline std::string colour_of_node(const LatticeMap& map,
                                                const LatticeMap::Node& node) {
  switch (node.state) {
    case NodeState::kNoIk:
      return palette::kNothing;
    case NodeState::kSingular:
      return palette::kSingular;
    case NodeState::kJointLimit:
      return palette::kLimit;
    case NodeState::kNotLookedAt:
      return palette::kUnseen;
    case NodeState::kFree:
      return node.proved ? palette::kProved : palette::kFound;
    case NodeState::kBlocked: {
      const int object = map.blocking_object(node);
      return object < 0
                 ? palette::kSelf
                 : palette::kObjects[static_cast<std::size_t>(object) % palette::kObjects.size()];
    }
  }
  return palette::kNothing;
}

/// Divides a panel into cells, each standing for layers_each x angles_each nodes (fewer at the
/// ends).
class MapCells {
 public:
  MapCells(const LatticeMap& map, int most_columns, int most_rows)
      : map_(map),
        layers_each((map.layers + most_columns - 1) / most_columns),
        angles_each((map.angles + most_rows - 1) / most_rows),
        columns((map.layers + layers_each - 1) / layers_each),
        rows((map.angles + angles_each - 1) / angles_each) {}

  /// Returns the most important node of a cell. Row 0 holds the least arm angles.
  [[nodiscard]] LatticeMap::Node node(int solution, int column, int row) const {
    LatticeMap::Node most = map_.at(column * layers_each, solution, row * angles_each);
    for (int i = column * layers_each; i < std::min(map_.layers, (column + 1) * layers_each); ++i)
      for (int j = row * angles_each; j < std::min(map_.angles, (row + 1) * angles_each); ++j)
        if (const LatticeMap::Node& node = map_.at(i, solution, j);
            importance(node) > importance(most))
          most = node;
    return most;
  }
  [[nodiscard]] bool on_path(int solution, int column, int row) const {
    const std::vector<int>& path = map_.path_in(solution);
    const int end = std::min(static_cast<int>(path.size()), (column + 1) * layers_each);
    for (int i = column * layers_each; i < end; ++i) {
      const int slot = path[i];
      if (slot / map_.angles == solution && slot % map_.angles / angles_each == row) return true;
    }
    return false;
  }

 private:
  /// Orders nodes by their state; among nodes of one state, one that FCL had to judge is more
  /// important than one that a distance proof proves.
  static std::pair<NodeState, bool> importance(const LatticeMap::Node& node) {
    return {node.state, !node.proved};
  }

  const LatticeMap& map_;

 public:
  int layers_each, angles_each, columns, rows;
};

/// The states that a drawing shows, each with its meaning.
class MapLegend {
 public:
  explicit MapLegend(const LatticeMap& map) : map_(map) {}
  void see(const LatticeMap::Node& node) {
    seen_.insert(
        {-static_cast<int>(node.state), node.cause, node.state == NodeState::kFree && node.proved});
  }
  /// Nodes of one colour: what they have in common, and the joints or bodies that tell them apart.
  struct Group {
    LatticeMap::Node node;
    std::string meaning;
    std::vector<std::string> details;
    /// Returns the group in words, with its details where there are several, or where it is that of
    /// limits.
    [[nodiscard]] std::string words() const {
      constexpr std::size_t kMost = 4;
      if (details.empty() || (details.size() == 1 && node.state != NodeState::kJointLimit))
        return meaning;
      std::string text = meaning;
      for (std::size_t k = 0; k < std::min(kMost, details.size()); ++k)
        text += (k == 0 ? ": " : ", ") + details[k];
      return details.size() > kMost ? text + ", " + std::to_string(details.size() - kMost) + " more"
                                    : text;
    }
  };
  /// Returns the groups that were seen, the most important first.
  [[nodiscard]] std::vector<Group> groups() const {
    std::vector<Group> groups;
    for (const auto& [node, text] : entries()) {
      const std::string common = meaning(node), own = detail(node);
      auto at = std::find_if(groups.begin(), groups.end(),
                             [&](const Group& group) { return group.meaning == common; });
      if (at == groups.end()) at = groups.insert(at, {node, common, {}});
      std::vector<std::string>& details = at->details;
      if (!own.empty() && std::find(details.begin(), details.end(), own) == details.end())
        details.insert(std::lower_bound(details.begin(), details.end(), own), own);
    }
    return groups;
  }
  /// Returns the states and causes that were seen, each in words, the most important first.
  [[nodiscard]] std::vector<std::pair<LatticeMap::Node, std::string>> entries() const {
    std::vector<std::pair<LatticeMap::Node, std::string>> result;
    for (const auto& [state, cause, proved] : seen_) {
      const LatticeMap::Node node{static_cast<NodeState>(-state), cause, proved};
      const std::string own = detail(node);
      result.emplace_back(node, own.empty() ? meaning(node) : meaning(node) + ": " + own);
    }
    return result;
  }
  [[nodiscard]] std::string path_meaning() const {
    return static_cast<int>(map_.path.size()) == map_.layers
               ? "the path"
               : "a path to the furthest layer that any reaches";
  }

 private:
  /// Returns what nodes of one colour have in common.
  [[nodiscard]] std::string meaning(const LatticeMap::Node& node) const {
    switch (node.state) {
      case NodeState::kNoIk:
        return map_.emptiness();
      case NodeState::kSingular:
        return "singular";
      case NodeState::kJointLimit:
        return "joint limit";
      case NodeState::kNotLookedAt:
        return "not looked at";
      case NodeState::kFree:
        return node.proved ? "free, proved by a certificate" : "free, found by FCL";
      case NodeState::kBlocked: {
        const int object = map_.blocking_object(node);
        return "blocked by " + (object < 0 ? std::string("the robot itself")
                                           : map_.objects[static_cast<std::size_t>(object)]);
      }
    }
    return "?";
  }
  /// Returns what tells nodes of one colour apart: the joint, or the body that is blocked.
  [[nodiscard]] std::string detail(const LatticeMap::Node& node) const {
    if (node.state == NodeState::kJointLimit) return map_.joint_names[node.cause];
    if (node.state != NodeState::kBlocked) return "";
    const auto& [a, b] = map_.blockers[node.cause];
    const int object = map_.blocking_object(node);
    if (object < 0) return a + " - " + b;
    return a == map_.objects[static_cast<std::size_t>(object)] ? b : a;
  }

  const LatticeMap& map_;
  std::set<std::tuple<int, std::uint8_t, bool>>
      seen_;  // minus the state, cause, proved (of free ones)
};

}  // namespace swivel::detail
