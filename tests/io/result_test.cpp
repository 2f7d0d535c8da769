// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>

#include "io_support.hpp"
#include "swivel/io/schema/schema_text.hpp"

namespace swivel::io::test {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> keys_of(const Json& json) {
  std::vector<std::string> keys;
  for (const auto& item : json.items()) keys.push_back(item.key());
  return keys;
}

PlanResult solved() {
  PlanResult result;
  result.status = PlanStatus::kSolved;
  result.cost = 1.0 / 3;
  result.planner = "parallel";
  result.threads = 4;
  result.lattice.layers = 101;
  result.lattice.nodes = 203616;
  result.lattice.grid = {126, 8, 2, 2};
  result.lattice.method = "closed form";
  result.lattice.merged_waypoints = 1;
  result.counters = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  result.time_ms = {{"load", 1.5}, {"plan", 2.5}, {"search", 0.25}};
  result.evidence = Evidence::all();
  result.tool_path_error_mm = {0.1, 0.2, 1, 0.001};
  result.nearest_limit = {0.04, "c", Cause::Side::kUpper, 0};
  result.nearest_slide_limit = {0.125, "a", Cause::Side::kLower, 1, true};
  result.top_tool_speed = {0.35, "g", 0};
  result.min_clearance = 0.012;
  result.min_margin = {0.001, 0.003, 0.002, {"link_5", "link_7"}, 1};
  result.reduced_pairs = {{{"link_5", "link_7"}, 0.004, 0.002, 0.001}};
  result.dropped_pairs = {{{"link_1", "link_3"}, 0, 0, 0}};
  result.min_manipulability = 0.05;
  result.arm_angle = {0.1, -0.2};
  TrajectoryRow row;
  row.s = 0.1;
  row.phi = kPi;
  row.branch = 5;
  row.q = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 1e-17};
  result.trajectory = {row, row};
  result.warnings = {"open mesh"};
  result.joint_names = {"a", "b", "c", "d", "e", "f", "g"};
  return result;
}

/// Returns the properties of the first object that the schema of a value allows.
Json properties_of(const Json& schema) {
  if (schema.contains("anyOf")) return properties_of(schema["anyOf"][0]);
  return schema["type"] == "array" ? properties_of(schema["items"]) : schema["properties"];
}

TEST(Result, KeysInTheOrderOfTheSchema) {
  EXPECT_FALSE(Json::parse(to_json(solved()))["lattice"].contains("rolls"));
  EXPECT_FALSE(Json::parse(to_json(solved()))["trajectory"][0].contains("roll"));
  PlanResult turning = solved();  // has the keys of a tool that turns as well
  turning.lattice.grid->rolls = 63;
  turning.lattice.knots = {.bound = 1.25, .gap = 0.02, .bias = 0.01, .halved = true};
  turning.trajectory[1].roll = 0.2;
  const Json json = Json::parse(to_json(turning)),
             schema = properties_of(Json::parse(result_json_schema()));
  EXPECT_EQ(keys_of(json), keys_of(schema));
  for (const char* const key : {"counters", "time_ms"})
    EXPECT_EQ(keys_of(json[key]), keys_of(properties_of(schema[key]))) << key;
  EXPECT_EQ(keys_of(json["trajectory"][0]), keys_of(properties_of(schema["trajectory"])));
  Json lattice = properties_of(schema["lattice"]);
  lattice.erase("arcs");  // of other arms
  EXPECT_EQ(keys_of(json["lattice"]), keys_of(lattice));
}

