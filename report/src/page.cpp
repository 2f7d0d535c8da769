// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/report/page.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>

#include "drawing.hpp"
#include "map_cells.hpp"
#include "page_template.hpp"
#include "scene_json.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/motion/time_path.hpp"

namespace swivel {

using namespace detail;

namespace {

/// A row of a trajectory, and where it is in the map.
struct Row {
  TrajectoryRow at;
  /// Layer of the lattice. Not a whole number for a row between two layers of the lattice, where
  /// the path has more layers than the lattice.
  double layer = 0;
  int solution = 0;
  double angle = 0;              ///< in cells
  std::optional<double> roll{};  ///< rad
};

/// Returns true if the tool may stand turned, so that nodes have rolls.
bool may_turn(const Lattice& lattice) {
  const auto grid = lattice.describe().grid;
  return grid && grid->rolls;
}

/// Returns the rows with their places in the map. `rows` are those of the path's layers, from the
/// first on; `slots` is the lattice's path. A row has the IK solution of the lattice's path if it
/// is on that branch, else the solution of the nearest node of its own branch.
std::vector<Row> placed(const Lattice& lattice, const LatticeMap& map,
                        const std::vector<TrajectoryRow>& rows, const std::vector<int>& slots) {
  const bool turned = may_turn(lattice);
  const std::vector<double> turns = rolls_of(rows);
  const ToolPath& path = lattice.path_of_rows();
  std::vector<Row> shown;
  std::size_t knot = 0;  // the layer of the lattice at the row, or before it
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto layer_of = [&](std::size_t k) {
      return static_cast<std::size_t>(lattice.layer_of_rows(static_cast<int>(k)));
    };
    if (knot + 1 < slots.size() && layer_of(knot + 1) <= i) ++knot;
    Row row{rows[i], static_cast<double>(knot)};
    if (const std::size_t first = layer_of(knot); i > first) {
      const std::size_t last = layer_of(knot + 1);
      const auto s = [&](std::size_t layer) { return path.layer(static_cast<int>(layer)).s; };
      const auto count = static_cast<double>(i - first) / static_cast<double>(last - first);
      row.layer += s(last) > s(first) ? (s(i) - s(first)) / (s(last) - s(first)) : count;
    }
    row.angle = map.place(row.at.phi);
    row.solution = map.path[knot] / map.angles;
    if (turned) row.roll = turns[i];
    if (const int branch = row.at.branch; row.solution / map.windings != branch) {
      row.solution = branch * map.windings;
      double least = std::numeric_limits<double>::infinity();
      for (int solution = row.solution, end = solution + map.windings;
           map.grid() && !turned && solution < end; ++solution) {
        const int cell = static_cast<int>(std::lround(row.angle)) % map.angles;
        const auto node = lattice.node(static_cast<int>(i), solution * map.angles + cell);
        if (!node) continue;
        const double away = (*node - row.at.q).norm();
        if (away < least) least = away, row.solution = solution;
      }
    }
    shown.push_back(std::move(row));
  }
  return shown;
}

/// Returns how far the tool leaves its path on the way from each row to the next, in mm: one number
/// less than there are rows.
std::vector<double> errors_mm(const Lattice& lattice, const std::vector<Row>& rows) {
  std::vector<double> errors;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    const Config &from = rows[i].at.q, &to = rows[i + 1].at.q;
    double most = 0;
    for (const double error : path_deviation(lattice.chain(), lattice.path_of_rows(),
                                             static_cast<int>(i), from, to - from))
      most = std::max(most, 1e3 * error);
    errors.push_back(most);
  }
  return errors;
}

/// Returns the place of a row in the map.
Json place_json(const Row& row) {
  Json json = {
      {"layer", row.layer}, {"phi", row.at.phi}, {"sheet", row.solution}, {"angle", row.angle}};
  if (row.roll) json["roll"] = *row.roll;
  return json;
}

