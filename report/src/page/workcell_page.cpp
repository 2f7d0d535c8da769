// SPDX-License-Identifier: BSD-3-Clause
#include "page/workcell_page.hpp"

#include <algorithm>

#include "drawing.hpp"
#include "page/page_parts.hpp"
#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

using namespace detail;

namespace {

constexpr int kJoints = static_cast<int>(kDof);

/// Numbers of the groups of two chains among the groups of both: that of what stands, the links of
/// arm 0, those of arm 1, the followers of arm 0, those of arm 1.
class GroupsOfBoth {
 public:
  explicit GroupsOfBoth(const std::array<const Chain*, 2>& chains) {
    int followers = 1 + 2 * kJoints;
    for (int arm = 0; arm < 2; ++arm) {
      std::vector<int>& groups = groups_[static_cast<std::size_t>(arm)];
      groups.push_back(0);
      for (int joint = 1; joint <= kJoints; ++joint) groups.push_back(arm * kJoints + joint);
      for (std::size_t k = 0; k < chains[static_cast<std::size_t>(arm)]->followers.size(); ++k)
        groups.push_back(followers++);
    }
  }
  /// Returns the number of each group of an arm.
  [[nodiscard]] const std::vector<int>& of(std::size_t arm) const { return groups_[arm]; }

 private:
  std::array<std::vector<int>, 2> groups_;
};

/// Writes two chains as one for the page's forward kinematics: the joints of arm 0 and then those
/// of arm 1, each with the group that carries it, and where either tool is.
Json chain_of_both(const std::array<const Chain*, 2>& chains,
                   const std::array<std::string, 2>& names, const GroupsOfBoth& groups) {
  Json both = {{"joints", Json::array()}, {"followers", Json::array()}, {"tools", Json::array()}};
  for (std::size_t arm = 0; arm < 2; ++arm) {
    Json chain = chain_json(*chains[arm]);
    const std::vector<int>& of = groups.of(arm);
    for (std::size_t j = 0; j < kDof; ++j) {
      chain["joints"][j]["parent"] = of[j];
      both["joints"].push_back(std::move(chain["joints"][j]));
    }
    for (Json& follower : chain["followers"]) {
      follower["parent"] = of[follower["parent"].get<std::size_t>()];
      follower["leader"] = follower["leader"].get<int>() + static_cast<int>(arm) * kJoints;
      both["followers"].push_back(std::move(follower));
    }
    // The seventh joint of an arm of six is the roll, which does not turn the tool.
    const std::size_t last = chains[arm]->roll ? kDof - 1 : kDof;
    both["tools"].push_back(
        {{"name", names[arm]}, {"group", of[last]}, {"home", std::move(chain["home"])}});
  }
  return both;
}

/// Makes the data of a workcell's page, and the maps for a page without JavaScript.
class WorkcellPage {
 public:
  WorkcellPage(const PlannedWorkcell& planned, const std::string& result_json, const Budget& budget)
      : planned_(planned),
        result_(planned.result),
        between_(planned.prepared.between()),
        query_(between_),
        budget_(budget),
        json_(Json::parse(result_json)) {}

  /// Returns the data of the page. Throws Stopped.
  Json data(const PageWords& words) {
    const std::array<const Chain*, 2> chains{&view(0).lattice.chain(), &view(1).lattice.chain()};
    const GroupsOfBoth groups(chains);
    Bodies bodies;
    Json arms = Json::array(), ground = nullptr;
    for (std::size_t k = 0; k < 2; ++k) {
      bodies.add_arm(view(k).world, result_.arms[k].name, groups.of(k), k == 0);
      arms.push_back(arm(k));
      if (!ground.is_null()) continue;
      ground = ground_json(*planned_.cell.arms[k].model, view(k).robot.arm());
      if (!ground.is_null()) ground["group"] = groups.of(k)[ground["group"].get<std::size_t>()];
    }
    bodies.add_scene(planned_.cell.scene);
    if (words.visual != nullptr)
      bodies.add_visual(*words.visual, *planned_.cell.arms[0].model,
                        {{view(0).robot.arm(), result_.arms[0].name, groups.of(0)},
                         {view(1).robot.arm(), result_.arms[1].name, groups.of(1)}});
    Json meeting = meetings(), conflict = conflict_json();
    return {{"result", std::move(json_)},
            {"chain", chain_of_both(chains, names_of_arms(result_), groups)},
            {"ground", std::move(ground)},
            {"bodies", std::move(bodies.bodies)},
            {"visual", std::move(bodies.visual)},
            {"meshes", std::move(bodies.meshes)},
            {"arms", std::move(arms)},
            {"near", near()},
            {"between", std::move(meeting)},
            {"conflict", std::move(conflict)}};
  }
  /// Returns the maps of the arms as HTML, after data() was called.
  [[nodiscard]] const std::string& maps() const { return maps_; }

