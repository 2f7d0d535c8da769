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
#include "swivel/collision/world.hpp"
#include "swivel/core/angle.hpp"
#include "swivel/core/formatted.hpp"
#include "swivel/core/input_error.hpp"
#include "swivel/core/make_lattice.hpp"
#include "swivel/core/roll_lattice.hpp"
#include "swivel/core/srs_lattice.hpp"

namespace swivel {

using namespace detail;

namespace {

/// A row of the page: of the lattice, or off its grid.
struct Row {
  Config q;
  double phi = 0, angle = 0;  ///< angle: in cells
  int sheet = 0;
  std::optional<double> roll = {};  ///< rad
};

/// The answer layer by layer, or the way to the furthest layer.
std::vector<Row> lattice_rows(const Lattice& lattice, const LatticeMap& map, const std::vector<int>& slots) {
  std::vector<Row> rows;
  for (int layer = 0; layer < static_cast<int>(slots.size()); ++layer) {
    const int slot = slots[static_cast<std::size_t>(layer)];
    const int cell = map.path[static_cast<std::size_t>(layer)];
    Row row{*lattice.row(layer, slot), lattice.phi(layer, slot), static_cast<double>(cell % map.angles), cell / map.angles};
    if (const auto* rolls = dynamic_cast<const RollLattice*>(&lattice)) row.roll = rolls->roll(layer, slot);
    if (!rows.empty())
      row.q = rows.back().q + lattice.delta(rows.back().q, row.q);  // unwraps continuous joints, as the trajectory does
    rows.push_back(row);
  }
  return rows;
}

/// Of a refined path. Its sheets are mostly those of the path that it comes from, else of the nodes that are nearest.
std::vector<Row> refined_rows(const Lattice& lattice, const LatticeMap& map, const std::vector<TrajectoryRow>& refined,
                              const std::vector<int>& slots) {
  const auto* grid = dynamic_cast<const SrsLattice*>(&lattice);
  std::vector<Row> rows;
  LayerNodes nodes;
  for (int layer = 0; layer < static_cast<int>(refined.size()); ++layer) {
    const TrajectoryRow& from = refined[static_cast<std::size_t>(layer)];
    const double angle = (wrap_angle(from.phi) + kPi) / kTwoPi * map.angles;
    Row row{from.q, from.phi, angle, grid ? grid->sheet_of(slots[static_cast<std::size_t>(layer)]) : from.branch};
    if (grid && row.sheet / grid->windings() != from.branch) {
      grid->solve(layer, nodes);
      const int cell = static_cast<int>(std::lround(angle)) % grid->angles();
      double least = std::numeric_limits<double>::infinity();
      row.sheet = from.branch * grid->windings();
      for (int sheet = row.sheet, end = sheet + grid->windings(); sheet < end; ++sheet) {
        if (!nodes.valid(sheet, cell)) continue;
        const double away = (nodes.config(sheet, cell) - from.q).norm();
        if (away < least) least = away, row.sheet = sheet;
      }
    }
    rows.push_back(row);
  }
  return rows;
}

/// How far the tool leaves its path on the way to each layer, mm.
std::vector<double> errors_mm(const Lattice& lattice, const std::vector<Row>& shown, const std::vector<TrajectoryRow>& rows) {
  std::vector<double> errors(shown.size(), 0);
  const auto add = [&](std::size_t layer, int step, const Config& from, const Config& to) {
    for (const double error : path_deviation(lattice.chain(), lattice.path_of_rows(), step, from, to - from))
      errors[layer] = std::max(errors[layer], 1e3 * error);
  };
  if (const auto* rolls = dynamic_cast<const RollLattice*>(&lattice)) {
    for (std::size_t layer = 1; layer < shown.size(); ++layer)
      for (int i = rolls->knots()[layer - 1]; i < rolls->knots()[layer]; ++i)
        add(layer, i, rows[static_cast<std::size_t>(i)].q, rows[static_cast<std::size_t>(i) + 1].q);
  } else {
    for (std::size_t layer = 1; layer < shown.size(); ++layer)
      add(layer, static_cast<int>(layer) - 1, shown[layer - 1].q, shown[layer].q);
  }
  return errors;
}

Json rows_json(const World& world, const Lattice& lattice, const std::vector<Row>& shown, const std::vector<double>& errors,
               const Budget& budget) {
  World::Query query(world, Certificates::kOn);
  Json rows = Json::array();
  for (int layer = 0; layer < static_cast<int>(shown.size()); ++layer) {
    budget.poll();
    const Row& at = shown[static_cast<std::size_t>(layer)];
    Json error = nullptr;
    if (layer > 0) error = errors[static_cast<std::size_t>(layer)];
    Json row = {{"layer", layer},
                {"s", lattice.path().layer(layer).s},
                {"phi", at.phi},
                {"sheet", at.sheet},
                {"angle", at.angle},
                {"q", std::vector<double>(at.q.begin(), at.q.end())},
                {"error_mm", std::move(error)}};
    if (at.roll) row["roll"] = *at.roll;
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
  for (std::size_t layer = 0; layer < rows.size(); ++layer) {
    json.push_back({{"layer", layer}, {"sheet", rows[layer].sheet}, {"angle", rows[layer].angle}});
    if (rows[layer].roll) json.back()["roll"] = *rows[layer].roll;
  }
  return json;
}

/// A motion over time, at as many samples as a plot has room for: where it is, in layers; the tool's speed; the largest share of
/// what a joint can do since the sample shown before, of speed, acceleration and jerk.
Json motion_json(const TimedPath& motion, const JointRates& rates, const Chain& chain, const std::vector<Row>& rows,
                 const ToolPath& path) {
  constexpr std::size_t kMost = 2000;
  const std::vector<TimedRow>& samples = motion.rows;
  const auto n = static_cast<std::ptrdiff_t>(samples.size());
  const auto q = [&](std::ptrdiff_t k) -> const Config& {  // at rest before and after
    return samples[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, n - 1))].row.q;
  };
  const std::ptrdiff_t each = n / static_cast<std::ptrdiff_t>(kMost) + 1;
  Json t = Json::array(), layers = Json::array(), tool = Json::array(), ratios[3] = {Json::array(), Json::array(), Json::array()};
  std::size_t step = 0;
  std::array<double, 3> most{};
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    const TrajectoryRow& row = samples[static_cast<std::size_t>(k)].row;
    // s tells the step; where the path only turns the joints do.
    double share = 0;
    for (;; ++step) {
      const PathLayer& from = path.layer(static_cast<int>(step));
      const Config way = rows[step + 1].q - rows[step].q;
      share = from.step_length > 0 ? (row.s - from.s) / from.step_length : (row.q - rows[step].q).dot(way) / way.squaredNorm();
      if (share < 1 || step + 2 >= rows.size()) break;
    }
    const Config move = q(k) - q(k - 1), before = q(k - 1) - q(k - 2), first = q(k - 2) - q(k - 3);
    for (int j = 0; j < kDof; ++j) {
      most[0] = std::max(most[0], std::abs(move[j]) * motion.rate / rates.speed[j]);
      most[1] = std::max(most[1], std::abs(move[j] - before[j]) * std::pow(motion.rate, 2) / rates.acceleration[j]);
      most[2] = std::max(most[2], std::abs(move[j] - 2 * before[j] + first[j]) * std::pow(motion.rate, 3) / rates.jerk[j]);
    }
    if (k % each != 0 && k + 1 < n) continue;
    t.push_back(samples[static_cast<std::size_t>(k)].t);
    layers.push_back(static_cast<double>(step) + std::clamp(share, 0.0, 1.0));
    tool.push_back(1e3 * motion.rate * (chain.tool(q(k)).translation() - chain.tool(q(k - 1)).translation()).norm());
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

/// How near two bodies are that are too near, in words, and the line between their nearest points; where they are inside each
/// other, a point of both.
struct Nearness {
  std::string words;
  Json line = nullptr;
};

/// Of two bodies by name, which may have several shapes.
Nearness nearness(const World& world, const std::array<std::string, 2>& names, const Config& q) {
  World::Query query(world, Certificates::kOn);
  // The largest depth that is proved, by bisection: of a point of one inside the other.
  constexpr double kDeepest = 0.5, kTelling = 1e-4;  // m
  double depth = 0;
  std::optional<BodyPair> deepest;
  const auto named = [&](const BodyPair& pair) {
    const auto own = world.names(pair);
    return own == names || (own[0] == names[1] && own[1] == names[0]);
  };
  for (const BodyPair& pair : world.pairs()) {
    if (!named(pair) || !query.surely_below(q, pair, Level(-depth))) continue;
    for (double above = kDeepest; above - depth > kTelling;) {
      const double middle = (depth + above) / 2;
      (query.surely_below(q, pair, Level(-middle)) ? depth : above) = middle;
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
  Nearness apart{millimetres(clearance->distance) + " apart, asked " + millimetres(clearance->required)};
  if (const auto points = query.nearest_points(q, *clearance)) {
    Json ends = vector_json((*points)[0]);
    for (const double x : (*points)[1]) ends.push_back(x);
    apart.line = {{"points", std::move(ends)}, {"text", millimetres(clearance->distance)}};
  }
  return apart;
}

/// Where every path has ended: the node past it that the path's last would have moved to. It is blocked by what the diagnosis
/// names; where that is no pair of bodies, it is the next node that exists. Null where there is none, or the problem is solved.
Json cut_json(const LatticeMap& map, const Lattice& lattice, const World& world, const std::vector<int>& path,
              const Json& diagnosis) {
  const int layer = static_cast<int>(map.path.size());
  if (layer >= map.layers) return nullptr;
  const std::string reason = diagnosis["reason"];
  const Json bodies = diagnosis["cause"].is_object() ? diagnosis["cause"]["bodies"] : Json(nullptr);
  const bool motion = bodies.is_array() && diagnosis["cause"]["between_layers"];
  const int from = map.path.empty() ? 0 : map.path.back();  // a cell
  std::vector<Lattice::Node> listed;
  lattice.layer_nodes(layer, listed);
  const Lattice::Node* best = nullptr;
  int least = 0;
  for (const bool by_bodies : {true, false}) {
    for (const Lattice::Node& candidate : listed) {
      const int cell = map_cell(lattice, layer, candidate.slot), sheet = cell / map.angles, angle = cell % map.angles;
      const LatticeMap::Node& node = map.at(layer, sheet, angle);
      const bool blocked = node.state == NodeState::kBlocked && bodies.is_array() && !motion &&
                           bodies[0] == map.blockers[node.cause].first && bodies[1] == map.blockers[node.cause].second;
      if (blocked != by_bodies) continue;
      const int away = std::abs(angle - from % map.angles);
      const int far = std::min(away, map.angles - away) + (sheet == from / map.angles ? 0 : map.angles);
      if (!best || far < least) best = &candidate, least = far;
    }
    if (best) break;
  }
  if (!best) return nullptr;
  const int cell = map_cell(lattice, layer, best->slot);
  const LatticeMap::Node& node = map.at(layer, cell / map.angles, cell % map.angles);
  const Config q = lattice.row(layer, best->slot, best->q).value_or(best->q);
  std::string what = "no valid pose here: " + reason;
  Json pair = nullptr, line = nullptr;
  if (node.state == NodeState::kBlocked) {
    const auto& [first, second] = map.blockers[node.cause];
    pair = {first, second};
    what = (map.path.empty() ? "a pose of the first layer, blocked by " : "the next pose is blocked by ") + map.blocker_name(node);
    Nearness near = nearness(world, {first, second}, q);
    if (!near.words.empty()) what += ": " + near.words;
    line = std::move(near.line);
  } else if (motion) {
    pair = bodies;
    what = "the way to the next pose is blocked by " + pair[0].get<std::string>() + " - " + pair[1].get<std::string>();
  } else if (!map.path.empty()) {
    what = "the next pose cannot be moved to: " + reason;
    if (diagnosis["cause"].is_object() && diagnosis["cause"]["cause"] == "joint_step") {
      const Config step = lattice.delta(*lattice.row(layer - 1, path.back()), q);
      Eigen::Index joint = 0;
      const double most = step.cwiseAbs().maxCoeff(&joint);
      const std::string text = formatted(" by %.2f rad", most);
      what += ", " + map.joint_names[joint] + text;
    }
  }
  return {{"layer", layer},
          {"s", lattice.path().layer(layer).s},
          {"phi", lattice.phi(layer, best->slot)},
          {"q", std::vector<double>(q.begin(), q.end())},
          {"pair", std::move(pair)},
          {"line", std::move(line)},
          {"what", std::move(what)}};
}

/// Clearances of cells, in tenths of a millimetre and 16 bits; `kUnknown` where nothing is near or nobody asked.
class Clearances {
 public:
  Clearances(const World& world, std::size_t cells) : query_(world, Certificates::kOn), each_(cells / kMost + 1) {}
  void add(const Config& q, bool surely) {
    values.push_back(kUnknown);
    if (asked_++ % each_ != 0 && !surely) return;
    if (const auto clearance = query_.clearance(q))
      values.back() = static_cast<std::uint16_t>(std::min(1e4 * clearance->least, kUnknown - 1.0));
  }
  void skip() { values.push_back(kUnknown); }
  std::vector<std::uint16_t> values;

 private:
  static constexpr std::uint16_t kUnknown = 65535;
  static constexpr std::size_t kMost = 2000;  // a question costs up to a millisecond
  World::Query query_;
  std::size_t each_, asked_ = 0;  // one cell in so many is asked about, and those of the path
};

/// Joints of one node for each shown cell, in 16 bits: for drawing.
Json map_json(const LatticeMap& map, const Lattice& lattice, const World& world, const std::vector<int>& path,
              const Budget& budget) {
  constexpr std::size_t kMostCells = 200'000;
  const std::vector<int> sheets = map.inhabited_sheets();
  const auto most_columns = static_cast<int>(kMostCells / (std::max<std::size_t>(1, sheets.size()) * 252));
  const MapCells cells(map, std::max(100, most_columns), 252);
  const double reach = 4 * kTwoPi;  // rad, for 16 bits; no arm's joint turns further
  std::vector<std::uint8_t> states, causes;
  std::vector<std::int16_t> joints;
  const auto looked_at = [](const LatticeMap::Node& node) { return node.state >= NodeState::kFree; };
  std::size_t asked = 0;
  for (const int sheet : sheets)
    for (int column = 0; column < cells.columns; ++column)
      for (int row = 0; row < cells.rows; ++row) asked += looked_at(cells.node(sheet, column, row));
  Clearances clearances(world, asked);
  std::vector<Lattice::Node> listed;
  std::vector<int> panel_of(map.panels(), -1);
  Json panels = Json::array();
  for (const int sheet : sheets) {
    panel_of[sheet] = static_cast<int>(panels.size());
    panels.push_back({{"sheet", sheet}, {"name", map.sheet_name(sheet)}, {"rolls", map.shows_rolls(sheet)}});
  }
  int rank = 0;  // of the roll that the path has, as in make_map()
  for (int column = 0; column < cells.columns; ++column) {
    const int first = column * cells.layers_each, last = std::min(map.layers, first + cells.layers_each);
    std::vector<Config> shown(sheets.size() * cells.rows, Config::Constant(2 * reach));
    for (int layer = first; layer < last; ++layer) {
      budget.poll();
      lattice.layer_nodes(layer, listed);
      const auto show = [&](const Lattice::Node& node, int sheet, int angle) {
        const int row = angle / cells.angles_each, k = panel_of[sheet] * cells.rows + row;
        if (panel_of[sheet] < 0 || shown[k][0] < 2 * reach || map.at(layer, sheet, angle) != cells.node(sheet, column, row)) return;
        shown[k] = lattice.row(layer, node.slot, node.q).value_or(node.q);
      };
      const auto* rolls = dynamic_cast<const RollLattice*>(&lattice);
      const bool on_path = layer < static_cast<int>(path.size());
      if (rolls && on_path) rank = rolls->rank_of(layer, path[static_cast<std::size_t>(layer)]);
      for (const Lattice::Node& node : listed) {
        if (rolls && rolls->rank_of(layer, node.slot) != rank) continue;
        const int cell = map_cell(lattice, layer, node.slot);
        show(node, cell / map.angles, cell % map.angles);
      }
      if (!map.turns || !on_path) continue;
      const std::vector<int> slots = slots_of_rolls(lattice, layer, path[static_cast<std::size_t>(layer)], map.angles);
      for (int k = 0; k < map.angles; ++k) {
        const auto at = std::lower_bound(listed.begin(), listed.end(), slots[static_cast<std::size_t>(k)],
                                         [](const Lattice::Node& node, int slot) { return node.slot < slot; });
        if (at != listed.end() && at->slot == slots[static_cast<std::size_t>(k)]) show(*at, map.sheets(), k);
      }
    }
    std::size_t k = 0;
    for (const int sheet : sheets)
      for (int row = 0; row < cells.rows; ++row, ++k) {
        const LatticeMap::Node cell = cells.node(sheet, column, row);
        const bool posed = shown[k][0] < 2 * reach;
        states.push_back(
            static_cast<std::uint8_t>(static_cast<unsigned>(cell.state) | (cell.certified ? 64u : 0u) | (posed ? 128u : 0u)));
        causes.push_back(cell.cause);
        if (!posed) continue;
        budget.poll();
        if (looked_at(cell))
          clearances.add(shown[k], cells.on_path(sheet, column, row));
        else
          clearances.skip();
        for (int j = 0; j < kDof; ++j)
          joints.push_back(static_cast<std::int16_t>(std::lround(std::clamp(shown[k][j] / reach, -1.0, 1.0) * 32767)));
      }
  }
  return {{"layers", map.layers},
          {"angles", map.angles},
          {"columns", cells.columns},
          {"rows", cells.rows},
          {"layers_each", cells.layers_each},
          {"angles_each", cells.angles_each},
          {"panels", std::move(panels)},
          {"states", base64(states)},
          {"causes", base64(causes)},
          {"joints", base64(joints)},
          {"clearances", base64(clearances.values)},
          {"joint_unit", reach / 32767},
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

std::string to_page(const PlanView& view, const LatticeMap& map, const std::string& result_json, const PageMotion& motion,
                    const Budget& budget, const PageWords& words) {
  const Problem& problem = view.problem;
  const World& world = view.world;
  const Lattice& lattice = view.lattice;
  const ToolPath& path = lattice.path();
  Json result = Json::parse(result_json);
  const Json& diagnosis = result["diagnosis"];
  Bodies bodies(world, problem.scene);
  const std::vector<Row> found = lattice_rows(lattice, map, view.path);
  std::vector<TrajectoryRow> all = motion.refined ? *motion.refined : path_rows(lattice, view.path), refined = all;
  if (const auto* rolls = dynamic_cast<const RollLattice*>(&lattice);
      rolls && motion.refined) {  // as many as the lattice has layers
    refined.clear();
    for (const int knot : rolls->knots()) refined.push_back(all[static_cast<std::size_t>(knot)]);
  }
  std::vector<Row> rows = motion.refined ? refined_rows(lattice, map, refined, view.path) : found;
  if (const auto* rolls = dynamic_cast<const RollLattice*>(&lattice)) {
    const std::vector<double> turns = rolls_of(all);
    for (std::size_t layer = 0; layer < rows.size(); ++layer)
      rows[layer].roll = turns[static_cast<std::size_t>(rolls->knots()[layer])];
  }
  Json tool_path = Json::array();
  for (int layer = 0; layer < path.size(); ++layer) tool_path.push_back(vector_json(path.layer(layer).tool.translation()));

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
        {"joint_step", lattice.has_layers_between() ? Json(nullptr) : Json(problem.limits.joint_step)},
        {"edges", problem.limits.edges == EdgeMode::kContinuous ? "continuous" : "nodes"}}},
      {"chain", chain_json(lattice.chain())},
      {"bodies", std::move(bodies.bodies)},
      {"meshes", std::move(bodies.meshes)},
      {"tool_path", std::move(tool_path)},
      {"rows", rows_json(world, lattice, rows, errors_mm(lattice, rows, all), budget)},
      {"beside", motion.refined ? beside_json(found) : Json::array()},
      {"motion", motion.motion ? motion_json(*motion.motion, joint_rates(lattice.chain(), problem.limits, problem.source),
                                             lattice.chain(), rows, path)
                               : Json(nullptr)},
      {"cut", diagnosis.is_object() ? cut_json(map, lattice, world, view.path, diagnosis) : Json(nullptr)},
      {"map", map_json(map, lattice, world, view.path, budget)}};
  return fill(page_template(), data.dump(-1, ' ', false, Json::error_handler_t::replace),
              {{"@@ANSWER@@", escaped_lines(title + "\n\n" + words.answer)}, {"@@MAP@@", to_svg(map)}});
}

}  // namespace swivel