/// Returns the rows with their clearances, which it asks for. Throws Stopped.
Json rows_json(const World& world, const Lattice& lattice, const std::vector<Row>& shown,
               const Budget& budget) {
  World::Query query(world, DistanceProofs::kOn);
  const std::vector<double> errors = errors_mm(lattice, shown);
  Json rows = Json::array();
  for (std::size_t i = 0; i < shown.size(); ++i) {
    budget.poll();
    const TrajectoryRow& at = shown[i].at;
    Json row = place_json(shown[i]);
    row["s"] = at.s;
    row["q"] = std::vector<double>(at.q.begin(), at.q.end());
    row["error_mm"] = i < errors.size() ? Json(errors[i]) : Json(nullptr);
    if (const auto clearance = query.clearance(at.q)) {
      row["clearance_mm"] = 1e3 * clearance->distance;
      row["pair"] = {world.body_names()[clearance->pair.a], world.body_names()[clearance->pair.b]};
      if (const auto points = query.nearest_points(at.q, *clearance)) {
        row["nearest"] = vector_json((*points)[0]);
        for (const double x : (*points)[1]) row["nearest"].push_back(x);
      } else {
        row["nearest"] = nullptr;
      }
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Returns the path beside which a refined one is drawn.
Json beside_json(const std::vector<Row>& rows) {
  Json json = Json::array();
  for (const Row& row : rows) json.push_back(place_json(row));
  return json;
}

/// Returns a motion over time at as many samples as a plot has room for: the place, in rows; the
/// tool's speed; and for speed, acceleration and jerk, the largest share of a joint's limit since
/// the sample before that is shown, in percent.
Json motion_json(const TimedPath& motion, const JointRates& rates, const Chain& chain,
                 const std::vector<Row>& rows, const ToolPath& path) {
  constexpr std::size_t kMost = 2000;
  const std::vector<TimedRow>& samples = motion.rows;
  const auto n = static_cast<std::ptrdiff_t>(samples.size());
  const auto q = [&](std::ptrdiff_t k) -> const Config& {  // at rest before and after
    return samples[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, n - 1))].row.q;
  };
  const std::ptrdiff_t each = n / static_cast<std::ptrdiff_t>(kMost) + 1;
  Json t = Json::array(), layers = Json::array(), tool = Json::array(),
       ratios[3] = {Json::array(), Json::array(), Json::array()};
  std::size_t step = 0;
  std::array<double, 3> most{};
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    const TrajectoryRow& row = samples[static_cast<std::size_t>(k)].row;
    // The step is found by s, or by the joints where the path only turns.
    double share = 0;
    for (;; ++step) {
      const PathLayer& from = path.layer(static_cast<int>(step));
      const Config way = rows[step + 1].at.q - rows[step].at.q;
      share = from.step_length > 0 ? (row.s - from.s) / from.step_length
                                   : (row.q - rows[step].at.q).dot(way) / way.squaredNorm();
      if (share < 1 || step + 2 >= rows.size()) break;
    }
    const Config move = q(k) - q(k - 1), before = q(k - 1) - q(k - 2), first = q(k - 2) - q(k - 3);
    for (int j = 0; j < kDof; ++j) {
      most[0] = std::max(most[0], std::abs(move[j]) * motion.rate / rates.speed[j]);
      most[1] = std::max(most[1], std::abs(move[j] - before[j]) * std::pow(motion.rate, 2) /
                                      rates.acceleration[j]);
      most[2] = std::max(most[2], std::abs(move[j] - 2 * before[j] + first[j]) *
                                      std::pow(motion.rate, 3) / rates.jerk[j]);
    }
    if (k % each != 0 && k + 1 < n) continue;
    t.push_back(samples[static_cast<std::size_t>(k)].t);
    layers.push_back(static_cast<double>(step) + std::clamp(share, 0.0, 1.0));
    tool.push_back(1e3 * motion.rate *
                   (chain.tool(q(k)).translation() - chain.tool(q(k - 1)).translation()).norm());
    for (std::size_t order = 0; order < 3; ++order) ratios[order].push_back(100 * most[order]);
    most = {};
  }
  return {{"t", std::move(t)},
          {"layers", std::move(layers)},
          {"tool_mm_s", std::move(tool)},
          {"speed", std::move(ratios[0])},
          {"acceleration", std::move(ratios[1])},
          {"jerk", std::move(ratios[2])}};
}

