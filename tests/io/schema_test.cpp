// SPDX-License-Identifier: BSD-3-Clause
// The JSON Schema of problem files and the reader say the same: whatever the schema names the
// reader reads, with its types, ranges and defaults, and nothing else.
#include <functional>
#include <nlohmann/json.hpp>

#include "problem_support.hpp"
#include "swivel/io/schema/schema_text.hpp"

namespace swivel::io::test {
namespace {

using Json = nlohmann::ordered_json;

/// A problem with every section, as JSON, which is YAML.
Json whole_problem() {
  return Json::parse(R"({
    "robot": {"urdf": "../robots/arm.urdf", "base_link": "base_link", "tip_link": "link_7",
              "tool": {}, "hold": {"finger_joint": 0.01},
              "attached": [{"name": "grip", "box": [0.1, 0.1, 0.1]}]},
    "path": {"waypoints": [{"xyz": [0.6, -0.1, 0.9]}, {"xyz": [0.6, 0.1, 0.9]}], "smooth": {}},
    "scene": [{"name": "post", "box": [0.1, 0.1, 0.1]}],
    "resolution": {}, "limits": {}, "start": {"joints": [0, 0, 0, 0, 0, 0, 0]}, "cost": {},
    "refine": {}, "vary": [{"object": "post"}]
  })");
}

/// What a value may be: the schema itself, or its alternatives.
std::vector<Json> options(const Json& schema) {
  if (!schema.contains("anyOf")) return {schema};
  return {schema["anyOf"].begin(), schema["anyOf"].end()};
}

const Json& strokes() {
  static const Json kStrokes = Json::parse(R"([{"name": "a", "path": {"waypoints":
      [{"xyz": [0.6, -0.1, 0.9]}, {"xyz": [0.6, 0.1, 0.9]}]}}])");
  return kStrokes;
}

/// The problem with every section as a job.
Json whole_job() {
  Json job = whole_problem();
  for (const char* const key : {"path", "start"}) job.erase(key);
  job["strokes"] = strokes();
  job["lift"] = {{"allowed", true}};
  return job;
}

/// Two arms of a workcell, with every section.
const Json& arms() {
  static const Json kArms = [] {
    Json both = Json::array();
    for (const char* const name : {"left", "right"})
      both.push_back({{"name", name},
                      {"tip_link", "link_7"},
                      {"tool", Json::object()},
                      {"attached", {{{"name", std::string(name) + "_grip"}, {"sphere", 0.1}}}},
                      {"path", strokes()[0]["path"]},
                      {"start", {{"joints", {0, 0, 0, 0, 0, 0, 0}}}},
                      {"limits", Json::object()}});
    return both;
  }();
  return kArms;
}

/// Puts two arms into a problem in place of the path. Its robot has no hand then.
void make_workcell(Json& problem) {
  problem["arms"] = arms();
  if (problem.contains("robot") && problem["robot"].is_object())
    for (const char* const key : {"tip_link", "tool", "attached"}) problem["robot"].erase(key);
}

/// The problem with every section as a workcell.
Json whole_workcell() {
  Json cell = whole_problem();
  for (const char* const key : {"path", "start"}) cell.erase(key);
  make_workcell(cell);
  return cell;
}

/// Makes the object, which is the problem itself or in it, one that may have the key: without keys
/// that exclude it, with those that it needs.
void make_room(Json& object, const Json& schema, const std::string& key) {
  if (schema.contains("dependencies") && schema["dependencies"].contains(key))
    for (const std::string needed : schema["dependencies"][key]) {
      make_room(object, schema, needed);
      object[needed] = strokes();
    }
  if (!schema.contains("allOf")) return;
  for (const Json& choice : schema["allOf"]) {
    std::vector<std::string> keys;
    if (choice.contains("not")) keys = choice["not"]["required"].get<std::vector<std::string>>();
    if (choice.contains("oneOf"))
      for (const Json& one : choice["oneOf"]) keys.push_back(one["required"][0]);
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) continue;
    for (const std::string& other : keys)
      if (other != key) object.erase(other);
  }
}

