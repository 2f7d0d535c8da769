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
  double layer = 0;  ///< of the lattice; between two of them where only every so many layers of the
                     ///< path are layers of the lattice
  int solution = 0;
  double angle = 0;              ///< in cells
  std::optional<double> roll{};  ///< rad
};

/// Whether the tool may stand turned, so that nodes have rolls.
bool may_turn(const Lattice& lattice) {
  const auto grid = lattice.describe().grid;
  return grid && grid->rolls;
}

/// `rows`: of the path's layers, from the first on. Their IK solutions are mostly those of the
/// lattice's path (`slots`); where their branch is another, those of the nodes that are nearest.
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

/// How far the tool leaves its path on the way from each row to the next, mm; one less than there
/// are rows.
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

/// Where a row is in the map.
Json place_json(const Row& row) {
  Json json = {
      {"layer", row.layer}, {"phi", row.at.phi}, {"sheet", row.solution}, {"angle", row.angle}};
  if (row.roll) json["roll"] = *row.roll;
  return json;
}

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

/// The path beside which a refined one is drawn.
Json beside_json(const std::vector<Row>& rows) {
  Json json = Json::array();
  for (const Row& row : rows) json.push_back(place_json(row));
  return json;
}

/// A motion over time, at as many samples as a plot has room for: where it is, in rows; the tool's
/// speed; the largest share of what a joint can do since the sample shown before, of speed,
/// acceleration and jerk.
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
    // s tells the step; where the path only turns the joints do.
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

/// How near two bodies are that are too near, in words, and the line between their nearest points;
/// where they are inside each other, a point of both.
struct Nearness {
  std::string words;
  Json line = nullptr;
};