std::string millimetres(double metres) {
  return formatted("%.3g mm", 1e3 * metres);
}

/// The distance of two bodies that are too near, in words, and the line between their nearest
/// points; if they are inside each other, a point of both.
struct Nearness {
  std::string words;
  Json line = nullptr;
};

/// Returns how near two bodies are at joints `q`. `names` are the bodies', which may have several
/// shapes. Empty if none of their shapes is too near or nearest.
Nearness nearness(const World& world, const std::array<std::string, 2>& names, const Config& q) {
  World::Query query(world, DistanceProofs::kOn);
  // Bisection finds the largest depth of a point of one inside the other that is proved.
  constexpr double kDeepest = 0.5, kTelling = 1e-4;  // m
  double depth = 0;
  std::optional<BodyPair> deepest;
  const auto named = [&](const BodyPair& pair) {
    const auto own = world.names(pair);
    return own == names || (own[0] == names[1] && own[1] == names[0]);
  };
  for (const BodyPair& pair : world.pairs()) {
    if (!named(pair) || !query.proves_violation(q, pair, Threshold(-depth))) continue;
    for (double above = kDeepest; above - depth > kTelling;) {
      const double middle = (depth + above) / 2;
      (query.proves_violation(q, pair, Threshold(-middle)) ? depth : above) = middle;
    }
    deepest = pair;
  }
  const auto meeting = [&](const BodyPair& pair, const std::string& words) {
    Nearness meet{words};
    if (const auto point = query.common_point(q, pair)) {
      Json ends = vector_json(*point);
      for (const double x : *point) ends.push_back(x);
      meet.line = {{"points", std::move(ends)}, {"text", words}};
    }
    return meet;
  };
  if (deepest) return meeting(*deepest, "at least " + millimetres(depth) + " inside each other");
  const auto clearance = query.clearance(q);
  if (!clearance || !named(clearance->pair)) return {};
  if (!(clearance->distance > 0)) return meeting(clearance->pair, "they touch");
  Nearness apart{millimetres(clearance->distance) + " apart, asked " +
                 millimetres(clearance->required)};
  if (const auto points = query.nearest_points(q, *clearance)) {
    Json ends = vector_json((*points)[0]);
    for (const double x : (*points)[1]) ends.push_back(x);
    apart.line = {{"points", std::move(ends)}, {"text", millimetres(clearance->distance)}};
  }
  return apart;
}

/// Returns a node's joints `q`, turned by whole turns to come nearest to a row of the path, as the
/// trajectory has them. A joint that such a turn would take out of its limits stays as it is.
Config turned_towards(const Lattice& lattice, const Config& q, const std::vector<Row>& rows,
                      std::size_t row) {
  if (rows.empty()) return q;
  const Config& near = rows[std::min(row, rows.size() - 1)].at.q;
  Config result = near + lattice.delta(near, q);
  for (std::size_t j = 0; j < kDof; ++j) {
    const JointLimit& limit = lattice.chain().limit[j];
    double& x = result[static_cast<Eigen::Index>(j)];
    if (!limit.continuous && (x < limit.lower || x > limit.upper))
      x = q[static_cast<Eigen::Index>(j)];
  }
  return result;
}

/// The place where every path has ended, and what the diagnosis says about it.
struct PathEnd {
  const LatticeMap& map;
  const Lattice& lattice;
  const std::vector<int>& path;  ///< slots of the path to the furthest layer, by layer
  const Json& diagnosis;
  /// Rank of the roll at which the map is drawn, that of the path's last node; nullopt if the tool
  /// may not stand turned.
  std::optional<int> rank;

  /// Returns the first layer that no path reaches.
  [[nodiscard]] int layer() const { return static_cast<int>(map.path.size()); }
  /// Returns the names of the two bodies that ended the paths; null if it was something else.
  [[nodiscard]] Json bodies() const {
    return diagnosis["cause"].is_object() ? diagnosis["cause"]["bodies"] : Json(nullptr);
  }
  /// Returns true if the bodies came too near on the way between two layers, not at a node.
  [[nodiscard]] bool between_layers() const {
    return bodies().is_array() && diagnosis["cause"]["between_layers"];
  }
  [[nodiscard]] std::string reason() const { return diagnosis["reason"]; }
};