 private:
  [[nodiscard]] const PlanView& view(std::size_t arm) const { return planned_.view.runs[arm]; }
  /// Returns true if an arm has a path: that of the answer, or where there is no plan its own.
  [[nodiscard]] bool has_path(std::size_t arm) const { return !planned_.view.alone[arm].empty(); }

  /// Returns an arm: where its tool goes, its rows, map, and where its paths end.
  Json arm(std::size_t k) {
    const PlanView& of = view(k);
    const Lattice& lattice = of.lattice;
    const ArmAnswer& of_arm = result_.arms[k];
    const std::vector<TrajectoryRow>& answer = of_arm.rows();
    const LatticeMap& map = planned_.maps[k].map;
    std::vector<TrajectoryRow> path = answer.empty() ? rows_of(lattice, of.path) : answer;
    Json moved = motion(k, path);
    const std::vector<PageRow> rows = placed(lattice, map, path, of.path);
    for (const PageRow& row : rows) shown_[k].push_back(row.at.q);
    refined_[k] =
        !moved.is_null() || (!answer.empty() && of_arm.cost() != of_arm.run().lattice.cost);
    const int leader = planned_.cell.leader_of(k);
    const Json& diagnosis = json_["arms"][k]["diagnosis"];
    Json json = {
        {"name", result_.arms[k].name},
        {"leader", leader >= 0 ? Json(leader) : Json(nullptr)},
        {"answer", has_path(k) ? "" : run_text(of_arm.run(), of_arm.held)},
        {"chain", chain_json(lattice.chain())},
        {"settings", settings_json(of.problem, lattice)},
        {"tool_path", tool_path_json(lattice.path_of_rows())},
        {"on_leader", leader >= 0 ? on_tool(k) : Json(nullptr)},
        {"rows", rows_json(of.world, lattice, rows, budget_)},
        {"beside", beside(k, map, rows)},
        {"refined", refined_[k]},
        {"motion", std::move(moved)},
        {"cut", diagnosis.is_object() ? cut_json(map, lattice, of.world, of.path, rows, diagnosis)
                                      : Json(nullptr)},
        {"region", region(k, map)}};
    json["map"] = map_json(map, lattice, of.world, of.path, rows, kMostCells * 3 / 4, budget_);
    maps_ += "<h2>" + escaped(result_.arms[k].name) + "</h2>\n" + to_svg(map);
    return json;
  }
  /// Returns the points of a follower's path in the tool frame of its leader.
  [[nodiscard]] Json on_tool(std::size_t follower) const {
    Json points = Json::array();
    for (int layer = 0; layer < view(follower).lattice.path_of_rows().size(); ++layer)
      points.push_back(vector_json(planned_.prepared.on_leader(layer).translation()));
    return points;
  }
  /// Returns the motion in time of an arm, null where there is none, and gives the rows of its path
  /// the joints that the motion has there.
  [[nodiscard]] Json motion(std::size_t k, std::vector<TrajectoryRow>& rows) const {
    if (planned_.motion == nullptr) return nullptr;
    const PlanView& of = view(k);
    const TimedPath& timed = planned_.motion->arms[k];
    const std::vector<double> places = places_of(timed.rows, rows, &of.lattice.path_of_rows());
    const JointRates rates = joint_rates(of.lattice.chain(), of.problem.limits, of.problem.source);
    rows = passed_rows(std::move(rows), timed.rows, places);
    return motion_json(timed.rows, timed.rate, rates, of.lattice.chain(), places);
  }
  /// Returns the path of the lattice, where the answer was refined; else the path of an arm by
  /// itself, where the answer is another one.
  [[nodiscard]] Json beside(std::size_t k, const LatticeMap& map,
                            const std::vector<PageRow>& rows) const {
    const std::vector<int>& alone = planned_.view.alone[k];
    const PlanView& of = view(k);
    if (refined_[k])
      return beside_json(placed(of.lattice, map, rows_of(of.lattice, of.path), of.path), rows);
    if (alone.empty() || alone == of.path) return Json::array();
    LatticeMap own = map;
    own.path.clear();
    for (const int slot : alone)
      own.path.push_back(map_cell(map, of.lattice, static_cast<int>(own.path.size()), slot));
    return beside_json(placed(of.lattice, own, rows_of(of.lattice, alone), alone), rows);
  }