/// Of two bodies by name, which may have several shapes.
Nearness nearness(const World& world, const std::array<std::string, 2>& names, const Config& q) {
  World::Query query(world, DistanceProofs::kOn);
  // The largest depth that is proved, by bisection: of a point of one inside the other.
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

/// A node's joints with those turns of continuous and wide joints that come nearest to a row of the
/// path, as the trajectory has them; a joint that they would take out of its limits stays as it is.
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

/// Where every path has ended: the node past it that the path's last would have moved to. It is
/// blocked by what the diagnosis names; where that is no pair of bodies, it is the next node that
/// exists. Null where there is none, or the problem is solved.
Json cut_json(const LatticeMap& map, const Lattice& lattice, const World& world,
              const std::vector<int>& path, const std::vector<Row>& rows, const Json& diagnosis) {
  const int layer = static_cast<int>(map.path.size());
  if (layer >= map.layers) return nullptr;
  const std::string reason = diagnosis["reason"];
  const Json bodies = diagnosis["cause"].is_object() ? diagnosis["cause"]["bodies"] : Json(nullptr);
  const bool motion = bodies.is_array() && diagnosis["cause"]["between_layers"];
  const int from = map.path.empty() ? 0 : map.path.back();  // a cell
  std::vector<Lattice::Node> listed;
  lattice.layer_nodes(layer, listed);
  const bool turned = may_turn(lattice);
  const int rank = turned && !path.empty() ? lattice.grid_place(layer - 1, path.back()).rank
                                           : 0;  // at which the map is drawn
  const auto is_drawn = [&](const Lattice::Node& node, int cell) {
    if (turned) return lattice.grid_place(layer, node.slot).rank == rank;
    const std::size_t cells =
        static_cast<std::size_t>(map.panels()) * static_cast<std::size_t>(map.angles);
    return map.grid() ||
           map.slots[static_cast<std::size_t>(layer) * cells + static_cast<std::size_t>(cell)] ==
               node.slot;
  };
  const Lattice::Node* best = nullptr;
  int least = 0;
  for (const bool by_bodies : {true, false}) {
    for (const Lattice::Node& candidate : listed) {
      const int cell = map_cell(map, lattice, layer, candidate.slot), solution = cell / map.angles,
                angle = cell % map.angles;
      if (!is_drawn(candidate, cell)) continue;
      const LatticeMap::Node& node = map.at(layer, solution, angle);
      const bool blocked = node.state == NodeState::kBlocked && bodies.is_array() && !motion &&
                           bodies[0] == map.blockers[node.cause].first &&
                           bodies[1] == map.blockers[node.cause].second;
      if (blocked != by_bodies) continue;
      const int away = std::abs(angle - from % map.angles);
      const int far = (map.closed ? std::min(away, map.angles - away) : away) +
                      (solution == from / map.angles ? 0 : map.angles);
      if (!best || far < least) best = &candidate, least = far;
    }
    if (best) break;
  }
  if (!best) return nullptr;
  const int cell = map_cell(map, lattice, layer, best->slot);
  const LatticeMap::Node& node = map.at(layer, cell / map.angles, cell % map.angles);
  const Config q =
      turned_towards(lattice, lattice.exact_config(layer, best->slot, best->q).value_or(best->q),
                     rows, rows.size());
  std::string what = "no valid pose here: " + reason;
  Json pair = nullptr, line = nullptr;
  if (node.state == NodeState::kBlocked) {
    const auto& [first, second] = map.blockers[node.cause];
    pair = {first, second};
    what = (map.path.empty() ? "a pose of the first layer, blocked by "
                             : "the next pose is blocked by ") +
           map.blocker_name(node);
    Nearness near = nearness(world, {first, second}, q);
    if (!near.words.empty()) what += ": " + near.words;
    line = std::move(near.line);
  } else if (motion) {
    pair = bodies;
    what = "the way to the next pose is blocked by " + pair[0].get<std::string>() + " - " +
           pair[1].get<std::string>();
  } else if (!map.path.empty()) {
    what = "the next pose cannot be moved to: " + reason;
    if (diagnosis["cause"].is_object() && diagnosis["cause"]["cause"] == "joint_step") {
      const Config step = lattice.delta(*lattice.exact_config(layer - 1, path.back()), q);
      Eigen::Index joint = 0;
      const double most = step.cwiseAbs().maxCoeff(&joint);
      const std::string text = formatted(" by %.2f rad", most);
      what += ", " + map.joint_names[joint] + text;
    }
  }
  Json json = {{"layer", layer},
               {"s", lattice.path().layer(layer).s},
               {"phi", lattice.phi(layer, best->slot)},
               {"sheet", cell / map.angles},
               {"angle", map.place(lattice.phi(layer, best->slot))},
               {"q", std::vector<double>(q.begin(), q.end())},
               {"pair", std::move(pair)},
               {"line", std::move(line)},
               {"what", std::move(what)}};
  if (turned) json["roll"] = lattice.grid_place(layer, best->slot).roll;
  return json;
}

/// Clearances of cells, in tenths of a millimetre and 16 bits; `kUnknown` where nothing is near or
/// nobody asked.
class Clearances {
 public:
  Clearances(const World& world, std::size_t cells)
      : query_(world, DistanceProofs::kOn), each_(cells / kMost + 1) {}
  void add(const Config& q, bool surely) {
    values.push_back(kUnknown);
    if (asked_++ % each_ != 0 && !surely) return;
    if (const auto clearance = query_.clearance(q))
      values.back() = static_cast<std::uint16_t>(
          std::lround(std::clamp(1e4 * clearance->distance, 0.0, kUnknown - 1.0)));
  }
  void skip() { values.push_back(kUnknown); }
  std::vector<std::uint16_t> values;

 private:
  static constexpr std::uint16_t kUnknown = 65535;
  static constexpr std::size_t kMost = 2000;  // a question costs up to a millisecond
  World::Query query_;
  std::size_t each_, asked_ = 0;  // one cell in so many is asked about, and those of the path
};

/// One node for each shown cell, once for those above each other that show the same: its joints in
/// 16 bits, for drawing, its layer (counted from the cell's first), phi and roll.
Json map_json(const LatticeMap& map, const Lattice& lattice, const World& world,
              const std::vector<int>& path, const std::vector<Row>& rows, const Budget& budget) {
  constexpr std::size_t kMostCells = 200'000;
  const std::vector<int> solutions = map.inhabited_solutions();
  const auto most_columns =
      static_cast<int>(kMostCells / (std::max<std::size_t>(1, solutions.size()) * 252));
  const MapCells cells(map, std::max(100, most_columns), 252);
  struct Shown {
    int layer = -1, slot = -1;
    double phi = 0, roll = 0;
    Config q;
  };
  std::vector<Shown> poses;
  std::vector<std::uint8_t> states, causes;
  const auto looked_at = [](const LatticeMap::Node& node) {
    return node.state >= NodeState::kFree;
  };
  std::size_t asked = 0;
  for (const int solution : solutions)
    for (int column = 0; column < cells.columns; ++column)
      for (int row = 0; row < cells.rows; ++row)
        asked += looked_at(cells.node(solution, column, row));
  Clearances clearances(world, asked);
  std::vector<Lattice::Node> listed;
  std::vector<int> panel_of(map.panels(), -1);
  Json panels = Json::array();
  for (const int solution : solutions) {
    panel_of[solution] = static_cast<int>(panels.size());
    panels.push_back({{"sheet", solution},
                      {"name", map.solution_name(solution)},
                      {"rolls", map.shows_rolls(solution)}});
  }
  std::vector<std::size_t> row_of_layer;
  for (std::size_t row = 0; row < rows.size(); ++row)
    if (rows[row].layer == static_cast<double>(row_of_layer.size())) row_of_layer.push_back(row);
  const bool turned = may_turn(lattice);
  int rank = 0;  // of the roll that the path has, as in make_map()
  for (int column = 0; column < cells.columns; ++column) {
    const int first = column * cells.layers_each,
              last = std::min(map.layers, first + cells.layers_each);
    std::vector<Shown> shown(solutions.size() * static_cast<std::size_t>(cells.rows));
    for (int layer = first; layer < last; ++layer) {
      budget.poll();
      lattice.layer_nodes(layer, listed);
      const auto show = [&](const Lattice::Node& node, int solution, int angle) {
        const int row = angle / cells.angles_each, k = panel_of[solution] * cells.rows + row;
        if (panel_of[solution] < 0 || shown[k].layer >= 0 ||
            map.at(layer, solution, angle) != cells.node(solution, column, row))
          return;
        const auto near = static_cast<std::size_t>(layer);
        const Config q =
            turned_towards(lattice, lattice.exact_config(layer, node.slot, node.q).value_or(node.q),
                           rows, near < row_of_layer.size() ? row_of_layer[near] : rows.size());
        const double roll =
            turned ? roll_between(lattice.path().layer(layer).tool, lattice.chain().tool(q)) : 0;
        shown[k] = {layer, node.slot, lattice.phi(layer, node.slot), roll, q};
      };
      const bool on_path = layer < static_cast<int>(path.size());
      if (turned && on_path)
        rank = lattice.grid_place(layer, path[static_cast<std::size_t>(layer)]).rank;
      const int panel_cells = map.panels() * map.angles;
      for (int cell = 0; cell < panel_cells && !map.grid(); ++cell)
        if (const int slot = map.slots[static_cast<std::size_t>(layer) * panel_cells + cell];
            slot >= 0)
          show(listed[static_cast<std::size_t>(slot)], cell / map.angles, cell % map.angles);
      for (const Lattice::Node& node : listed) {
        if (!map.grid() || (turned && lattice.grid_place(layer, node.slot).rank != rank)) continue;
        const int cell = map_cell(map, lattice, layer, node.slot);
        show(node, cell / map.angles, cell % map.angles);
      }
      if (!map.turns || !on_path) continue;
      const std::vector<int> slots =
          slots_of_rolls(lattice, layer, path[static_cast<std::size_t>(layer)], map.angles);
      for (int k = 0; k < map.angles; ++k) {
        const auto at =
            std::lower_bound(listed.begin(), listed.end(), slots[static_cast<std::size_t>(k)],
                             [](const Lattice::Node& node, int slot) { return node.slot < slot; });
        if (at != listed.end() && at->slot == slots[static_cast<std::size_t>(k)])
          show(*at, map.solutions(), k);
      }
    }
    const auto is_of_path = [&](const Shown& pose) {
      const auto layer = static_cast<std::size_t>(pose.layer);
      return layer < path.size() && path[layer] == pose.slot;
    };
    std::size_t k = 0;
    for (const int solution : solutions)
      for (int row = 0; row < cells.rows; ++row, ++k) {
        const LatticeMap::Node cell = cells.node(solution, column, row);
        const bool posed = shown[k].layer >= 0, is_again = posed && row > 0 &&
                                                           shown[k].slot == shown[k - 1].slot &&
                                                           shown[k].layer == shown[k - 1].layer;
        states.push_back(static_cast<std::uint8_t>(static_cast<unsigned>(cell.state) |
                                                   (is_again ? 32u : 0u) |
                                                   (cell.proved ? 64u : 0u) | (posed ? 128u : 0u)));
        causes.push_back(cell.cause);
        if (!posed || is_again) continue;
        budget.poll();
        if (looked_at(cell))
          clearances.add(shown[k].q, cells.on_path(solution, column, row) || is_of_path(shown[k]));
        else
          clearances.skip();
        poses.push_back(shown[k]);
        poses.back().layer -= first;
      }
  }
  double reach = 1;  // rad, for 16 bits
  for (const Shown& pose : poses) reach = std::max(reach, pose.q.cwiseAbs().maxCoeff());
  std::vector<std::int16_t> joints;
  std::vector<std::uint16_t> layers;
  std::vector<float> phis, rolls;
  for (const Shown& pose : poses) {
    for (const double q : pose.q)
      joints.push_back(static_cast<std::int16_t>(std::lround(q / reach * 32767)));
    layers.push_back(static_cast<std::uint16_t>(pose.layer));
    phis.push_back(static_cast<float>(pose.phi));
    if (turned) rolls.push_back(static_cast<float>(pose.roll));
  }
  return {{"layers", map.layers},
          {"angles", map.angles},
          {"columns", cells.columns},
          {"rows", cells.rows},
          {"layers_each", cells.layers_each},
          {"angles_each", cells.angles_each},
          {"coordinate", map.coordinate_name()},
          {"letter", map.letter(0)},
          {"low", map.low},
          {"step", map.step},
          {"closed", map.closed},
          {"arcs", !map.grid()},
          {"nothing", map.emptiness()},
          {"panels", std::move(panels)},
          {"states", base64(states)},
          {"causes", base64(causes)},
          {"joints", base64(joints)},
          {"clearances", base64(clearances.values)},
          {"joint_unit", reach / 32767},
          {"pose_layers", base64(layers)},
          {"pose_phis", base64(phis)},
          {"pose_rolls", base64(rolls)},
          {"blockers", map.blockers},
          {"complete", map.complete},
          {"s", map.s}};
}

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
      {"map", map_json(map, lattice, world, view.path, rows, budget)}};
  return fill(
      page_template(), data.dump(-1, ' ', false, Json::error_handler_t::replace),
      {{"@@ANSWER@@", escaped_lines(title + "\n\n" + words.answer)}, {"@@MAP@@", to_svg(map)}});
}

}  // namespace swivel