/// Returns the rank of the roll of the path's last node, or 0 if the path is empty; nullopt if the
/// tool may not stand turned.
std::optional<int> rank_at_end(const Lattice& lattice, const std::vector<int>& path) {
  if (!may_turn(lattice)) return std::nullopt;
  if (path.empty()) return 0;
  return lattice.grid_place(static_cast<int>(path.size()) - 1, path.back()).rank;
}

/// Returns true if the map draws the node in its cell: at the roll of the path's last node if the
/// tool may stand turned, else the node that the cell shows.
bool is_drawn(const PathEnd& end, const Lattice::Node& node, int cell) {
  const LatticeMap& map = end.map;
  const int layer = end.layer();
  if (end.rank) return end.lattice.grid_place(layer, node.slot).rank == *end.rank;
  const std::size_t cells =
      static_cast<std::size_t>(map.panels()) * static_cast<std::size_t>(map.angles);
  return map.grid() ||
         map.slots[static_cast<std::size_t>(layer) * cells + static_cast<std::size_t>(cell)] ==
             node.slot;
}

/// Returns how far a cell is from another: in cells of the coordinate, plus a whole panel if they
/// are in two panels.
int distance(const LatticeMap& map, int cell, int other) {
  const int away = std::abs(cell % map.angles - other % map.angles);
  return (map.closed ? std::min(away, map.angles - away) : away) +
         (cell / map.angles == other / map.angles ? 0 : map.angles);
}

/// Returns the drawn node of the first layer that no path reaches that is nearest to the path's
/// last node: among those that the bodies of the diagnosis block, or, if there are none, among the
/// others. Returns nullopt if there is no node.
std::optional<Lattice::Node> node_past_end(const PathEnd& end) {
  const LatticeMap& map = end.map;
  const Json bodies = end.bodies();
  const bool at_node = bodies.is_array() && !end.between_layers();
  const int from = map.path.empty() ? 0 : map.path.back();
  std::vector<Lattice::Node> listed;
  end.lattice.layer_nodes(end.layer(), listed);
  const Lattice::Node* best = nullptr;
  int least = 0;
  for (const bool by_bodies : {true, false}) {
    for (const Lattice::Node& candidate : listed) {
      const int cell = map_cell(map, end.lattice, end.layer(), candidate.slot);
      if (!is_drawn(end, candidate, cell)) continue;
      const LatticeMap::Node& node = map.at(end.layer(), cell / map.angles, cell % map.angles);
      const bool blocked = node.state == NodeState::kBlocked && at_node &&
                           bodies[0] == map.blockers[node.cause].first &&
                           bodies[1] == map.blockers[node.cause].second;
      if (blocked != by_bodies) continue;
      const int far = distance(map, cell, from);
      if (!best || far < least) best = &candidate, least = far;
    }
    if (best) break;
  }
  return best ? std::optional(*best) : std::nullopt;
}

/// What keeps a path from its next node: in words, the two bodies, and the line between them.
struct Obstruction {
  std::string what;
  Json pair = nullptr, line = nullptr;
};

/// Returns the words that say which joint would step too far to the node with joints `q`; "" if
/// that is not the cause.
std::string joint_step_words(const PathEnd& end, const Config& q) {
  const Json& diagnosis = end.diagnosis;
  if (!diagnosis["cause"].is_object() || diagnosis["cause"]["cause"] != "joint_step") return "";
  const Config step =
      end.lattice.delta(*end.lattice.exact_config(end.layer() - 1, end.path.back()), q);
  Eigen::Index joint = 0;
  const double most = step.cwiseAbs().maxCoeff(&joint);
  return ", " + end.map.joint_names[joint] + formatted(" by %.2f rad", most);
}

