// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "swivel/report/lattice_map.hpp"

namespace swivel::detail {

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
  /// Returns the states that were seen, each with its meaning, the most important first.
  [[nodiscard]] std::vector<std::pair<LatticeMap::Node, std::string>> entries() const {
    std::vector<std::pair<LatticeMap::Node, std::string>> result;
    for (const auto& [state, cause, proved] : seen_) {
      const LatticeMap::Node node{static_cast<NodeState>(-state), cause, proved};
      result.emplace_back(node, meaning(node));
    }
    return result;
  }
  [[nodiscard]] std::string path_meaning() const {
    return static_cast<int>(map_.path.size()) == map_.layers
               ? "the path"
               : "a path to the furthest layer that any reaches";
  }

 private:
  [[nodiscard]] std::string meaning(const LatticeMap::Node& node) const {
    switch (node.state) {
      case NodeState::kNoIk:
        return map_.emptiness();
      case NodeState::kSingular:
        return "singular";
      case NodeState::kJointLimit:
        return "limit of " + map_.joint_names[node.cause];
      case NodeState::kNotLookedAt:
        return "not looked at: its clearance did not matter";
      case NodeState::kFree:
        return node.proved ? "free, proved by a certificate" : "free, found by FCL";
      case NodeState::kBlocked:
        return "blocked by " + map_.blocker_name(node);
    }
    return "?";
  }

  const LatticeMap& map_;
  std::set<std::tuple<int, std::uint8_t, bool>>
      seen_;  // minus the state, cause, proved (of free ones)
};

}  // namespace swivel::detail