/// A key of the schema in a problem that may have it.
struct Place {
  Json problem;               ///< without keys that exclude it
  Json::json_pointer object;  ///< that has it
  std::string key;
  Json schema;  ///< of its value
  [[nodiscard]] Json with(const Json& value) const {
    Json changed = problem;
    changed[object][key] = value;
    return changed;
  }
  /// Returns the place as messages name it: "scene[0].box".
  [[nodiscard]] std::string name() const {
    std::string text;
    for (Json::json_pointer at = object / key; !at.empty(); at.pop_back()) {
      const std::string part = at.back();
      const bool index = part.find_first_not_of("0123456789") == std::string::npos;
      text.insert(0, index ? "[" + part + "]" : (at.parent_pointer().empty() ? "" : ".") + part);
    }
    return text;
  }
};

/// Calls `visit` for every key of the schema, and `visit_object` for every section.
struct Walk {
  std::function<void(const Place&)> visit;
  std::function<void(const Json& problem, const Json::json_pointer& object)> visit_object =
      [](const auto&, const auto&) {};

  void operator()(const Json& problem, const Json& schema, const Json::json_pointer& at) const {
    for (const Json& option : options(schema)) {
      if (option["type"] == "array") (*this)(problem, option["items"], at / 0);
      if (option["type"] != "object" || !option.contains("properties")) continue;
      static const Json kSections = Json::parse(
          R"({"cylinder": {"radius": 0.1, "length": 0.1}, "capsule": {"radius": 0.1, "length": 0.1},
              "sphere": {"radius": 0.1}, "approach": {"xyz": [0, 0, 0]},
              "retract": {"xyz": [0, 0, 0]}, "home": {"joints": [0, 0, 0, 0, 0, 0, 0]},
              "lift": {"allowed": true}})");
      visit_object(problem, at);
      for (const auto& [key, value] : option["properties"].items()) {
        Place place{problem, at, key, value};
        make_room(place.problem[at], option, key);
        visit(place);
        if (kSections.contains(key)) place.problem[at][key] = kSections[key];
        if (key == "strokes") place.problem[at][key] = strokes();
        if (key == "arms") make_workcell(place.problem);
        if (key == "path" && !place.problem[at].contains(key))
          place.problem[at][key] = strokes()[0]["path"];
        (*this)(place.problem, value, at / key);
      }
    }
  }
};

PathProblem load(const ProblemFolder& folder, const Json& problem) {
  return load_path_problem(folder.folder().write("problems/problem.yaml", problem.dump()));
}
Problem load_as_job(const ProblemFolder& folder, const Json& problem) {
  return load_job(folder.folder().write("problems/problem.yaml", problem.dump()));
}

std::string refusal(const ProblemFolder& folder, const Json& problem) {
  SCOPED_TRACE(problem.dump());
  return input_error([&] {
    if (problem.contains("strokes"))
      (void)load_as_job(folder, problem);
    else if (problem.contains("arms"))
      (void)load_workcell(folder.folder().write("problems/problem.yaml", problem.dump()));
    else
      (void)load(folder, problem);
  });
}

/// A value of a type that this key does not have.
Json of_another_type(const Json& schema) {
  for (const Json& option : options(schema))
    if (option["type"] == "string" && !option.contains("enum")) return Json::array();
  return "no such thing";
}

/// Numbers just outside of the ranges, alone or in lists.
std::vector<Json> outside(const Json& schema) {
  std::vector<Json> values;
  for (const Json& option : options(schema)) {
    if (option["type"] == "array" && option.contains("minItems"))
      for (const Json& item : outside(option["items"]))
        values.push_back(std::vector<Json>(option["minItems"], item));
    if (option.contains("exclusiveMinimum")) values.push_back(option["exclusiveMinimum"]);
    if (option.contains("minimum")) values.push_back(option["minimum"].get<double>() - 1e-9);
    if (option.contains("maximum")) values.push_back(option["maximum"].get<double>() * 1.000001);
  }
  return values;
}

TEST(ProblemSchema, EveryKeyIsRead) {
  const ProblemFolder folder;
  int keys = 0;
  Walk walk{[&](const Place& place) {
    ++keys;
    expect_message(refusal(folder, place.with(of_another_type(place.schema))),
                   {": " + place.name()});
  }};
  walk(whole_problem(), Json::parse(problem_json_schema()), Json::json_pointer());
  EXPECT_GE(keys, 150);
}

TEST(ProblemSchema, NoOtherKeyIsRead) {
  const ProblemFolder folder;
  int objects = 0;
  Walk walk{[](const Place&) {},
            [&](const Json& problem, const Json::json_pointer& object) {
              ++objects;
              const Place place{problem, object, "no_such_key", {}};
              expect_message(refusal(folder, place.with(1)), {": " + place.name(), "nearest"});
            }};
  walk(whole_problem(), Json::parse(problem_json_schema()), Json::json_pointer());
  EXPECT_GE(objects, 18);
}