/// Returns what keeps the path from the node past its end, whose joints are `q` and whose state in
/// the map is `node`.
Obstruction obstruction(const PathEnd& end, const LatticeMap::Node& node, const Config& q,
                        const World& world) {
  const LatticeMap& map = end.map;
  if (node.state == NodeState::kBlocked) {
    const auto& [first, second] = map.blockers[node.cause];
    Obstruction blocked{(map.path.empty() ? "a pose of the first layer, blocked by "
                                          : "the next pose is blocked by ") +
                            map.blocker_name(node),
                        {first, second}};
    Nearness near = nearness(world, {first, second}, q);
    if (!near.words.empty()) blocked.what += ": " + near.words;
    blocked.line = std::move(near.line);
    return blocked;
  }
  if (end.between_layers()) {
    const Json pair = end.bodies();
    return {"the way to the next pose is blocked by " + pair[0].get<std::string>() + " - " +
                pair[1].get<std::string>(),
            pair};
  }
  if (map.path.empty()) return {"no valid pose here: " + end.reason()};
  return {"the next pose cannot be moved to: " + end.reason() + joint_step_words(end, q)};
}

/// Returns the place where every path has ended: the node past it that the path's last node would
/// have moved to, and what keeps it from there. Null if there is no such node, or the problem is
/// solved.
Json cut_json(const LatticeMap& map, const Lattice& lattice, const World& world,
              const std::vector<int>& path, const std::vector<Row>& rows, const Json& diagnosis) {
  const PathEnd end{map, lattice, path, diagnosis, rank_at_end(lattice, path)};
  const int layer = end.layer();
  if (layer >= map.layers) return nullptr;
  const auto past = node_past_end(end);
  if (!past) return nullptr;
  const int cell = map_cell(map, lattice, layer, past->slot);
  const Config q =
      turned_towards(lattice, lattice.exact_config(layer, past->slot, past->q).value_or(past->q),
                     rows, rows.size());
  Obstruction by = obstruction(end, map.at(layer, cell / map.angles, cell % map.angles), q, world);
  Json json = {{"layer", layer},
               {"s", lattice.path().layer(layer).s},
               {"phi", lattice.phi(layer, past->slot)},
               {"sheet", cell / map.angles},
               {"angle", map.place(lattice.phi(layer, past->slot))},
               {"q", std::vector<double>(q.begin(), q.end())},
               {"pair", std::move(by.pair)},
               {"line", std::move(by.line)},
               {"what", std::move(by.what)}};
  if (end.rank) json["roll"] = lattice.grid_place(layer, past->slot).roll;
  return json;
}

/// Clearances of cells in tenths of a millimetre and 16 bits; kUnknown where nothing is near or the
/// clearance was not asked for.
class Clearances {
 public:
  /// Prepares for `cells` calls of add().
  Clearances(const World& world, std::size_t cells)
      : query_(world, DistanceProofs::kOn), each_(cells / kMost + 1) {}
  /// Adds the clearance of a posture. Asks for it if `surely`, or if it is the one in so many that
  /// there is time for.
  void add(const Config& q, bool surely) {
    values.push_back(kUnknown);
    if (asked_++ % each_ != 0 && !surely) return;
    if (const auto clearance = query_.clearance(q))
      values.back() = static_cast<std::uint16_t>(
          std::lround(std::clamp(1e4 * clearance->distance, 0.0, kUnknown - 1.0)));
  }
  /// Adds a cell whose clearance is not asked for.
  void skip() { values.push_back(kUnknown); }
  std::vector<std::uint16_t> values;

 private:
  static constexpr std::uint16_t kUnknown = 65535;
  static constexpr std::size_t kMost = 2000;  // a question costs up to a millisecond
  World::Query query_;
  std::size_t each_, asked_ = 0;
};

/// Returns true if the clearance of the node was asked for.
bool looked_at(const LatticeMap::Node& node) {
  return node.state >= NodeState::kFree;
}

/// Returns how many columns of cells each panel of the page's map has at most.
int most_columns(std::size_t panels) {
  constexpr std::size_t kMostCells = 200'000;
  return std::max(100, static_cast<int>(kMostCells / (std::max<std::size_t>(1, panels) * 252)));
}

