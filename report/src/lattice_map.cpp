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
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/graph/verdicts/verdicts.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

namespace {

/// Number of cells in a column of a panel, for a lattice without a grid.
constexpr int kCells = 90;

/// Returns a key that orders nodes by importance: by state, then what FCL found before what a
/// distance proof proves.
std::pair<NodeState, bool> importance(const LatticeMap::Node& node) {
  return {node.state, !node.proved};
}

/// Returns the number of cells in a layer of the grid at one roll.
int cells_of(const LatticeInfo::Grid& grid) {
  return grid.branches * grid.windings * grid.phi;
}

/// Returns the joint whose position is the coordinate of the map of an arm without a grid: one that
/// slides, that of a table which carries the base and the part, or the one that the closed form
/// locks; the last of an arm of six joints whose tool may not turn, in which all its solutions
/// differ; -1 where there is none of these.
int free_joint(const PreparedRobot& robot, const RobotModel& model) {
  if (!robot.arm_class().redundant) return kDof - 2;
  if (const int slide = robot.arm().chain.slide(); slide >= 0) return slide;
  const LockMethod& lock = robot.arm_class().lock;
  const bool table = robot.arm().links[static_cast<std::size_t>(model.root_link)].group == 1;
  return table && lock.by_joint[0] ? 0 : lock.best;
}

/// The redundancy coordinate and the branch of every node, by layer and in the order of slots.
struct Values {
  std::vector<double> value;  ///< rad, in [-pi, pi], or m
  std::vector<int> branch;
  std::vector<std::size_t> first;  ///< index of each layer's first node in `value`, `branch`
};

/// Returns the value of the map's coordinate at a node, rad in [-pi, pi], or m.
double value_of(const LatticeMap& map, const Lattice& lattice, int layer, int slot) {
  if (map.joint < 0) return wrap_angle(lattice.phi(layer, slot));
  return map.value_at(0, lattice.node(layer, slot).value());
}

Values values_of(const LatticeMap& map, const Lattice& lattice, const Budget& budget) {
  Values values;
  for (int layer = 0; layer < lattice.layers(); ++layer) {
    budget.poll(Stage::kDrawing, layer, lattice.layers());
    values.first.push_back(values.value.size());
    for (int slot = 0; slot < lattice.slots(layer); ++slot) {
      values.value.push_back(value_of(map, lattice, layer, slot));
      values.branch.push_back(lattice.branch(layer, slot));
    }
  }
  return values;
}

/// Sets range and number of the map's cells so that they cover the full turn except the widest gap
/// between `values` (rad), or all of it if that gap is less than an eighth of the turn; of a joint
/// that slides (m) so that they cover all values.
void fit_cells(LatticeMap& map, std::vector<double> values) {
  constexpr double kNarrow = 0.01;  // rad or m: a range narrower than this is one cell
  std::sort(values.begin(), values.end());
  if (map.slides) {
    const double low = values.empty() ? 0 : values.front(),
                 span = values.empty() ? 0 : values.back() - low;
    map.closed = false;
    map.angles = span > kNarrow ? kCells : 1;
    map.step = span > kNarrow ? span / (kCells - 1) : kNarrow;
    map.low = low + (span > kNarrow ? 0 : span / 2);
    return;
  }
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

/// Returns, for each cell of a layer, the slot whose node it shows; -1 if none. A node has its own
/// cell and those up to half the way to its neighbours on the arc. A cell that several nodes have
/// shows the path's, or else the most important. `nodes` are those of the layer's slots; `on_path`
/// is the path's slot, or -1.
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
    const double apart = value[next] - value[slot],
                 way = (map.slides ? apart : wrap_angle(apart)) / map.step;
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
  if (slides) return (value - low) / step;
  const double turn = kTwoPi / step, before = closed ? 0.5 : (turn - (angles - 1)) / 2,
               k = (value - low) / step;
  return k - turn * std::floor((k + before) / turn);
}

double LatticeMap::value(double k) const {
  const double value = low + k * step;
  return value > kPi && !slides ? value - kTwoPi : value;
}

double LatticeMap::value_at(double phi, const Config& q) const {
  if (joint < 0) return phi;
  return slides ? q[joint] : wrap_angle(q[joint]);
}

std::string LatticeMap::coordinate_name() const {
  if (coordinate == Coordinate::kRoll) return "roll";
  if (joint >= 0) return joint_names[static_cast<std::size_t>(joint)];
  return grid() ? "arm angle" : "generalised arm angle";
}

std::string LatticeMap::letter(int panel) const {
  if (joint >= 0) return coordinate_name();
  return coordinate == Coordinate::kRoll || shows_rolls(panel) ? "ρ" : "φ";
}

const char* LatticeMap::emptiness() const {
  if (!grid()) return "no node: out of reach, beyond a joint limit, or beside a given start or end";
  return turns
             ? "no node: out of reach, beside a given start or end, or turned further than allowed"
             : "no node: out of reach, or beside a given start or end";
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

int LatticeMap::blocking_object(const Node& node) const {
  const auto& [a, b] = blockers[node.cause];
  for (const std::string& name : {a, b})
    if (const auto at = std::find(objects.begin(), objects.end(), name); at != objects.end())
      return static_cast<int>(at - objects.begin());
  return -1;
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
  // A cell between two rolls belongs to the nearer one.
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
  const int angle = static_cast<int>(std::lround(map.place(value_of(map, lattice, layer, slot))));
  return lattice.branch(layer, slot) * map.angles + std::clamp(angle, 0, map.angles - 1);
}

namespace {

/// Makes the map of a lattice, layer by layer.
class MapMaker {
 public:
  /// Lays out the cells of a map without nodes. `full`: ask about every node's clearance. Throws
  /// Stopped.
  MapMaker(const PlanView& view, bool full, const Budget& budget)
      : view_(view),
        lattice_(view.lattice),
        budget_(budget),
        query_(view.world, DistanceProofs::kOn),
        grid_(view.lattice.describe().grid) {
    map_.layers = lattice_.layers();
    if (grid_)
      lay_out_grid();
    else
      lay_out_arcs();
    if (map_.grid()) map_.step = kTwoPi / map_.angles;
    map_.joint_names = lattice_.chain().joint_names;
    for (const SceneObject& object : view.problem.scene)
      if (std::find(map_.objects.begin(), map_.objects.end(), object.name) == map_.objects.end())
        map_.objects.push_back(object.name);
    for (const int slot : view.path)
      map_.path.push_back(map_cell(map_, lattice_, static_cast<int>(map_.path.size()), slot));
    map_.complete = full || view.verdicts == nullptr;
    cells_ = static_cast<std::size_t>(map_.panels()) * static_cast<std::size_t>(map_.angles);
    map_.nodes.resize(static_cast<std::size_t>(map_.layers) * cells_);
    if (!map_.grid()) map_.slots.reserve(map_.nodes.size());
  }

  /// Returns the map with all its nodes. Throws Stopped.
  LatticeMap make() {
    for (int layer = 0; layer < map_.layers; ++layer) {
      map_.s.push_back(lattice_.path().layer(layer).s);
      budget_.poll(Stage::kDrawing, layer, map_.layers);
      lattice_.layer_nodes(layer, listed_);
      if (grid_) {
        add_grid_layer(layer);
        if (map_.turns && on_path(layer)) add_rolls(layer);
      } else {
        add_arc_layer(layer);
      }
    }
    name_blockers();
    return std::move(map_);
  }

 private:
  /// What is known of a node, and the pair of bodies that blocks it.
  struct Found {
    LatticeMap::Node node;
    std::optional<BodyPair> pair{};
  };

  void lay_out_grid() {
    map_.angles = grid_->phi;
    map_.windings = grid_->windings;
    map_.turns = grid_->rolls.value_or(1) > 1 && !view_.path.empty();
  }
  void lay_out_arcs() {
    using Coordinate = LatticeMap::Coordinate;
    const Chain& chain = lattice_.chain();
    const bool rolls = chain.roll && chain.tool_may_turn();
    map_.joint = rolls ? -1 : free_joint(view_.robot, *view_.problem.model);
    map_.slides = map_.joint >= 0 && map_.joint == chain.slide();
    map_.coordinate = rolls             ? Coordinate::kRoll
                      : map_.joint >= 0 ? Coordinate::kJoint
                                        : Coordinate::kGeneralisedArmAngle;
    values_ = values_of(map_, lattice_, budget_);
    fit_cells(map_, values_.value);
  }

  /// Returns true if the path has a node in the layer.
  [[nodiscard]] bool on_path(int layer) const {
    return layer < static_cast<int>(view_.path.size());
  }
  [[nodiscard]] int slot_on_path(int layer) const {
    return view_.path[static_cast<std::size_t>(layer)];
  }

  /// Returns why a slot has no node.
  [[nodiscard]] LatticeMap::Node fault_of(int layer, int slot) const {
    const Lattice::NodeFault fault = lattice_.fault(layer, slot);
    if (fault.status == NodeStatus::kSingular) return {NodeState::kSingular};
    if (fault.status == NodeStatus::kLimit)
      return {NodeState::kJointLimit, static_cast<std::uint8_t>(std::countr_zero(fault.joints))};
    return {};
  }

  /// Returns what is known of a node with joints `q`; asks for its clearance if the search did, or
  /// if the map is to be complete.
  Found look_at(int layer, int slot, const Config& q) {
    const Verdict verdict = view_.verdicts ? view_.verdicts->node(layer, slot) : Verdict::kUnknown;
    if (verdict == Verdict::kUnknown && !map_.complete) return {{NodeState::kNotLookedAt}};
    budget_.poll();
    const auto row = lattice_.exact_config(layer, slot, q);
    if (!row) {  // the exact chain does not reach the pose there, or not within its limits
      const LatticeMap::Node fault = fault_of(layer, slot);
      return {fault.state == NodeState::kJointLimit ? fault : LatticeMap::Node{}};
    }
    if (!lattice_.manipulable(*row)) return {{NodeState::kSingular}};
    const auto decided = [](const CollisionCounters& c) {
      return c.proved_free + c.proved_colliding;
    };
    const std::int64_t before = decided(query_.counters());
    const auto pair = query_.find_violating_pair(*row, ClearanceRule::kNode);
    return {{pair ? NodeState::kBlocked : NodeState::kFree, 0, decided(query_.counters()) > before},
            pair};
  }

  /// Sets a cell of the map, [layer][panel][angle].
  void set(std::size_t cell, const Found& found) {
    map_.nodes[cell] = found.node;
    if (!found.pair) return;
    const auto names = view_.world.names(*found.pair);
    blocked_.emplace_back(cell, std::pair(names[0], names[1]));
  }

  /// Sets the cells of a layer of a lattice without a grid, in which every slot has a node.
  void add_arc_layer(int layer) {
    std::vector<Found> found;
    std::vector<LatticeMap::Node> nodes;
    for (const Lattice::Node& node : listed_) {
      found.push_back(look_at(layer, node.slot, node.q));
      nodes.push_back(found.back().node);
    }
    const int of_path = on_path(layer) ? slot_on_path(layer) : -1;
    for (const int slot : slots_of_cells(map_, lattice_, layer, values_, nodes, of_path)) {
      const std::size_t cell = map_.slots.size();
      map_.slots.push_back(slot);
      if (slot >= 0) set(cell, found[static_cast<std::size_t>(slot)]);
    }
  }

  /// Sets the cells of a layer of a grid. Where the tool may turn, they are those at the path's
  /// roll; behind the end of the path, at its last roll.
  void add_grid_layer(int layer) {
    int first = 0, last = lattice_.slots(layer);
    const int width = cells_of(*grid_);
    if (on_path(layer)) rank_ = lattice_.grid_place(layer, slot_on_path(layer)).rank;
    if (last > width) first = rank_ * width, last = first + width;
    auto next = std::find_if(listed_.begin(), listed_.end(),
                             [&](const Lattice::Node& node) { return node.slot >= first; });
    for (int slot = first; slot < last; ++slot) {
      const bool exists = next != listed_.end() && next->slot == slot;
      const Found found = exists ? look_at(layer, slot, next->q) : Found{fault_of(layer, slot)};
      next += exists;
      set(static_cast<std::size_t>(layer) * cells_ +
              static_cast<std::size_t>(map_cell(map_, lattice_, layer, slot)),
          found);
    }
  }

  /// Sets the cells of the panel of rolls in a layer that the path reaches.
  void add_rolls(int layer) {
    const int of_path = slot_on_path(layer), panel = map_.solutions() * map_.angles;
    const double roll = wrap_angle(lattice_.grid_place(layer, of_path).roll);
    map_.path_of_rolls.push_back(
        panel + static_cast<int>(std::lround((roll + kPi) / kTwoPi * map_.angles)) % map_.angles);
    const std::vector<int> slots = slots_of_rolls(lattice_, layer, of_path, map_.angles);
    for (int k = 0; k < map_.angles; ++k) {
      const int slot = slots[static_cast<std::size_t>(k)];
      if (slot < 0) continue;
      const auto at =
          std::lower_bound(listed_.begin(), listed_.end(), slot,
                           [](const Lattice::Node& node, int other) { return node.slot < other; });
      const bool exists = at != listed_.end() && at->slot == slot;
      set(static_cast<std::size_t>(layer) * cells_ + static_cast<std::size_t>(panel + k),
          exists ? look_at(layer, slot, at->q) : Found{fault_of(layer, slot)});
    }
  }

  /// Lists the pairs of bodies that block nodes, in the order of their names, and sets the causes
  /// of the blocked nodes to their numbers.
  void name_blockers() {
    std::map<std::pair<std::string, std::string>, std::uint8_t> index;
    for (const auto& [cell, names] : blocked_) index.emplace(names, 0);
    for (auto& [names, cause] : index) {
      cause = static_cast<std::uint8_t>(std::min<std::size_t>(map_.blockers.size(), 255));
      map_.blockers.push_back(names);
    }
    for (const auto& [cell, names] : blocked_) map_.nodes[cell].cause = index.at(names);
  }

  const PlanView& view_;
  const Lattice& lattice_;
  const Budget& budget_;
  World::Query query_;
  const std::optional<LatticeInfo::Grid> grid_;
  LatticeMap map_;
  Values values_;                      ///< of a lattice without a grid
  std::size_t cells_ = 0;              ///< of all panels in one layer
  int rank_ = 0;                       ///< of the roll that the path has in the layer, or had last
  std::vector<Lattice::Node> listed_;  ///< nodes of the layer
  /// The blocked cells, each with the names of the two bodies.
  std::vector<std::pair<std::size_t, std::pair<std::string, std::string>>> blocked_;
};

}  // namespace

LatticeMap make_map(const PlanView& view, bool full, const Budget& budget) {
  return MapMaker(view, full, budget).make();
}

}  // namespace swivel