TEST(Result, SolvedRoundTrip) {
  const PlanResult result = solved();
  const Json json = Json::parse(to_json(result));
  EXPECT_EQ(json["status"], "solved");
  EXPECT_EQ(json["cost"].get<double>(), result.cost);
  EXPECT_EQ(json["lattice"]["nodes"], 203616);
  EXPECT_EQ(json["lattice"]["merged_waypoints"], 1);
  EXPECT_EQ(json["lattice"]["cost"].get<double>(), result.lattice.cost);
  EXPECT_EQ(json["checked"], result.checked);
  EXPECT_TRUE(json["certificate"].is_null());
  EXPECT_EQ(json["counters"]["iterations"], 9);
  EXPECT_EQ(json["time_ms"]["load"], 1.5);
  EXPECT_EQ(json["time_ms"]["prepare"], 0.0);
  EXPECT_EQ(json["time_ms"]["stages"], Json({{"search", 0.25}}));
  EXPECT_EQ(json["tool_path_error_mm"]["max"], 0.2);
  EXPECT_EQ(json["min_clearance"], 0.012);
  EXPECT_EQ(json["min_margin"], Json({{"margin", 0.001},
                                      {"clearance", 0.003},
                                      {"required", 0.002},
                                      {"bodies", {"link_5", "link_7"}},
                                      {"row", 1}}));
  EXPECT_EQ(
      json["summary"]["clearance"],
      Json({{"value", 0.003}, {"asked", 0.002}, {"bodies", {"link_5", "link_7"}}, {"s", 0.1}}));
  EXPECT_EQ(
      json["summary"]["joint_limit"],
      Json({{"joint", "c"}, {"side", "upper"}, {"margin_deg", 0.04 * 180 / kPi}, {"s", 0.1}}));
  EXPECT_EQ(json["summary"]["slide_limit"],
            Json({{"joint", "a"}, {"side", "lower"}, {"margin_mm", 125.0}, {"s", 0.1}}));
  EXPECT_EQ(json["summary"]["tool_path_error"],
            Json({{"max_mm", 0.2}, {"allowed_mm", 1.0}, {"s", 0.1}}));
  EXPECT_EQ(json["summary"]["top_tool_speed"], Json({{"speed", 0.35}, {"joint", "g"}, {"s", 0.1}}));
  EXPECT_EQ(json["robot_pairs"]["dropped"], Json::parse(R"([{"bodies": ["link_1", "link_3"]}])"));
  EXPECT_EQ(json["robot_pairs"]["reduced"],
            Json::parse(
                R"([{"bodies": ["link_5", "link_7"], "median": 0.004, "clearance": 0.002,
      "edge_clearance": 0.001}])"));
  EXPECT_TRUE(json["diagnosis"].is_null());
  ASSERT_EQ(json["trajectory"].size(), 2u);
  EXPECT_EQ(json["trajectory"][0]["phi"].get<double>(), kPi);
  for (int k = 0; k < kDof; ++k)
    EXPECT_EQ(json["trajectory"][0]["joints"][k].get<double>(), result.trajectory[0].q[k]);
  EXPECT_EQ(json["warnings"], Json({"open mesh"}));
  EXPECT_EQ(json["joint_names"], Json({"a", "b", "c", "d", "e", "f", "g"}));
}

/// Returns the result of a problem that has no path, with causes of three kinds.
PlanResult infeasible() {
  PlanResult result;
  result.status = PlanStatus::kInfeasible;
  Cause limit, pair, reach;
  limit.kind = Cause::Kind::kLimit;
  limit.side = Cause::Side::kLower;
  limit.joint = "j5";
  limit.value = -2.5;
  limit.limit = -2.0;
  pair.kind = Cause::Kind::kPair;
  pair.bodies = {"link_3", "table"};
  reach.kind = Cause::Kind::kReach;
  reach.side = Cause::Side::kUpper;
  reach.value = 0.75;
  reach.limit = 0.5;
  result.diagnosis.emplace();
  result.diagnosis->cause = limit;
  result.diagnosis->at_s = 0.35;
  result.diagnosis->waypoints = {3, 4};
  result.diagnosis->without_it = 20;
  result.diagnosis->without_it_s = 0.45;
  result.diagnosis->reached_layer = 12;
  result.diagnosis->reached_s = 0.34;
  result.diagnosis->empty_layers = {{13, 14, 0.35, 0.36, 4, 4, reach, 0.3},
                                    {15, 15, 0.37, 0.37, -1, -1, pair, {}}};
  result.diagnosis->removed = {{reach, 9}};
  result.diagnosis->complete = false;
  result.diagnosis->layers_known = 16;
  return result;
}

TEST(Result, Infeasible) {
  const Json json = Json::parse(to_json(infeasible()));
  EXPECT_EQ(json["status"], "infeasible");
  for (const char* key : {"cost", "min_clearance", "min_margin", "min_manipulability"})
    EXPECT_TRUE(json[key].is_null()) << key;
  EXPECT_TRUE(json["tool_path_error_mm"]["mean"].is_null());
  EXPECT_EQ(json["summary"]["solved"], false);
  EXPECT_TRUE(json["summary"]["clearance"].is_null());
  EXPECT_EQ(json["trajectory"], Json::array());
}