  /// Returns the cells of an arm's map in which its nodes of the region of conflict are: of each
  /// run of cells the layer, the panel and the first and the last cell. Null without a region.
  [[nodiscard]] Json region(std::size_t k, const LatticeMap& map) const {
    const auto& region = planned_.view.region;
    if (!region) return nullptr;
    Json runs = Json::array();
    add_runs(k, map, region->layer, region->slots[k], runs);
    add_runs(k, map, region->layer + 1, region->next[k], runs);
    return {{"layer", region->layer},
            {"of_motion", !region->next[k].empty()},
            {"nodes", region->slots[k].size()},
            {"runs", std::move(runs)}};
  }
  void add_runs(std::size_t k, const LatticeMap& map, int layer, const std::vector<int>& slots,
                Json& runs) const {
    const int cells = map.panels() * map.angles;
    std::vector<char> within(static_cast<std::size_t>(cells));
    for (const int slot : slots) {
      within[static_cast<std::size_t>(map_cell(map, view(k).lattice, layer, slot))] = 1;
      for (int cell = 0; !map.grid() && cell < cells; ++cell)
        if (map.slots[static_cast<std::size_t>(layer) * static_cast<std::size_t>(cells) +
                      static_cast<std::size_t>(cell)] == slot)
          within[static_cast<std::size_t>(cell)] = 1;
    }
    for (int cell = 0; cell < cells; ++cell) {
      if (!within[static_cast<std::size_t>(cell)]) continue;
      int last = cell;
      while ((last + 1) % map.angles != 0 && within[static_cast<std::size_t>(last + 1)]) ++last;
      runs.push_back({{"layer", layer},
                      {"sheet", cell / map.angles},
                      {"from", cell % map.angles},
                      {"to", last % map.angles}});
      cell = last;
    }
  }

  /// Returns a pair of bodies of both arms at joints `q`, how far they are apart, and the line
  /// between their nearest points.
  Json meeting(const std::array<Config, 2>& q, const InterArmWorld::Query::Clearance& found) {
    const auto names = between_.names(found.pair);
    Json json = {{"mm", 1e3 * found.distance},
                 {"asked_mm", 1e3 * found.required},
                 {"pair", {names[0], names[1]}},
                 {"nearest", nullptr}};
    std::optional<std::array<Vector3d, 2>> ends = query_.nearest_points(q, found);
    if (const auto point = ends ? std::nullopt : query_.common_point(q, found.pair))
      ends = {*point, *point};
    if (ends) {
      json["nearest"] = vector_json((*ends)[0]);
      for (const double x : (*ends)[1]) json["nearest"].push_back(x);
    }
    return json;
  }
  /// Returns of each row the bodies of both arms with the least margin; empty where an arm has no
  /// path, or where no body of the one needs to keep clear of one of the other.
  Json meetings() {
    Json list = Json::array();
    if (!has_path(0) || !has_path(1)) return list;
    for (std::size_t row = 0; row < std::min(shown_[0].size(), shown_[1].size()); ++row) {
      budget_.poll();
      const std::array<Config, 2> q{shown_[0][row], shown_[1][row]};
      const auto found = query_.clearance(q);
      if (!found) return Json::array();
      list.push_back(meeting(q, *found));
    }
    return list;
  }