TEST(ProblemSchema, Ranges) {
  const ProblemFolder folder;
  int values = 0;
  Walk walk{[&](const Place& place) {
    for (const Json& value : outside(place.schema)) {
      ++values;
      expect_message(refusal(folder, place.with(value)), {": " + place.name()});
    }
  }};
  walk(whole_problem(), Json::parse(problem_json_schema()), Json::json_pointer());
  EXPECT_GE(values, 60);
}

TEST(ProblemSchema, RequiredKeys) {
  const ProblemFolder folder;
  int keys = 0;
  const Json schema = Json::parse(problem_json_schema());
  const std::function<void(const Json&, const Json&, const Json::json_pointer&)> remove =
      [&](const Json& problem, const Json& one, const Json::json_pointer& at) {
        for (const Json& option : options(one)) {
          if (option["type"] == "array" && problem.contains(at / 0))
            remove(problem, option["items"], at / 0);
          if (option["type"] != "object" || !option.contains("properties") ||
              !problem.contains(at) || !problem[at].is_object())
            continue;
          for (const auto& [key, value] : option["properties"].items())
            remove(problem, value, at / key);
          if (!option.contains("required")) continue;
          for (const std::string key : option["required"]) {
            ++keys;
            Json changed = problem;
            changed[at].erase(key);
            expect_message(refusal(folder, changed), {Place{{}, at, key, {}}.name(), "missing"});
          }
        }
      };
  remove(whole_problem(), schema, Json::json_pointer());
  remove(whole_job(), schema, Json::json_pointer());
  remove(whole_workcell(), schema, Json::json_pointer());
  EXPECT_GE(keys, 22);
}

/// Returns a problem or a job with all defaults that its keys have, but of keys that an S-R-S arm
/// without a roll is refused. Adds their number to `keys`.
Json with_defaults(const Json& plain, int& keys) {
  Json said = plain;
  Walk walk{[&](const Place& place) {
    const std::set<std::string> of_others{"arc", "droll", "knot", "roll_slope"};
    if (!place.schema.contains("default") || place.key == "scale") return;
    if (of_others.contains(place.key)) return;
    // Keys of a job are none of a problem, and the other way round.
    if (!plain.contains(place.object) ||
        place.problem[place.object].size() < plain[place.object].size())
      return;
    ++keys;
    said[place.object][place.key] = place.schema["default"];
  }};
  walk(plain, Json::parse(problem_json_schema()), Json::json_pointer());
  return said;
}

TEST(ProblemSchema, Defaults) {
  const ProblemFolder folder;
  int keys = 0;
  const Json said = with_defaults(whole_problem(), keys);
  EXPECT_GE(keys, 24);
  const PathProblem plain = load(folder, whole_problem()), explicitly = load(folder, said);
  Task without = plain, with = explicitly;
  without.waypoints = with.waypoints = {};  // they must have a position
  EXPECT_EQ(without, with);
  EXPECT_TRUE(plain.tool.isApprox(explicitly.tool));
  EXPECT_TRUE(plain.scene[0].pose.isApprox(explicitly.scene[0].pose));
}

TEST(ProblemSchema, DefaultsOfJobs) {
  const ProblemFolder folder;
  int keys = 0;
  Json base = whole_job();
  base["strokes"][0]["limits"] = Json::object();
  const Json said = with_defaults(base, keys);
  EXPECT_GE(keys, 40);
  for (const char* const key : {"approach", "retract", "order", "rapid"})
    EXPECT_TRUE(said.contains(key)) << key;
  const Problem plain = load_as_job(folder, whole_job()), explicitly = load_as_job(folder, said);
  EXPECT_EQ(plain.arm().order, explicitly.arm().order);
  EXPECT_EQ(plain.arm().rapid, explicitly.arm().rapid);
  EXPECT_EQ(plain.arm().lift, explicitly.arm().lift);
  Stroke without = plain.arm().strokes[0], with = explicitly.arm().strokes[0];
  EXPECT_EQ(without.reversible, with.reversible);
  EXPECT_EQ(without.approach, with.approach);
  EXPECT_EQ(without.retract, with.retract);
  EXPECT_EQ(static_cast<const Task&>(without), static_cast<const Task&>(with));
}

}  // namespace
}  // namespace swivel::io::test
