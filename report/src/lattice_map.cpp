// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/report/lattice_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <optional>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/verdicts/verdicts.hpp"

namespace swivel {

namespace {

constexpr int kCells = 90;  // of a panel, where there is no grid

/// What took FCL to find is told before what a distance proof proves.
std::pair<NodeState, bool> importance(const LatticeMap::Node& node) {
  return {node.state, !node.proved};
}

/// Of one roll.
int cells_of(const LatticeInfo::Grid& grid) {
  return grid.branches * grid.windings * grid.phi;
}

/// The values of the coordinate, in [-pi, pi], and the branches of the nodes of each layer, in the
/// order of slots.
struct Values {
  std::vector<double> value;
  std::vector<int> branch;
  std::vector<std::size_t> first;  // of each layer
};

Values values_of(const Lattice& lattice, const Budget& budget) {
  Values values;
  for (int layer = 0; layer < lattice.layers(); ++layer) {
    budget.poll(Stage::kDrawing, layer, lattice.layers());
    values.first.push_back(values.value.size());
    for (int slot = 0; slot < lattice.slots(layer); ++slot) {
      values.value.push_back(wrap_angle(lattice.phi(layer, slot)));
      values.branch.push_back(lattice.branch(layer, slot));
    }
  }
  return values;
}

/// The cells of a panel cover the turn but for the widest gap between the values; all of it where
/// that gap is less than an eighth.
void fit_cells(LatticeMap& map, std::vector<double> values) {
  constexpr double kNarrow = 0.01;  // rad: so little is one cell
  std::sort(values.begin(), values.end());
  double gap = values.empty() ? 0 : values.front() + kTwoPi - values.back();
  std::size_t after = 0;
  for (std::size_t k = 1; k < values.size(); ++k)
    if (values[k] - values[k - 1] > gap) gap = values[k] - values[k - 1], after = k;
  const double span = kTwoPi - gap;
  map.closed = gap < kTwoPi / 8;
  map.angles = map.closed || span > kNarrow ? kCells : 1;
  map.step = map.closed || span <= kNarrow ? kTwoPi / kCells : span / (kCells - 1);
  if (!map.closed) map.low = values[after] + (span > kNarrow ? 0 : span / 2);
}

/// Whose node each cell of a layer shows, -1: none. A node has its cell and those up to half the
/// way to its neighbours on the arc; of several the path's is shown, or the most important.
/// `nodes`: of the layer's slots. `on_path`: the path's slot, or -1.
std::vector<int> slots_of_cells(const LatticeMap& map, const Lattice& lattice, int layer,
                                const Values& values, const std::vector<LatticeMap::Node>& nodes,
                                int on_path) {
  const double* const value = values.value.data() + values.first[static_cast<std::size_t>(layer)];
  const int* const branch = values.branch.data() + values.first[static_cast<std::size_t>(layer)];
  std::vector<int> shown(
      static_cast<std::size_t>(map.panels()) * static_cast<std::size_t>(map.angles), -1);
  const auto offer = [&](int slot, int angle) {
    int& best = shown[static_cast<std::size_t>(branch[slot] * map.angles + angle)];
    const auto worth = [&](int k) {
      return std::pair(k == on_path, importance(nodes[static_cast<std::size_t>(k)]));
    };
    if (best < 0 || worth(slot) > worth(best)) best = slot;
  };
  for (int slot = 0; slot < static_cast<int>(nodes.size()); ++slot) {
    const double from = map.place(value[slot]);
    offer(slot, std::clamp(static_cast<int>(std::lround(from)), 0, map.angles - 1));
    const int next = lattice.next_on_arc(layer, slot);
    if (next < 0) continue;
    const double way = wrap_angle(value[next] - value[slot]) / map.step;
    for (auto k = static_cast<int>(std::ceil(std::min(from, from + way)));
         k <= std::max(from, from + way); ++k) {
      const int angle = map.closed ? (k + map.angles) % map.angles : k;
      if (angle >= 0 && angle < map.angles)
        offer(std::abs(k - from) <= std::abs(way) / 2 ? slot : next, angle);
    }
  }
  return shown;
}

}  // namespace

int LatticeMap::solutions() const {
  return kBranches * windings;
}

double LatticeMap::place(double value) const {
  const double turn = kTwoPi / step, before = closed ? 0.5 : (turn - (angles - 1)) / 2,
               k = (value - low) / step;
  return k - turn * std::floor((k + before) / turn);
}

double LatticeMap::value(double k) const {
  const double value = low + k * step;
  return value > kPi ? value - kTwoPi : value;
}

const char* LatticeMap::coordinate_name() const {
  if (coordinate == Coordinate::kRoll) return "roll";
  return grid() ? "arm angle" : "generalised arm angle";
}

const char* LatticeMap::letter(int panel) const {
  return coordinate == Coordinate::kRoll || shows_rolls(panel) ? "ρ" : "φ";
}

const char* LatticeMap::emptiness() const {
  if (!grid()) return "no solution: out of reach, beyond a joint limit, or beside the given start";
  return turns ? "no node: out of reach, beside the given start, or turned further than allowed"
               : "no node: out of reach, or beside the given start";
}

std::vector<int> LatticeMap::inhabited_solutions() const {
  std::vector<int> inhabited;
  for (int solution = 0; solution < panels(); ++solution) {
    bool any =
        std::any_of(path.begin(), path.end(), [&](int slot) { return slot / angles == solution; });
    for (int layer = 0; layer < layers && !any; ++layer)
      for (int j = 0; j < angles && !any; ++j)
        any = at(layer, solution, j).state >= NodeState::kNotLookedAt;
    if (any) inhabited.push_back(solution);
  }
  return inhabited;
}

std::string LatticeMap::blocker_name(const Node& node) const {
  const auto& [a, b] = blockers[node.cause];
  return a + " - " + b;
}

std::string LatticeMap::solution_name(int solution) const {
  if (shows_rolls(solution)) return "roll of the tool, where the path is";
  const int branch = solution / windings;
  if (!grid()) return "solutions " + std::to_string(branch);
  const auto sign = [&](int bit) { return branch & bit ? "-" : "+"; };
  std::string name = std::string("shoulder ") + sign(kShoulderBit) + ", wrist " + sign(kWristBit) +
                     ", elbow " + sign(kElbowBit);
  if (windings > 1) name += ", winding " + std::to_string(solution % windings);
  return name;
}

std::vector<int> slots_of_rolls(const Lattice& lattice, int layer, int like, int cells) {
  const double cell = kTwoPi / cells;
  const int inner = lattice.grid_place(layer, like).cell,
            width = cells_of(*lattice.describe().grid);
  const auto roll = [&](int slot) { return lattice.grid_place(layer, slot).roll; };
  std::vector<int> slots;
  for (int k = 0; k < lattice.slots(layer); k += width)
    slots.push_back(lattice.slots(layer) == 1 ? 0 : k + inner);
  // Cells between two rolls belong to the nearer one.
  double apart = cell;
  for (const int slot : slots) {
    double next = kTwoPi;
    for (const int other : slots)
      if (other != slot) next = std::min(next, std::abs(wrap_angle(roll(other) - roll(slot))));
    if (next < kTwoPi) apart = std::max(apart, next);
  }
  std::vector<int> result(static_cast<std::size_t>(cells), -1);
  for (int k = 0; k < cells; ++k) {
    double least = apart / 2 + 1e-9;
    for (const int slot : slots) {
      const double away = std::abs(wrap_angle(roll(slot) - (k * cell - kPi)));
      if (away < least) least = away, result[static_cast<std::size_t>(k)] = slot;
    }
  }
  return result;
}

int map_cell(const LatticeMap& map, const Lattice& lattice, int layer, int slot) {
  if (map.grid()) return lattice.grid_place(layer, slot).cell;
  const int angle = static_cast<int>(std::lround(map.place(lattice.phi(layer, slot))));
  return lattice.branch(layer, slot) * map.angles + std::clamp(angle, 0, map.angles - 1);
}

LatticeMap make_map(const PlanView& view, bool full, const Budget& budget) {
  const Lattice& lattice = view.lattice;
  World::Query query(view.world, DistanceProofs::kOn);

  LatticeMap map;
  map.layers = lattice.layers();
  Values values;
  const auto grid = lattice.describe().grid;
  if (grid) {
    map.angles = grid->phi;
    map.windings = grid->windings;
    map.turns = grid->rolls.value_or(1) > 1 && !view.path.empty();
  } else {
    using Coordinate = LatticeMap::Coordinate;
    map.coordinate = lattice.chain().roll ? Coordinate::kRoll : Coordinate::kGeneralisedArmAngle;
    values = values_of(lattice, budget);
    fit_cells(map, values.value);
  }
  if (map.grid()) map.step = kTwoPi / map.angles;
  map.joint_names = lattice.chain().joint_names;
  for (const int slot : view.path)
    map.path.push_back(map_cell(map, lattice, static_cast<int>(map.path.size()), slot));
  map.complete = full || view.verdicts == nullptr;
  const std::size_t cells =
      static_cast<std::size_t>(map.panels()) * static_cast<std::size_t>(map.angles);
  map.nodes.resize(static_cast<std::size_t>(map.layers) * cells);
  if (!map.grid()) map.slots.reserve(map.nodes.size());
  std::vector<std::pair<std::size_t, std::pair<std::string, std::string>>>
      blocked;  // cell, by what
  std::vector<Lattice::Node> listed;
  const auto of_fault = [&](int layer, int slot) {
    const Lattice::NodeFault fault = lattice.fault(layer, slot);
    if (fault.status == NodeStatus::kSingular) return LatticeMap::Node{NodeState::kSingular};
    if (fault.status == NodeStatus::kLimit)
      return LatticeMap::Node{NodeState::kJointLimit,
                              static_cast<std::uint8_t>(std::countr_zero(fault.joints))};
    return LatticeMap::Node{};
  };
  std::optional<BodyPair> pair;  // that blocks the node looked at last
  const auto look_at = [&](int layer, int slot, const Config& node) {
    const Verdict verdict = view.verdicts ? view.verdicts->node(layer, slot) : Verdict::kUnknown;
    if (verdict == Verdict::kUnknown && !map.complete)
      return LatticeMap::Node{NodeState::kNotLookedAt};
    budget.poll();
    const auto row = lattice.exact_config(layer, slot, node);
    if (!row) {  // the exact chain does not reach the pose there, or not within its limits
      const LatticeMap::Node fault = of_fault(layer, slot);
      return fault.state == NodeState::kJointLimit ? fault : LatticeMap::Node{};
    }
    if (!lattice.manipulable(*row)) return LatticeMap::Node{NodeState::kSingular};
    const auto decided = [](const CollisionCounters& c) {
      return c.proved_free + c.proved_colliding;
    };
    const std::int64_t before = decided(query.counters());
    pair = query.find_violating_pair(*row, ClearanceRule::kNode);
    return LatticeMap::Node{pair ? NodeState::kBlocked : NodeState::kFree, 0,
                            decided(query.counters()) > before};
  };
  int rank = 0;
  for (int layer = 0; layer < map.layers; ++layer) {
    map.s.push_back(lattice.path().layer(layer).s);
    budget.poll(Stage::kDrawing, layer, map.layers);
    int first = 0, last = lattice.slots(layer);
    if (grid) {  // at the roll of the path, behind its end at its last one
      const int width = cells_of(*grid);
      if (layer < static_cast<int>(view.path.size()))
        rank = lattice.grid_place(layer, view.path[static_cast<std::size_t>(layer)]).rank;
      if (last > width) first = rank * width, last = first + width;
    }
    lattice.layer_nodes(layer, listed);
    if (!map.grid()) {  // all slots exist
      std::vector<LatticeMap::Node> nodes;
      std::vector<std::optional<BodyPair>> pairs;
      for (const Lattice::Node& node : listed) {
        pair.reset();
        nodes.push_back(look_at(layer, node.slot, node.q));
        pairs.push_back(pair);
      }
      const int on_path = layer < static_cast<int>(view.path.size())
                              ? view.path[static_cast<std::size_t>(layer)]
                              : -1;
      for (const int slot : slots_of_cells(map, lattice, layer, values, nodes, on_path)) {
        const std::size_t cell = map.slots.size(), k = static_cast<std::size_t>(slot);
        map.slots.push_back(slot);
        if (slot < 0) continue;
        map.nodes[cell] = nodes[k];
        if (pairs[k])
          blocked.emplace_back(
              cell, std::pair(view.world.names(*pairs[k])[0], view.world.names(*pairs[k])[1]));
      }
      continue;
    }
    auto next = std::find_if(listed.begin(), listed.end(),
                             [&](const Lattice::Node& node) { return node.slot >= first; });
    for (int slot = first; slot < last; ++slot) {
      const bool exists = next != listed.end() && next->slot == slot;
      pair.reset();
      const LatticeMap::Node node = exists ? look_at(layer, slot, next->q) : of_fault(layer, slot);
      next += exists;
      const std::size_t cell = static_cast<std::size_t>(layer) * cells +
                               static_cast<std::size_t>(map_cell(map, lattice, layer, slot));
      map.nodes[cell] = node;
      if (pair)
        blocked.emplace_back(cell,
                             std::pair(view.world.names(*pair)[0], view.world.names(*pair)[1]));
    }
    if (!map.turns || layer >= static_cast<int>(view.path.size())) continue;
    const int on_path = view.path[static_cast<std::size_t>(layer)],
              panel = map.solutions() * map.angles;
    const double roll = wrap_angle(lattice.grid_place(layer, on_path).roll);
    map.path_of_rolls.push_back(
        panel + static_cast<int>(std::lround((roll + kPi) / kTwoPi * map.angles)) % map.angles);
    const std::vector<int> slots = slots_of_rolls(lattice, layer, on_path, map.angles);
    for (int k = 0; k < map.angles; ++k) {
      const int slot = slots[static_cast<std::size_t>(k)];
      if (slot < 0) continue;
      const auto at =
          std::lower_bound(listed.begin(), listed.end(), slot,
                           [](const Lattice::Node& node, int other) { return node.slot < other; });
      pair.reset();
      const std::size_t cell =
          static_cast<std::size_t>(layer) * cells + static_cast<std::size_t>(panel + k);
      map.nodes[cell] = at != listed.end() && at->slot == slot ? look_at(layer, slot, at->q)
                                                               : of_fault(layer, slot);
      if (pair)
        blocked.emplace_back(cell,
                             std::pair(view.world.names(*pair)[0], view.world.names(*pair)[1]));
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