/// Writes the map for the page: the state of each cell and the posture of one node for each cell.
/// Cells above each other that show the same node share its posture.
class MapWriter {
 public:
  /// `rows`: of the path that is shown; postures turn their joints towards them.
  MapWriter(const LatticeMap& map, const Lattice& lattice, const World& world,
            const std::vector<int>& path, const std::vector<Row>& rows, const Budget& budget)
      : map_(map),
        lattice_(lattice),
        path_(path),
        rows_(rows),
        budget_(budget),
        solutions_(map.inhabited_solutions()),
        cells_(map, most_columns(solutions_.size()), 252),
        turned_(may_turn(lattice)),
        clearances_(world, cells_looked_at()),
        panel_of_(static_cast<std::size_t>(map.panels()), -1) {
    for (const int solution : solutions_) {
      panel_of_[solution] = static_cast<int>(panels_.size());
      panels_.push_back({{"sheet", solution},
                         {"name", map.solution_name(solution)},
                         {"rolls", map.shows_rolls(solution)}});
    }
    for (std::size_t row = 0; row < rows.size(); ++row)
      if (rows[row].layer == static_cast<double>(row_of_layer_.size()))
        row_of_layer_.push_back(row);
  }

  /// Returns the map. Throws Stopped.
  Json write() {
    for (int column = 0; column < cells_.columns; ++column) write_column(column, shown_in(column));
    return json();
  }

 private:
  /// The node that a cell shows; layer -1: none.
  struct Shown {
    int layer = -1, slot = -1;
    double phi = 0, roll = 0;  ///< rad
    Config q;
  };
  /// The cells of a column, by panel and row.
  using Column = std::vector<Shown>;

  [[nodiscard]] std::size_t cells_looked_at() const {
    std::size_t count = 0;
    for (const int solution : solutions_)
      for (int column = 0; column < cells_.columns; ++column)
        for (int row = 0; row < cells_.rows; ++row)
          count += looked_at(cells_.node(solution, column, row));
    return count;
  }

  /// Returns the nodes that a column shows: for each cell the first that looks like the cell.
  Column shown_in(int column) {
    Column shown(solutions_.size() * static_cast<std::size_t>(cells_.rows));
    const int first = column * cells_.layers_each,
              last = std::min(map_.layers, first + cells_.layers_each);
    for (int layer = first; layer < last; ++layer) {
      budget_.poll();
      lattice_.layer_nodes(layer, listed_);
      const bool on_path = layer < static_cast<int>(path_.size());
      if (turned_ && on_path)
        rank_ = lattice_.grid_place(layer, path_[static_cast<std::size_t>(layer)]).rank;
      if (map_.grid())
        offer_grid_nodes(shown, column, layer);
      else
        offer_arc_nodes(shown, column, layer);
      if (map_.turns && on_path) offer_rolls(shown, column, layer);
    }
    return shown;
  }

  /// Offers the nodes of a layer of a grid, at the path's roll if the tool may stand turned.
  void offer_grid_nodes(Column& shown, int column, int layer) const {
    for (const Lattice::Node& node : listed_) {
      if (turned_ && lattice_.grid_place(layer, node.slot).rank != rank_) continue;
      const int cell = map_cell(map_, lattice_, layer, node.slot);
      offer(shown, column, layer, node, cell / map_.angles, cell % map_.angles);
    }
  }
  /// Offers the nodes that the map shows in a layer of a lattice without a grid.
  void offer_arc_nodes(Column& shown, int column, int layer) const {
    const int panel_cells = map_.panels() * map_.angles;
    for (int cell = 0; cell < panel_cells; ++cell)
      if (const int slot = map_.slots[static_cast<std::size_t>(layer) * panel_cells + cell];
          slot >= 0)
        offer(shown, column, layer, listed_[static_cast<std::size_t>(slot)], cell / map_.angles,
              cell % map_.angles);
  }
  /// Offers the nodes of the panel of rolls in a layer that the path reaches.
  void offer_rolls(Column& shown, int column, int layer) const {
    const std::vector<int> slots =
        slots_of_rolls(lattice_, layer, path_[static_cast<std::size_t>(layer)], map_.angles);
    for (int k = 0; k < map_.angles; ++k) {
      const auto at =
          std::lower_bound(listed_.begin(), listed_.end(), slots[static_cast<std::size_t>(k)],
                           [](const Lattice::Node& node, int slot) { return node.slot < slot; });
      if (at != listed_.end() && at->slot == slots[static_cast<std::size_t>(k)])
        offer(shown, column, layer, *at, map_.solutions(), k);
    }
  }

