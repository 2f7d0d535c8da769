// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/report/lattice_map.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <optional>

#include "swivel/collision/world.hpp"
#include "swivel/core/angle.hpp"
#include "swivel/core/roll_lattice.hpp"
#include "swivel/core/srs_lattice.hpp"

namespace swivel {

namespace {

constexpr int kCells = 90;  // of a turn, where there is no grid

/// What took FCL to find is told before what a certificate proves.
std::pair<NodeState, bool> importance(const LatticeMap::Node& node) {
  return {node.state, !node.certified};
}

}  // namespace

std::vector<int> LatticeMap::inhabited_sheets() const {
  std::vector<int> inhabited;
  for (int sheet = 0; sheet < panels(); ++sheet) {
    bool any = std::any_of(path.begin(), path.end(), [&](int slot) { return slot / angles == sheet; });
    for (int layer = 0; layer < layers && !any; ++layer)
      for (int j = 0; j < angles && !any; ++j) any = at(layer, sheet, j).state >= NodeState::kNotLookedAt;
    if (any) inhabited.push_back(sheet);
  }
  return inhabited;
}

std::string LatticeMap::blocker_name(const Node& node) const {
  const auto& [a, b] = blockers[node.cause];
  return a + " - " + b;
}

std::string LatticeMap::sheet_name(int sheet) const {
  if (shows_rolls(sheet)) return "roll of the tool, where the path is";
  const int branch = sheet / windings;
  if (!grid) return "solutions " + std::to_string(branch);
  const auto sign = [&](int bit) { return branch & bit ? "-" : "+"; };
  std::string name = std::string("shoulder ") + sign(kShoulderBit) + ", wrist " + sign(kWristBit) + ", elbow " + sign(kElbowBit);
  if (windings > 1) name += ", winding " + std::to_string(sheet % windings);
  return name;
}

std::vector<int> slots_of_rolls(const Lattice& lattice, int layer, int like, int cells) {
  const auto& rolls = dynamic_cast<const RollLattice&>(lattice);
  const double cell = kTwoPi / cells;
  const int inner = rolls.inner(layer, like);
  std::vector<int> slots;
  for (int k = 0; k < lattice.slots(layer); k += rolls.width()) slots.push_back(lattice.slots(layer) == 1 ? 0 : k + inner);
  // Cells between two rolls belong to the nearer one.
  double apart = cell;
  for (const int slot : slots) {
    double next = kTwoPi;
    for (const int other : slots)
      if (other != slot) next = std::min(next, std::abs(wrap_angle(rolls.roll(layer, other) - rolls.roll(layer, slot))));
    if (next < kTwoPi) apart = std::max(apart, next);
  }
  std::vector<int> result(static_cast<std::size_t>(cells), -1);
  for (int k = 0; k < cells; ++k) {
    double least = apart / 2 + 1e-9;
    for (const int slot : slots) {
      const double away = std::abs(wrap_angle(rolls.roll(layer, slot) - (k * cell - kPi)));
      if (away < least) least = away, result[static_cast<std::size_t>(k)] = slot;
    }
  }
  return result;
}

int map_cell(const Lattice& lattice, int layer, int slot) {
  if (dynamic_cast<const SrsLattice*>(&lattice)) return slot;
  if (const auto* rolls = dynamic_cast<const RollLattice*>(&lattice)) return rolls->inner(layer, slot);
  const int angle = static_cast<int>((wrap_angle(lattice.phi(layer, slot)) + kPi) / kTwoPi * kCells);
  return lattice.branch(layer, slot) * kCells + std::clamp(angle, 0, kCells - 1);
}

LatticeMap make_map(const PlanView& view, bool full, const Budget& budget) {
  const Lattice& lattice = view.lattice;
  World::Query query(view.world, Certificates::kOn);

  LatticeMap map;
  map.layers = lattice.layers();
  map.angles = kCells;
  map.grid = false;
  if (const auto* grid = dynamic_cast<const SrsLattice*>(&lattice)) {
    map.angles = grid->angles();
    map.windings = grid->windings();
    map.grid = true;
  }
  if (const auto* rolls = dynamic_cast<const RollLattice*>(&lattice)) {
    map.angles = rolls->at_roll(0).angles();
    map.windings = rolls->at_roll(0).windings();
    map.grid = true;
    map.turns = rolls->rolls() > 1 && !view.path.empty();
  }
  map.joint_names = lattice.chain().joint_names;
  for (const int slot : view.path) map.path.push_back(map_cell(lattice, static_cast<int>(map.path.size()), slot));
  map.complete = full || view.verdicts == nullptr;
  const std::size_t cells = static_cast<std::size_t>(map.panels()) * static_cast<std::size_t>(map.angles);
  map.nodes.resize(static_cast<std::size_t>(map.layers) * cells);
  std::vector<std::pair<std::size_t, std::pair<std::string, std::string>>> blocked;  // cell, by what
  std::vector<Lattice::Node> listed;
  const auto of_fault = [&](int layer, int slot) {
    const Lattice::NodeFault fault = lattice.fault(layer, slot);
    if (fault.status == NodeStatus::kSingular) return LatticeMap::Node{NodeState::kSingular};
    if (fault.status == NodeStatus::kLimit)
      return LatticeMap::Node{NodeState::kJointLimit, static_cast<std::uint8_t>(std::countr_zero(fault.joints))};
    return LatticeMap::Node{};
  };
  std::optional<BodyPair> pair;  // that blocks the node looked at last
  const auto look_at = [&](int layer, int slot, const Config& node) {
    const Verdict verdict = view.verdicts ? view.verdicts->node(layer, slot) : Verdict::kUnknown;
    if (verdict == Verdict::kUnknown && !map.complete) return LatticeMap::Node{NodeState::kNotLookedAt};
    budget.poll();
    const auto row = lattice.row(layer, slot, node);
    if (!row) {  // the exact chain does not reach the pose there, or not within its limits
      const LatticeMap::Node fault = of_fault(layer, slot);
      return fault.state == NodeState::kJointLimit ? fault : LatticeMap::Node{};
    }
    if (!lattice.manipulable(*row)) return LatticeMap::Node{NodeState::kSingular};
    const auto decided = [](const CollisionCounters& c) { return c.certified_free + c.certified_colliding; };
    const std::int64_t before = decided(query.counters());
    pair = query.first_below(*row, Keep::kNode);
    return LatticeMap::Node{pair ? NodeState::kBlocked : NodeState::kFree, 0, decided(query.counters()) > before};
  };
  int rank = 0;
  for (int layer = 0; layer < map.layers; ++layer) {
    map.s.push_back(lattice.path().layer(layer).s);
    budget.poll(Stage::kDrawing, layer, map.layers);
    int first = 0, last = lattice.slots(layer);
    if (const auto* rolls =
            dynamic_cast<const RollLattice*>(&lattice)) {  // at the roll of the path, behind its end at its last one
      if (layer < static_cast<int>(view.path.size())) rank = rolls->rank_of(layer, view.path[static_cast<std::size_t>(layer)]);
      if (last > rolls->width()) first = rolls->slot_of(rank, 0), last = first + rolls->width();
    }
    lattice.layer_nodes(layer, listed);
    auto next = std::find_if(listed.begin(), listed.end(), [&](const Lattice::Node& node) { return node.slot >= first; });
    for (int slot = first; slot < last; ++slot) {
      const bool exists = next != listed.end() && next->slot == slot;
      pair.reset();
      const LatticeMap::Node node = exists ? look_at(layer, slot, next->q) : of_fault(layer, slot);
      next += exists;
      const std::size_t cell = static_cast<std::size_t>(layer) * cells + static_cast<std::size_t>(map_cell(lattice, layer, slot));
      if (!map.grid && importance(node) <= importance(map.nodes[cell])) continue;
      map.nodes[cell] = node;
      if (pair) blocked.emplace_back(cell, std::pair(view.world.names(*pair)[0], view.world.names(*pair)[1]));
    }
    if (!map.turns || layer >= static_cast<int>(view.path.size())) continue;
    const int on_path = view.path[static_cast<std::size_t>(layer)], panel = map.sheets() * map.angles;
    const double roll = wrap_angle(dynamic_cast<const RollLattice&>(lattice).roll(layer, on_path));
    map.path_of_rolls.push_back(panel + static_cast<int>(std::lround((roll + kPi) / kTwoPi * map.angles)) % map.angles);
    const std::vector<int> slots = slots_of_rolls(lattice, layer, on_path, map.angles);
    for (int k = 0; k < map.angles; ++k) {
      const int slot = slots[static_cast<std::size_t>(k)];
      if (slot < 0) continue;
      const auto at = std::lower_bound(listed.begin(), listed.end(), slot,
                                       [](const Lattice::Node& node, int other) { return node.slot < other; });
      pair.reset();
      const std::size_t cell = static_cast<std::size_t>(layer) * cells + static_cast<std::size_t>(panel + k);
      map.nodes[cell] = at != listed.end() && at->slot == slot ? look_at(layer, slot, at->q) : of_fault(layer, slot);
      if (pair) blocked.emplace_back(cell, std::pair(view.world.names(*pair)[0], view.world.names(*pair)[1]));
    }
  }
  std::map<std::pair<std::string, std::string>, std::uint8_t> index;
  for (const auto& [cell, names] : blocked) index.emplace(names, 0);
  for (auto& [names, cause] : index) {
    cause = static_cast<std::uint8_t>(std::min<std::size_t>(map.blockers.size(), 255));
    map.blockers.push_back(names);
  }
  for (const auto& [cell, names] : blocked) map.nodes[cell].cause = index.at(names);
  return map;
}

}  // namespace swivel
