// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis.hpp"

#include <algorithm>
#include <bit>
#include "swivel/core/timeline.hpp"

namespace swivel {

namespace {

using Reasons = std::map<std::string, std::int64_t>;

std::string most_frequent(const Reasons& reasons) {
  const auto most =
      std::max_element(reasons.begin(), reasons.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == reasons.end() ? "" : most->first;
}

class Inspector {
 public:
  Inspector(const Lattice& lattice, const World& world, const EdgeRule& rule)
      : lattice_(lattice), world_(world), query_(world, Certificates::kOn), rule_(rule) {}

  /// Empty string where the node is valid.
  std::string node_reason(const Config& q) {
    if (!lattice_.manipulable(q)) return "manipulability";
    const auto pair = query_.first_below(q, lattice_.limits().clearance);
    return pair ? name(*pair) : "";
  }

  std::string edge_reason(int layer, int a, const Config& qa, int b, const Config& qb) {
    const Config delta = lattice_.delta(qa, qb);
    if (!lattice_.step_allowed(layer, delta)) return "joint step";
    if (!lattice_.follows_path(layer, a, qa, b, qb)) return "tool-path error";
    if (lattice_.limits().edges == EdgeMode::kContinuous) {
      const auto pair = edge_blocked(query_, rule_, qa, qa + delta);
      if (pair) return name(*pair) + " between layers";
    }
    return "";
  }

  /// Reasons why no node of the layer is valid, by count; empty when one is. Starts at `hint`, a slot valid in a neighbouring
  /// layer.
  Reasons why_empty(int layer, int& hint) {
    lattice_.solve(layer, nodes_);
    Reasons reasons;
    const int width = lattice_.width();
    for (int k = 0; k < width; ++k) {
      const int slot = (hint + k) % width;
      if (!nodes_.valid(lattice_.label_of(slot), lattice_.angle_of(slot))) continue;
      const std::string reason = node_reason(nodes_.config(lattice_.label_of(slot), lattice_.angle_of(slot)));
      if (reason.empty()) {
        hint = slot;
        return {};
      }
      ++reasons[reason];
    }
    if (reasons.empty()) reasons[kinematic_reason(layer)] = width;
    return reasons;
  }

  /// What every node of the layer fails, or the joint whose release alone would help.
  std::string kinematic_reason(int layer) const {
    Reasons released, statuses;
    for (int slot = 0; slot < lattice_.width(); ++slot) {
      const Lattice::NodeFault fault = lattice_.fault(layer, slot);
      if (fault.status == NodeStatus::kLimit && std::popcount(fault.joints) == 1)
        ++released[joint_name(std::countr_zero(fault.joints))];
      ++statuses[status_name(fault)];
    }
    if (!released.empty()) return most_frequent(released);
    for (const char* status : {"joint limits", "singular", "no IK"})
      if (statuses.contains(status)) return status;
    return "no IK";
  }

  /// What removed every node of the layer and the edges into those that are left.
  Reasons removed_past(int layer) {
    Reasons reasons;
    LayerNodes before;
    lattice_.solve(layer, before);
    lattice_.solve(layer + 1, nodes_);
    std::vector<int> left;
    for (int slot = 0; slot < lattice_.width(); ++slot) {
      const int label = lattice_.label_of(slot), j = lattice_.angle_of(slot);
      if (!nodes_.valid(label, j)) {
        const Lattice::NodeFault fault = lattice_.fault(layer + 1, slot);
        if (fault.status == NodeStatus::kLimit)
          for (int k = 0; k < kDof; ++k) reasons[joint_name(k)] += (fault.joints >> k) & 1;
        else
          ++reasons[status_name(fault)];
        continue;
      }
      const std::string reason = node_reason(nodes_.config(label, j));
      if (reason.empty())
        left.push_back(slot);
      else
        ++reasons[reason];
    }
    std::erase_if(reasons, [](const auto& reason) { return reason.second == 0; });
    constexpr int kMostEdges = 300;  // collision checks of edges are the slow part of a report
    int edges = 0;
    for (int a = 0; a < lattice_.width() && edges < kMostEdges; ++a) {
      const int label = lattice_.label_of(a), j = lattice_.angle_of(a);
      if (left.empty() || !before.valid(label, j)) continue;
      const Config qa = before.config(label, j);
      if (!node_reason(qa).empty()) continue;
      for (const int b : left) {
        if (!lattice_.in_window(layer, a, b)) continue;
        const std::string reason = edge_reason(layer, a, qa, b, nodes_.config(lattice_.label_of(b), lattice_.angle_of(b)));
        if (!reason.empty()) ++reasons[reason];
        edges += reason != "joint step";
      }
    }
    return reasons;
  }

 private:
  std::string name(const BodyPair& pair) const {
    return world_.body_names()[static_cast<std::size_t>(pair.a)] + " - " + world_.body_names()[static_cast<std::size_t>(pair.b)];
  }
  std::string joint_name(int k) const { return "joint " + lattice_.chain().joint_names[static_cast<std::size_t>(k)]; }
  static const char* status_name(const Lattice::NodeFault& fault) {
    switch (fault.status) {
      case NodeStatus::kNoIk:
        return "no IK";
      case NodeStatus::kSingular:
        return "singular";
      default:
        return "joint limits";
    }
  }

  const Lattice& lattice_;
  const World& world_;
  World::Query query_;
  EdgeRule rule_;
  LayerNodes nodes_;
};

}  // namespace

Diagnosis diagnose(const Lattice& lattice, const World& world, const EdgeRule& rule, int deepest_layer) {
  const Span span("diagnosis");
  Inspector inspector(lattice, world, rule);
  Diagnosis diagnosis;
  int hint = 0;
  for (int layer = 0; layer < lattice.layers(); ++layer) {
    const Reasons reasons = inspector.why_empty(layer, hint);
    if (reasons.empty()) continue;
    const PathLayer& at = lattice.path().layer(layer);
    diagnosis.empty_layers.push_back({layer, at.waypoint, at.s, most_frequent(reasons)});
  }
  if (deepest_layer >= 0) {
    diagnosis.reached_layer = deepest_layer;
    diagnosis.reached_s = lattice.path().layer(deepest_layer).s;
  }
  const auto empty = std::find_if(diagnosis.empty_layers.begin(), diagnosis.empty_layers.end(),
                                  [&](const EmptyLayer& e) { return e.layer == deepest_layer + 1; });
  if (deepest_layer >= 0 && deepest_layer + 1 < lattice.layers()) diagnosis.removed = inspector.removed_past(deepest_layer);
  if (empty != diagnosis.empty_layers.end()) {
    diagnosis.reason = empty->reason;
  } else {
    // The next layer has nodes, but no edge into them is left.
    Reasons edges;
    for (const auto& [reason, count] : diagnosis.removed)
      if (reason == "joint step" || reason == "tool-path error" || reason.ends_with(" between layers")) edges[reason] = count;
    diagnosis.reason = edges.empty() ? "arm slope" : most_frequent(edges);
  }
  return diagnosis;
}

}  // namespace swivel