  /// Shows a node in its cell if the cell shows none yet and looks like the node.
  void offer(Column& shown, int column, int layer, const Lattice::Node& node, int solution,
             int angle) const {
    const int row = angle / cells_.angles_each, k = panel_of_[solution] * cells_.rows + row;
    if (panel_of_[solution] < 0 || shown[k].layer >= 0 ||
        map_.at(layer, solution, angle) != cells_.node(solution, column, row))
      return;
    const auto near = static_cast<std::size_t>(layer);
    const Config q =
        turned_towards(lattice_, lattice_.exact_config(layer, node.slot, node.q).value_or(node.q),
                       rows_, near < row_of_layer_.size() ? row_of_layer_[near] : rows_.size());
    const double roll =
        turned_ ? roll_between(lattice_.path().layer(layer).tool, lattice_.chain().tool(q)) : 0;
    shown[k] = {layer, node.slot, lattice_.phi(layer, node.slot), roll, q};
  }

  /// Appends states, postures and clearances of a column's cells.
  void write_column(int column, const Column& shown) {
    std::size_t k = 0;
    for (const int solution : solutions_)
      for (int row = 0; row < cells_.rows; ++row, ++k) {
        const LatticeMap::Node cell = cells_.node(solution, column, row);
        const bool posed = shown[k].layer >= 0, is_again = posed && row > 0 &&
                                                           shown[k].slot == shown[k - 1].slot &&
                                                           shown[k].layer == shown[k - 1].layer;
        states_.push_back(
            static_cast<std::uint8_t>(static_cast<unsigned>(cell.state) | (is_again ? 32u : 0u) |
                                      (cell.proved ? 64u : 0u) | (posed ? 128u : 0u)));
        causes_.push_back(cell.cause);
        if (!posed || is_again) continue;
        budget_.poll();
        if (looked_at(cell))
          clearances_.add(shown[k].q,
                          cells_.on_path(solution, column, row) || is_of_path(shown[k]));
        else
          clearances_.skip();
        poses_.push_back(shown[k]);
        poses_.back().layer -= column * cells_.layers_each;
      }
  }
  [[nodiscard]] bool is_of_path(const Shown& pose) const {
    const auto layer = static_cast<std::size_t>(pose.layer);
    return layer < path_.size() && path_[layer] == pose.slot;
  }

  /// Returns all that was appended, with the postures' joints in 16 bits, which is enough to draw.
  Json json() {
    double reach = 1;  // rad, of the largest number in 16 bits
    for (const Shown& pose : poses_) reach = std::max(reach, pose.q.cwiseAbs().maxCoeff());
    std::vector<std::int16_t> joints;
    std::vector<std::uint16_t> layers;
    std::vector<float> phis, rolls;
    for (const Shown& pose : poses_) {
      for (const double q : pose.q)
        joints.push_back(static_cast<std::int16_t>(std::lround(q / reach * 32767)));
      layers.push_back(static_cast<std::uint16_t>(pose.layer));
      phis.push_back(static_cast<float>(pose.phi));
      if (turned_) rolls.push_back(static_cast<float>(pose.roll));
    }
    return {{"layers", map_.layers},
            {"angles", map_.angles},
            {"columns", cells_.columns},
            {"rows", cells_.rows},
            {"layers_each", cells_.layers_each},
            {"angles_each", cells_.angles_each},
            {"coordinate", map_.coordinate_name()},
            {"letter", map_.letter(0)},
            {"low", map_.low},
            {"step", map_.step},
            {"closed", map_.closed},
            {"arcs", !map_.grid()},
            {"nothing", map_.emptiness()},
            {"panels", std::move(panels_)},
            {"states", base64(states_)},
            {"causes", base64(causes_)},
            {"joints", base64(joints)},
            {"clearances", base64(clearances_.values)},
            {"joint_unit", reach / 32767},
            {"pose_layers", base64(layers)},
            {"pose_phis", base64(phis)},
            {"pose_rolls", base64(rolls)},
            {"blockers", map_.blockers},
            {"complete", map_.complete},
            {"s", map_.s}};
  }