  /// Returns how near the bodies of both arms and of the scene are at each row: an arm is at its
  /// last row beyond that, and is left out if it has no row.
  Json near() {
    std::array<World::Query, 2> own{World::Query(view(0).world, DistanceProofs::kOn),
                                    World::Query(view(1).world, DistanceProofs::kOn)};
    std::vector<NearBodies> rows(std::max(shown_[0].size(), shown_[1].size()));
    for (std::size_t row = 0; row < rows.size(); ++row) {
      budget_.poll();
      std::array<Config, 2> q;
      for (std::size_t k = 0; k < 2; ++k) {
        if (shown_[k].empty()) continue;
        q[k] = shown_[k][std::min(row, shown_[k].size() - 1)];
        rows[row].add(view(k).world, own[k], q[k]);
      }
      if (shown_[0].empty() || shown_[1].empty()) continue;
      const auto between = query_.body_clearances(q);
      for (std::size_t body = 0; body < between.size(); ++body) {
        if (!between[body]) continue;
        const std::string& name = between_.body_names()[body];
        const std::array<std::string, 2> pair = between_.names(between[body]->pair);
        rows[row].add(name, between[body]->distance, pair[pair[0] == name ? 1 : 0]);
      }
    }
    return near_json(rows);
  }

  /// Returns where the cheapest paths of both arms meet, as a place in their rows.
  Json conflict_json() {
    const auto& conflict = result_.pair.conflict;
    if (!conflict || !has_path(0) || !has_path(1)) return nullptr;
    const int row = view(0).lattice.layer_of_rows(conflict->layer);
    const auto at = static_cast<std::size_t>(row);
    Json json = {{"row", row + (conflict->of_motion ? 0.5 : 0.0)},
                 {"of_motion", conflict->of_motion},
                 {"s", conflict->s},
                 {"pair", {conflict->bodies[0], conflict->bodies[1]}},
                 {"nearest", nullptr},
                 {"text", ""}};
    if (conflict->of_motion || at >= shown_[0].size() || at >= shown_[1].size()) return json;
    const std::array<Config, 2> q{shown_[0][at], shown_[1][at]};
    const auto pair = query_.find_violating_pair(q, ClearanceRule::kNode);
    if (!pair || between_.names(*pair) != conflict->bodies) return json;
    if (const auto point = query_.common_point(q, *pair)) {
      json["nearest"] = vector_json(*point);
      for (const double x : *point) json["nearest"].push_back(x);
      json["text"] = "they touch";
    } else if (const auto found = query_.clearance(q); found && found->pair == *pair) {
      json["nearest"] = meeting(q, *found)["nearest"];
      json["text"] =
          formatted("%.3g mm apart, asked %.3g mm", 1e3 * found->distance, 1e3 * found->required);
    }
    return json;
  }

  const PlannedWorkcell& planned_;
  const Answer& result_;
  const InterArmWorld& between_;
  InterArmWorld::Query query_;
  const Budget& budget_;
  Json json_;                                   ///< the result
  std::array<std::vector<Config>, 2> shown_{};  ///< joints of the rows of each arm
  std::array<bool, 2> refined_{};               ///< whether the rows are off the lattice's nodes
  std::string maps_;
};

}  // namespace

std::string to_workcell_page(const PlannedWorkcell& planned, const std::string& result_json,
                             const Budget& budget, const PageWords& words) {
  WorkcellPage page(planned, result_json, budget);
  Json data = page.data(words);
  return filled_page(planned.cell.source, words, std::move(data), page.maps());
}

}  // namespace swivel
