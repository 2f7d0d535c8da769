// SPDX-License-Identifier: BSD-3-Clause
#include "page/page_parts.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "map_cells.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel::detail {

Config turned_towards(const Lattice& lattice, const Config& q, const std::vector<PageRow>& rows,
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

namespace {

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
/// last node and of the same solution: among those that the bodies of the diagnosis block, or, if
/// there are none, among the others. Where there is no path, it may be of any solution. Returns
/// nullopt if there is no node.
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
      if (!map.path.empty() && cell / map.angles != from / map.angles) continue;
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

/// Returns the words that say how far a joint would be beyond its limit; "" if that is not the
/// cause, or not known.
std::string limit_words(const PathEnd& end) {
  const Json& cause = end.diagnosis["cause"];
  if (!cause.is_object() || cause["cause"] != "limit" || !cause["by"].is_number() ||
      !cause["limit"].is_number() || cause["unit"] != "rad")
    return "";
  constexpr double kDegrees = 180 / kPi;
  return formatted(", %.3g° beyond %.2f°", cause["by"].get<double>() * kDegrees,
                   cause["limit"].get<double>() * kDegrees);
}

/// Returns the words that say which joint would step too far to the node with joints `q`; "" if
/// that is not the cause.
std::string joint_step_words(const PathEnd& end, const Config& q) {
  const Json& diagnosis = end.diagnosis;
  if (!diagnosis["cause"].is_object() || diagnosis["cause"]["cause"] != "joint_step") return "";
  const Config step =
      end.lattice.delta(*end.lattice.exact_config(end.layer() - 1, end.path.back()), q);
  Eigen::Index joint = 0;
  const Chain& chain = end.lattice.chain();
  step.cwiseAbs().cwiseQuotient(joint_steps(chain, end.lattice.limits())).maxCoeff(&joint);
  const double most = std::abs(step[joint]);
  return ", " + end.map.joint_names[joint] +
         (joint == chain.slide() ? formatted(" by %.0f mm", 1e3 * most)
                                 : formatted(" by %.2f rad", most));
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
  if (map.path.empty()) return {"no valid pose here: " + end.reason() + limit_words(end)};
  return {"the next pose cannot be moved to: " + end.reason() + limit_words(end) +
          joint_step_words(end, q)};
}

/// Returns the last row of the path as the place where every path has ended.
Json last_row_json(const PathEnd& end, const PageRow& row) {
  Json json = place_json(row);
  json["s"] = row.at.s;
  json["q"] = std::vector<double>(row.at.q.data(), row.at.q.data() + kDof);
  json["pair"] = json["line"] = nullptr;
  json["what"] = "no way on from here: " + end.reason() + limit_words(end);
  json["is_row"] = true;
  return json;
}

}  // namespace

Json cut_json(const LatticeMap& map, const Lattice& lattice, const World& world,
              const std::vector<int>& path, const std::vector<PageRow>& rows,
              const Json& diagnosis) {
  const Json& cause = diagnosis["cause"];
  if (cause.is_object() && cause["cause"] == "not_closed") return nullptr;  // paths reach the end
  const PathEnd end{map, lattice, path, diagnosis, rank_at_end(lattice, path)};
  const int layer = end.layer();
  if (layer >= map.layers) return nullptr;
  const bool at_limit = cause.is_object() && cause["cause"] == "limit" && !rows.empty();
  const auto past = at_limit ? std::nullopt : node_past_end(end);
  if (!past && rows.empty()) return nullptr;
  if (!past) return last_row_json(end, rows.back());
  const int cell = map_cell(map, lattice, layer, past->slot);
  const Config q =
      turned_towards(lattice, lattice.exact_config(layer, past->slot, past->q).value_or(past->q),
                     rows, rows.size());
  Obstruction by = obstruction(end, map.at(layer, cell / map.angles, cell % map.angles), q, world);
  const double value = map.value_at(lattice.phi(layer, past->slot), q);
  Json json = {{"layer", layer},
               {"s", lattice.path().layer(layer).s},
               {"phi", value},
               {"sheet", cell / map.angles},
               {"angle", map.place(value)},
               {"q", std::vector<double>(q.data(), q.data() + kDof)},
               {"pair", std::move(by.pair)},
               {"line", std::move(by.line)},
               {"what", std::move(by.what)}};
  if (end.rank) json["roll"] = lattice.grid_place(layer, past->slot).roll;
  return json;
}
}  // namespace swivel::detail