  const LatticeMap& map_;
  const Lattice& lattice_;
  const std::vector<int>& path_;
  const std::vector<Row>& rows_;
  const Budget& budget_;
  const std::vector<int> solutions_;  ///< whose panels are written
  const MapCells cells_;
  const bool turned_;  ///< the tool may stand turned
  Clearances clearances_;
  std::vector<int> panel_of_;  ///< by solution; -1: not written
  Json panels_ = Json::array();
  std::vector<std::size_t> row_of_layer_;  ///< by layer of the lattice, as far as there are rows
  std::vector<Lattice::Node> listed_;      ///< nodes of the layer
  int rank_ = 0;  ///< of the roll that the path has in the layer, or had last
  std::vector<std::uint8_t> states_, causes_;  ///< of all cells
  std::vector<Shown> poses_;                   ///< layers counted from the cell's first
};

/// Returns the text with its lines escaped for HTML.
std::string escaped_lines(const std::string& text) {
  std::istringstream lines(text);
  std::string result;
  for (std::string line; std::getline(lines, line);) result += escaped(line) + '\n';
  return result;
}

}  // namespace

bool page_available() {
  return !page_template().empty();
}

std::string to_page(const PlanView& view, const LatticeMap& map, const std::string& result_json,
                    const PageMotion& motion, const Budget& budget, const PageWords& words) {
  const Problem& problem = view.problem;
  const World& world = view.world;
  const Lattice& lattice = view.lattice;
  Json result = Json::parse(result_json);
  const Json& diagnosis = result["diagnosis"];
  Bodies bodies(world, problem.scene);
  std::vector<TrajectoryRow> trajectory;
  for (std::vector<int> slots = view.path; !slots.empty() && trajectory.empty(); slots.pop_back())
    trajectory = lattice.path_rows(
        slots);  // of a path that may end anywhere: as far as its joints stay within their limits
  const std::vector<Row> found = placed(lattice, map, trajectory, view.path);
  const std::vector<Row> rows =
      motion.refined ? placed(lattice, map, *motion.refined, view.path) : found;
  const ToolPath& every = lattice.path_of_rows();
  Json tool_path = Json::array();
  for (int layer = 0; layer < every.size(); ++layer)
    tool_path.push_back(vector_json(every.layer(layer).tool.translation()));

  const std::string name = std::filesystem::path(problem.source).filename().string();
  const std::string title = words.which.empty() ? name : name + ", " + words.which;
  const Json data = {
      {"problem", name},
      {"which", words.which},
      {"result", result},
      {"settings",
       {{"ds", problem.resolution.ds},
        {"dphi", problem.resolution.dphi},
        {"clearance_mm", 1e3 * problem.limits.clearance},
        {"joint_step",
         lattice.has_layers_between() ? Json(nullptr) : Json(problem.limits.joint_step)},
        {"edges", problem.limits.edges == EdgeMode::kContinuous ? "continuous" : "nodes"}}},
      {"chain", chain_json(lattice.chain())},
      {"bodies", std::move(bodies.bodies)},
      {"meshes", std::move(bodies.meshes)},
      {"tool_path", std::move(tool_path)},
      {"rows", rows_json(world, lattice, rows, budget)},
      {"beside", motion.refined ? beside_json(found) : Json::array()},
      {"motion", motion.motion
                     ? motion_json(*motion.motion,
                                   joint_rates(lattice.chain(), problem.limits, problem.source),
                                   lattice.chain(), rows, every)
                     : Json(nullptr)},
      {"cut", diagnosis.is_object() ? cut_json(map, lattice, world, view.path, rows, diagnosis)
                                    : Json(nullptr)},
      {"map", MapWriter(map, lattice, world, view.path, rows, budget).write()}};
  return fill(
      page_template(), data.dump(-1, ' ', false, Json::error_handler_t::replace),
      {{"@@ANSWER@@", escaped_lines(title + "\n\n" + words.answer)}, {"@@MAP@@", to_svg(map)}});
}

}  // namespace swivel
