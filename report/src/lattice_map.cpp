// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/report/lattice_map.hpp"

#include <algorithm>
#include <bit>
#include <map>

#include "swivel/collision/world.hpp"
#include "swivel/core/srs_lattice.hpp"

namespace swivel {

std::vector<int> LatticeMap::inhabited_labels() const {
  std::vector<int> inhabited;
  for (int label = 0; label < labels(); ++label) {
    bool any = std::any_of(path.begin(), path.end(), [&](int slot) { return slot / angles == label; });
    for (int layer = 0; layer < layers && !any; ++layer)
      for (int j = 0; j < angles && !any; ++j) any = at(layer, label, j).state >= NodeState::kNotLookedAt;
    if (any) inhabited.push_back(label);
  }
  return inhabited;
}

std::string LatticeMap::blocker_name(const Node& node) const {
  const auto& [a, b] = blockers[node.cause];
  return a + " - " + b;
}

std::string LatticeMap::label_name(int label) const {
  const int branch = label / windings;
  const auto sign = [&](int bit) { return branch & bit ? "-" : "+"; };
  std::string name = std::string("shoulder ") + sign(kShoulderBit) + ", wrist " + sign(kWristBit) + ", elbow " + sign(kElbowBit);
  if (windings > 1) name += ", winding " + std::to_string(label % windings);
  return name;
}

LatticeMap make_map(const PlanView& view, bool full, const Budget& budget) {
  const auto& lattice = dynamic_cast<const SrsLattice&>(view.lattice);
  World::Query query(view.world, Certificates::kOn);

  LatticeMap map;
  map.layers = lattice.layers();
  map.angles = lattice.angles();
  map.windings = lattice.windings();
  map.joint_names = lattice.chain().joint_names;
  map.path = view.path;
  map.complete = full || view.verdicts == nullptr;
  map.nodes.resize(static_cast<std::size_t>(lattice.nodes()));
  std::vector<std::pair<std::size_t, std::pair<std::string, std::string>>> blocked;  // node, by what
  LayerNodes nodes;
  std::size_t k = 0;
  for (int layer = 0; layer < map.layers; ++layer) {
    map.s.push_back(lattice.path().layer(layer).s);
    budget.poll(Stage::kDrawing, layer, map.layers);
    lattice.solve(layer, nodes);
    for (int slot = 0; slot < lattice.width(); ++slot, ++k) {
      LatticeMap::Node& node = map.nodes[k];
      if (!nodes.valid(lattice.label_of(slot), lattice.angle_of(slot))) {
        const SrsLattice::NodeFault fault = lattice.fault(layer, slot);
        if (fault.status == NodeStatus::kSingular) node.state = NodeState::kSingular;
        if (fault.status == NodeStatus::kLimit)
          node = {NodeState::kJointLimit, static_cast<std::uint8_t>(std::countr_zero(fault.joints))};
        continue;
      }
      const Verdict verdict = view.verdicts ? view.verdicts->node(layer, slot) : Verdict::kUnknown;
      node.state = NodeState::kNotLookedAt;
      if (verdict == Verdict::kUnknown && !map.complete) continue;
      budget.poll();
      const auto row = lattice.row(layer, slot, nodes.config(lattice.label_of(slot), lattice.angle_of(slot)));
      if (!row) {  // the exact chain does not reach the pose there, or not within its limits
        const SrsLattice::NodeFault fault = lattice.fault(layer, slot);
        node.state = NodeState::kNoIk;
        if (fault.status == NodeStatus::kLimit)
          node = {NodeState::kJointLimit, static_cast<std::uint8_t>(std::countr_zero(fault.joints))};
        continue;
      }
      const Config& q = *row;
      if (!lattice.manipulable(q)) {
        node.state = NodeState::kSingular;
        continue;
      }
      const auto decided = [](const CollisionCounters& c) { return c.certified_free + c.certified_colliding; };
      const std::int64_t before = decided(query.counters());
      const auto pair = query.first_below(q, Keep::kNode);
      node.certified = decided(query.counters()) > before;
      node.state = pair ? NodeState::kBlocked : NodeState::kFree;
      if (pair) blocked.emplace_back(k, std::pair(view.world.names(*pair)[0], view.world.names(*pair)[1]));
    }
  }
  std::map<std::pair<std::string, std::string>, std::uint8_t> index;
  for (const auto& [node, pair] : blocked) index.emplace(pair, 0);
  for (auto& [pair, cause] : index) {
    cause = static_cast<std::uint8_t>(std::min<std::size_t>(map.blockers.size(), 255));
    map.blockers.push_back(pair);
  }
  for (const auto& [node, pair] : blocked) map.nodes[node].cause = index.at(pair);
  return map;
}

}  // namespace swivel