TEST(Result, DiagnosisOfAnInfeasibleProblem) {
  const Json diagnosis = Json::parse(to_json(infeasible()))["diagnosis"];
  EXPECT_EQ(keys_of(diagnosis),
            (std::vector<std::string>{"reached_layer", "reached_s", "reason", "cause", "at_s",
                                      "waypoints", "without_it", "without_it_s", "together",
                                      "empty_layers", "removed", "holds", "unreachable", "complete",
                                      "layers_known"}));
  EXPECT_EQ(diagnosis["reached_layer"], 12);
  EXPECT_EQ(diagnosis["reached_s"], 0.34);
  EXPECT_EQ(diagnosis["reason"], "joint j5");
  EXPECT_EQ(diagnosis["cause"],
            Json::parse(
                R"({"cause": "limit", "joint": "j5", "other_joints": false, "unwinds": false,
      "side": "lower", "bodies": null, "between_layers": false, "object": null, "check": null,
      "by": 0.5, "value": -2.5, "limit": -2.0, "over": null, "unit": "rad"})"));
  EXPECT_EQ(diagnosis["waypoints"], Json({3, 4}));
  EXPECT_EQ(diagnosis["without_it"], 20);
  EXPECT_EQ(diagnosis["empty_layers"][0]["layers"], Json({13, 14}));
  EXPECT_EQ(diagnosis["empty_layers"][0]["s"], Json({0.35, 0.36}));
  EXPECT_EQ(diagnosis["empty_layers"][0]["waypoints"], Json({4, 4}));
  EXPECT_EQ(diagnosis["empty_layers"][0]["reason"], "no IK");
  EXPECT_EQ(diagnosis["empty_layers"][0]["cause"]["side"], "upper");
  EXPECT_EQ(diagnosis["empty_layers"][0]["cause"]["by"], 0.25);
  EXPECT_EQ(diagnosis["empty_layers"][0]["most"], 0.3);
  EXPECT_TRUE(diagnosis["empty_layers"][1]["waypoints"].is_null());
  EXPECT_EQ(diagnosis["empty_layers"][1]["cause"]["bodies"], Json({"link_3", "table"}));
  EXPECT_TRUE(diagnosis["empty_layers"][1]["cause"]["by"].is_null());
  EXPECT_EQ(diagnosis["complete"], false);
  EXPECT_EQ(diagnosis["layers_known"], 16);
  EXPECT_EQ(diagnosis["removed"]["no IK"], 9);
}

TEST(Result, ResolutionsThatADiagnosisHoldsFor) {
  PlanResult result = infeasible();
  const Json diagnosis = Json::parse(to_json(result))["diagnosis"];
  EXPECT_EQ(diagnosis["holds"], "this_resolution");
  EXPECT_TRUE(diagnosis["unreachable"].is_null());
  result.diagnosis->unreachable = {14, 0.36, -1};
  EXPECT_EQ(Json::parse(to_json(result))["diagnosis"]["holds"], "exact_tool");
  EXPECT_EQ(Json::parse(to_json(result))["diagnosis"]["unreachable"],
            Json::parse(R"({"layer": 14, "s": 0.36, "waypoint": null})"));
  result.diagnosis->unreachable->waypoint = 4;
  EXPECT_EQ(Json::parse(to_json(result))["diagnosis"]["holds"], "every_resolution");
}

TEST(Result, WhatWasNotAskedForIsNull) {
  PlanResult result = solved();
  result.evidence = {};
  result.min_clearance.reset();
  result.min_margin.reset();
  const Json json = Json::parse(to_json(result));
  EXPECT_FALSE(json["cost"].is_null());
  EXPECT_TRUE(json["tool_path_error_mm"]["mean"].is_null());
  EXPECT_TRUE(json["tool_path_error_mm"]["max"].is_null());
  EXPECT_TRUE(json["min_clearance"].is_null());
  EXPECT_TRUE(json["min_manipulability"].is_null());
  EXPECT_EQ(json["min_clearance_status"], "not_measured");
  EXPECT_EQ(json["deepest_contact_status"], "not_measured");
}

TEST(Result, NoContactIsToldFromContactThatWasNotMeasured) {
  PlanResult result = solved();
  EXPECT_EQ(Json::parse(to_json(result))["min_clearance_status"], "measured");
  EXPECT_EQ(Json::parse(to_json(result))["deepest_contact_status"], "none");
  result.deepest_contact = {0.001, 0.0015, {"pad", "part"}, std::nullopt, 1};
  EXPECT_EQ(Json::parse(to_json(result))["deepest_contact_status"], "measured");
  result.min_clearance.reset();
  EXPECT_EQ(Json::parse(to_json(result))["min_clearance_status"], "none");
  EXPECT_EQ(Json::parse(to_json(infeasible()))["deepest_contact_status"], "not_measured");
}

TEST(Result, EmptyFirstLayerAndTimeOut) {
  PlanResult result;
  result.diagnosis.emplace();
  EXPECT_TRUE(Json::parse(to_json(result))["diagnosis"]["reached_s"].is_null());
  result.status = PlanStatus::kTimeout;
  EXPECT_EQ(Json::parse(to_json(result))["status"], "timeout");
  EXPECT_TRUE(Json::parse(to_json(result))["diagnosis"].is_null());
}

TEST(Result, NamesThatAreNotUtf8) {
  PlanResult result = solved();
  result.warnings = {"mesh \xff\xfe.stl \"quoted\"\n"};
  EXPECT_TRUE(Json::accept(to_json(result)));
}

}  // namespace
}  // namespace swivel::io::test
