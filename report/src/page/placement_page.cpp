// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "page/packed.hpp"
#include "page/page_parts.hpp"
#include "page/page_template.hpp"
#include "page/scene_json.hpp"
#include "swivel/core/base/rpy.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/report/placement_map.hpp"

namespace swivel {

using namespace detail;

namespace {

/// Rounds to six significant digits, which suffice for drawings; null where there is no value.
Json rounded(const std::optional<double>& value) {
  if (!value) return nullptr;
  if (*value == 0) return 0;
  const double scale = std::pow(10, 5 - std::floor(std::log10(std::abs(*value))));
  const double result = std::round(*value * scale) / scale;
  return std::isfinite(result) ? result : *value;
}

/// Returns the point that offsets are counted from: the origin of what is moved, before it is
/// moved.
Vector3d origin_of(const PathProblem& problem, const Movable& thing) {
  const std::string& name =
      thing.kind == Movable::Kind::kObject ? thing.object : problem.path_frame;
  if (thing.kind != Movable::Kind::kBase)
    for (const SceneObject& object : problem.scene)
      if (object.name == name) return object.pose.translation();
  return Vector3d::Zero();
}

/// Returns the pose of the base before it was moved, as seen from where the base stands now.
Pose still_frame(const Movable& thing, const Offset& offset) {
  Pose moved = Pose::Identity();
  if (thing.kind != Movable::Kind::kBase) return moved;
  moved.linear() = from_rpy({offset[3], offset[4], offset[5]}).toRotationMatrix();
  moved.translation() = Vector3d(offset[0], offset[1], offset[2]);
  return moved.inverse();
}

/// Returns the poses of the links at q = 0, by name.
Json links_json(const RobotModel& model, const ArmModel& arm) {
  Json links = Json::object();
  for (std::size_t k = 0; k < model.links.size(); ++k)
    links[model.links[k].name] = pose_json(arm.links[k].pose);
  return links;
}

/// Returns the robot with joints held as in a cell: its chain, the poses of its bodies at q = 0 in
/// the order of Bodies, and those of its links, which carry visual shapes.
Json robot_json(const PreparedRobot& robot, const RobotModel& model) {
  Json poses = Json::array();
  for (const RobotBody& body : robot.world().bodies()) poses.push_back(pose_json(body.pose));
  return {{"chain", chain_json(robot.arm().chain)},
          {"ground", ground_json(model, robot.arm())},
          {"robot_poses", std::move(poses)},
          {"links", links_json(model, robot.arm())}};
}

/// Returns rows in a placement for drawing. `robot`: robot_json() where its joints are held
/// elsewhere than in other cells.
Json plan_json(const PlacementCell& cell, const std::vector<TrajectoryRow>& rows,
               const std::vector<SceneObject>& scene, const Movable& thing, const Json& robot) {
  std::vector<float> s, joints;  // for drawing
  for (const TrajectoryRow& row : rows) {
    s.push_back(static_cast<float>(row.s));
    for (const double q : row.q.coordinates()) joints.push_back(static_cast<float>(q));
  }
  Json poses = Json::array();
  for (const SceneObject& object : scene) poses.push_back(pose_json(object.pose));
  Json json = {{"cell", cell.cell},
               {"s", Json::binary(bytes_of(s))},
               {"joints", Json::binary(bytes_of(joints))},
               {"poses", std::move(poses)},
               {"still_frame", pose_json(still_frame(thing, cell.offset))},
               {"near", nullptr}};
  if (!robot.is_null()) json["robot"] = robot;
  return json;
}

/// Writes how near the bodies are in the plan of a placement. `like`: the world of the robot.
Json near_of_plan(const World& like, const PlacedPlan& plan) {
  const World world(like, plan.scene);
  World::Query query(world, DistanceProofs::kOn);
  std::vector<NearBodies> near(plan.trajectory.size());
  for (std::size_t k = 0; k < near.size(); ++k) near[k].add(world, query, plan.trajectory[k].q);
  return near_json(near);
}

Json scene_json(const PlacementScene& scene) {
  if (scene.plans.empty() && scene.ends.empty()) return nullptr;
  Bodies bodies(scene.robot->world(), scene.problem->scene);
  if (scene.visual != nullptr)
    bodies.add_visual(*scene.visual, *scene.problem->model, {{scene.robot->arm()}});
  Json plans = Json::array();
  for (const PlacedPlan& plan : scene.plans) {
    const bool elsewhere = !plan.cell.hold.empty();  // joints are held elsewhere
    plans.push_back(plan_json(plan.cell, plan.trajectory, plan.scene, scene.thing,
                              elsewhere ? robot_json(*plan.robot, *scene.problem->model) : Json()));
    plans.back()["near"] =
        near_of_plan(elsewhere ? plan.robot->world() : scene.robot->world(), plan);
  }
  for (const PlacedEnd& end : scene.ends) {
    plans.push_back(plan_json(end.cell, end.rows, end.scene, scene.thing,
                              end.robot.empty() ? Json() : Json::parse(end.robot)));
    plans.back()["past"] = Json::parse(end.past);
  }
  return {{"chain", chain_json(scene.robot->arm().chain)},
          {"ground", ground_json(*scene.problem->model, scene.robot->arm())},
          {"bodies", std::move(bodies.bodies)},
          {"visual", std::move(bodies.visual)},
          {"unread", scene.unread},
          {"own_links", links_json(*scene.problem->model, scene.robot->arm())},
          {"meshes", std::move(bodies.meshes)},
          {"origin", vector_json(origin_of(*scene.problem, scene.thing))},
          {"plans", std::move(plans)}};
}

}  // namespace

std::optional<PlacedEnd> placed_end(const PlacementCell& cell, const PlanView& view,
                                    const std::string& result_json, const Budget& budget) {
  const Json result = Json::parse(result_json);
  if (!result["diagnosis"].is_object()) return std::nullopt;
  const LatticeMap map = make_map(view, false, budget);
  PlacedEnd end{cell, view.problem.scene, rows_of(view.lattice, view.path), "", ""};
  const std::vector<PageRow> rows = placed(view.lattice, map, end.rows, view.path);
  const Json past = cut_json(map, view.lattice, view.world, view.path, rows, result["diagnosis"]);
  if (past.is_null()) return std::nullopt;
  TrajectoryRow last;
  last.s = past["s"];
  for (std::size_t k = 0; k < kDof; ++k) last.q[k] = past["q"][k];
  end.rows.push_back(last);
  end.past = Json{{"pair", past["pair"]}, {"line", past["line"]}, {"what", past["what"]}}.dump(
      -1, ' ', false, Json::error_handler_t::replace);
  if (!cell.hold.empty())
    end.robot = robot_json(view.robot, *view.problem.model)
                    .dump(-1, ' ', false, Json::error_handler_t::replace);
  return end;
}

std::string to_placement_page(const std::vector<PlacementRow>& rows, const PlacementFacts& facts,
                              const PlacementScene& scene) {
  // By columns: the names of the keys would be most of a page of 10,000 rows.
  Json columns = {{"cell", Json::array()}, {"end", Json::array()}};
  const std::pair<const char*, std::optional<double> PlacementRow::*> numbers[] = {
      {"cost", &PlacementRow::cost},
      {"clearance", &PlacementRow::clearance},
      {"clearance_margin", &PlacementRow::clearance_margin},
      {"joint_margin", &PlacementRow::joint_margin},
      {"slide_margin", &PlacementRow::slide_margin},
      {"tool_speed", &PlacementRow::tool_speed},
      {"failed_s", &PlacementRow::failed_s}};
  for (const auto& [name, member] : numbers) columns[name] = Json::array();
  if (facts.sample) columns["offsets"] = Json::array();
  std::map<std::tuple<std::string, std::string, std::string>, int> known;
  Json ends = Json::array();
  bool has_slide = false;
  for (const PlacementRow& row : rows) {
    columns["cell"].push_back(row.cell);
    int end = -1;
    if (row.status != PlanStatus::kSolved) {
      const auto [place, is_new] =
          known.try_emplace({row.cause, ended_by(row), row.reason}, static_cast<int>(known.size()));
      end = place->second;
      if (is_new)
        ends.push_back({{"cause", row.cause},
                        {"by", ended_by(row)},
                        {"reason", row.reason.empty() ? "not known" : row.reason}});
    }
    columns["end"].push_back(end);
    for (const auto& [name, member] : numbers) columns[name].push_back(rounded(row.*member));
    has_slide = has_slide || row.slide_margin;
    if (!facts.sample) continue;
    Json offsets = Json::array();
    for (const PlacementAxis& axis : facts.axes)
      offsets.push_back(axis.joint.empty() ? row.offset[static_cast<std::size_t>(axis.coordinate)]
                                           : row.hold.at(axis.joint));
    columns["offsets"].push_back(std::move(offsets));
  }
  if (!has_slide) columns.erase("slide_margin");
  Json axes = Json::array();
  for (const PlacementAxis& axis : facts.axes) {
    Json values = Json::array();
    for (int k = 0; k < axis.count; ++k) values.push_back(axis.at(k));
    if (facts.sample && axis.to > axis.from) values.push_back(axis.to);
    axes.push_back({{"name", axis.name()}, {"values", std::move(values)}});
    if (!axis.joint.empty()) axes.back()["unit"] = axis.slides ? "m" : "rad";
  }
  Json data = {{"problem", facts.problem},  {"thing", facts.thing},
               {"axes", std::move(axes)},   {"sample", facts.sample},
               {"asked", facts.asked},      {"criterion", to_string(facts.criteria.front())},
               {"planner", facts.planner},  {"plan_command", facts.plan_command},
               {"ends", std::move(ends)},   {"columns", std::move(columns)},
               {"scene", scene_json(scene)}};
  return fill(placement_template(), std::move(data),
              {{"@@ANSWER@@", escaped_lines(facts.problem + "\n\n" + facts.answer)},
               {"@@MAP@@", facts.map}});
}

}  // namespace swivel
