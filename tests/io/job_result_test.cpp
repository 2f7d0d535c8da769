// SPDX-License-Identifier: BSD-3-Clause
// What is written of a job: its trajectory, which is read again, and its result.
#include <nlohmann/json.hpp>
#include <set>

#include "io_support.hpp"
#include "seed.hpp"
#include "swivel/io/schema/schema_text.hpp"

namespace swivel::io::test {
namespace {

using Json = nlohmann::ordered_json;

const JointNames kNames{"a", "b", "c", "d", "e", "f", "g"};

/// A job of two strokes of 0.1 m, the first between lines of 0.02 m and 0.03 m.
Problem two_strokes() {
  Problem job;
  for (const char* const name : {"left", "right"}) {
    Stroke& stroke = job.arm().strokes.emplace_back();
    stroke.name = name;
    stroke.waypoints.resize(3);
    stroke.waypoints[1].position.x() = 0.05;
    stroke.waypoints[2].position.x() = 0.1;
  }
  job.arm().strokes[0].approach.z() = -0.02;
  job.arm().strokes[0].retract.z() = -0.03;
  job.arm().home = Config::Zero();
  return job;
}

/// Returns rows at these places, with joints from `first` on.
std::vector<TrajectoryRow> rows_at(const std::vector<double>& places, double first) {
  std::vector<TrajectoryRow> rows;
  for (const double s : places) rows.push_back({s, 0.1 + s, 5, Config::Constant(first += 0.125)});
  return rows;
}

/// Returns the plan of two_strokes(): home, right backwards, left, home.
Answer plan_of_two() {
  Answer result;
  result.status = PlanStatus::kSolved;
  result.cost = 6.25;
  result.lattice_cost = 6;
  result.bound = 5;
  result.bound_any = 4;
  result.bound_orders = 4.5;
  result.planner = "parallel";
  result.arm().joint_names = kNames;
  result.arm().transitions = {7, 2, 3};
  const StrokeRun first{1, true}, second{0, false};
  const auto run = [&](const StrokeRun& of, double cost, std::vector<TrajectoryRow> rows) {
    RunAnswer found;
    found.run = of;
    found.status = PlanStatus::kSolved;
    found.least_cost = cost / 2;
    found.evidence = Evidence::all();
    found.min_clearance = 0.01;
    found.lattice.layers = static_cast<int>(rows.size());
    result.arm().runs.push_back(found);
    result.arm().parts.push_back({of, cost, std::move(rows)});
  };
  const auto move = [&](std::vector<TrajectoryRow> rows) {
    result.arm().parts.push_back({std::nullopt, 1, std::move(rows)});
  };
  move(rows_at({0, 0}, 0));
  run(first, 2, rows_at({0, 0.05, 0.1}, 0.125));
  move(rows_at({0, 0, 0}, 0.375));
  run(second, 1, rows_at({0, 0.01, 0.02, 0.07, 0.12, 0.15}, 0.625));
  move(rows_at({0, 0}, 1.375));
  return result;
}

/// Loads the parts of two_strokes() from a file without times.
GivenArm load_parts(const fs::path& file) {
  GivenAnswer given = load_answer(file, two_strokes(), {kNames});
  EXPECT_FALSE(given.has_times());
  return std::move(given.arms.front());
}

TEST(JobTrajectory, HeaderAndRows) {
  const std::string text = to_csv(plan_of_two(), two_strokes());
  EXPECT_TRUE(
      text.starts_with("s,phi,branch,a,b,c,d,e,f,g,stroke,process\n"
                       ",,,0.125,0.125,0.125,0.125,0.125,0.125,0.125,,0\n"
                       ",,,0.25,0.25,0.25,0.25,0.25,0.25,0.25,,0\n"
                       "0,0.1"))
      << text;
  EXPECT_NE(text.find(",right,1\n"), std::string::npos);
  EXPECT_NE(text.find(",left,0\n"), std::string::npos);
}

TEST(JobTrajectory, ProcessIsOnTheStrokeItself) {
  const TempFolder folder;
  const GivenArm read = load_parts(folder.write("t.csv", to_csv(plan_of_two(), two_strokes())));
  ASSERT_EQ(read.parts.size(), 5u);
  ASSERT_EQ(read.process.size(), 5u);
  EXPECT_EQ(read.process[0], std::vector<bool>(2, false));
  EXPECT_EQ(read.process[1], std::vector<bool>(3, true));
  // past the approach of 0.02 m, and before the retract
  EXPECT_EQ(read.process[3], (std::vector<bool>{false, false, true, true, true, false}));
}

TEST(JobTrajectory, StrokesAreFoundByName) {
  const Problem job = two_strokes();
  EXPECT_EQ(find_stroke(job, "left"), 0u);
  EXPECT_EQ(find_stroke(job, "right"), 1u);
  EXPECT_EQ(find_stroke(job, ""), std::nullopt);
  EXPECT_EQ(find_stroke(job, "Left"), std::nullopt);
}

TEST(JobTrajectory, EveryBitIsReadAgain) {
  const TempFolder folder;
  swivel::test::Random random(swivel::test::seed("JobTrajectory"));
  int rows = 0;
  for (int round = 0; round < 200; ++round) {
    Answer plan = plan_of_two();
    for (Part& part : plan.arm().parts)
      for (TrajectoryRow& row : part.rows) {
        ++rows;
        for (double& angle : row.q.coordinates())
          angle = random.uniform(-4, 4) * std::pow(10, random.below(20) - 15);
        if (!part.run) continue;
        row.phi = random.uniform(-4, 4);
        row.branch = random.below(8);
        if (round % 2 == 1) row.roll = random.uniform(-4, 4);
      }
    const GivenArm read = load_parts(folder.write("t.csv", to_csv(plan, two_strokes())));
    EXPECT_TRUE(read.stated.rows());
    ASSERT_EQ(read.parts.size(), plan.arm().parts.size());
    for (std::size_t k = 0; k < plan.arm().parts.size(); ++k) {
      const Part& part = plan.arm().parts[k];
      EXPECT_EQ(read.parts[k].run.has_value(), part.run.has_value());
      if (part.run) EXPECT_EQ(read.parts[k].run->stroke, part.run->stroke);
      ASSERT_EQ(read.parts[k].rows.size(), part.rows.size());
      for (std::size_t i = 0; i < part.rows.size(); ++i) {
        const TrajectoryRow &was = part.rows[i], &is = read.parts[k].rows[i];
        EXPECT_EQ(is.q, was.q);
        if (!part.run) continue;
        EXPECT_EQ(is.s, was.s);
        EXPECT_EQ(is.phi, was.phi);
        EXPECT_EQ(is.branch, was.branch);
        EXPECT_EQ(is.roll, was.roll);
      }
    }
  }
  EXPECT_EQ(rows, 200 * 16);
}

/// Columns come in any order, and those that follow from the joints may be missing.
TEST(JobTrajectory, ColumnsAreReadByName) {
  const TempFolder folder;
  const GivenArm read =
      load_parts(folder.write("t.csv",
                              "process,g,f,e,d,c,b,stroke,a,s\n"
                              "0,7,6,5,4,3,2,,1,\n0,7,6,5,4,3,2,,1,\n"
                              "1,7,6,5,4,3,2,left,1,0\n1,7,6,5,4,3,2,left,1,0.5\n"));
  ASSERT_EQ(read.parts.size(), 2u);
  EXPECT_EQ(read.parts[0].run, std::nullopt);
  EXPECT_EQ(read.parts[1].run, (StrokeRun{0, false}));
  EXPECT_EQ(read.parts[1].rows[1].s, 0.5);
  EXPECT_EQ(read.parts[1].rows[1].q, (Config{1, 2, 3, 4, 5, 6, 7}));
  EXPECT_TRUE(read.stated.s && read.stated.last_joint);
  EXPECT_FALSE(read.stated.phi || read.stated.branch || read.stated.roll);
}

const std::string kHeader = "s,phi,branch,a,b,c,d,e,f,g,stroke,process\n",
                  kHome = ",,,0,0,0,0,0,0,0,,0\n", kLeft = "0,0,0,0,0,0,0,0,0,0,left,1\n",
                  kRight = "0,0,0,0,0,0,0,0,0,0,right,1\n", kLine = "0,0,0,0,0,0,0,0,0,0,left,0\n";

struct BadFile {
  const char* name;
  std::string text;
  std::vector<std::string> needles;
};

void expect_refused(const std::vector<BadFile>& files) {
  const TempFolder folder;
  for (const auto& [name, text, needles] : files) {
    SCOPED_TRACE(name);
    const fs::path file = folder.write("t.csv", text);
    expect_message(input_error([&] { (void)load_answer(file, two_strokes(), {kNames}); }), needles);
  }
}

TEST(JobTrajectory, BadFields) {
  expect_refused({
      {"a trajectory",
       "s,phi,branch,a,b,c,d,e,f,g\n0,0,0,0,0,0,0,0,0,0\n",
       {"t.csv:1", "column 'stroke' is missing", "g, stroke, process"}},
      {"no process",
       "s,phi,branch,a,b,c,d,e,f,g,stroke\n0,0,0,0,0,0,0,0,0,0,left\n",
       {"t.csv:1", "column 'process' is missing"}},
      {"another stroke",
       kHeader + kLeft + kLeft + "0,0,0,0,0,0,0,0,0,0,lfet,1\n",
       {"t.csv:4: data row 3", "stroke: 'lfet' is no stroke of the job"}},
      {"other joints",
       "s,phi,branch,a,b,c,d,e,f,x,stroke,process\n" + kLeft + kLeft,
       {"t.csv:1", "column 'x' is unknown, or no joint of the arm", "a, b, c, d, e, f, g"}},
      {"one row", kHeader + kLeft, {"1 data row"}},
      {"process of words",
       kHeader + kLeft + "0,0,0,0,0,0,0,0,0,0,left,on\n",
       {"t.csv:3: data row 2", "process: is 'on'", "0 or 1"}},
      {"s in a transition",
       kHeader + kLeft + kLeft + "0,,,0,0,0,0,0,0,0,,0\n",
       {"t.csv:4: data row 3", "s: is '0' in a transition"}},
      {"no s on a stroke",
       kHeader + kLeft + ",0,0,0,0,0,0,0,0,0,left,1\n",
       {"t.csv:3: data row 2", "s: '' is not a number"}},
      {"no joint",
       kHeader + kLeft + "0,0,0,0,,0,0,0,0,0,left,1\n",
       {"t.csv:3: data row 2", "b: '' is not a number"}},
      {"infinite",
       kHeader + kLeft + "0,0,0,0,inf,0,0,0,0,0,left,1\n",
       {"t.csv:3: data row 2", "b: 'inf' is not a number"}},
      {"branch 8",
       kHeader + kLeft + "0,0,8,0,0,0,0,0,0,0,left,1\n",
       {"t.csv:3: data row 2", "branch: is 8", "0 to 7"}},
      {"columns", kHeader + kLeft + "0,0\n", {"t.csv:3: data row 2", "2 columns"}},
      {"empty", "", {"is empty", "the arm's joints, stroke and process"}},
  });
}

TEST(JobTrajectory, BadParts) {
  expect_refused({
      {"a stroke of one row",
       kHeader + kHome + kHome + kLeft + kHome + kHome,
       {"t.csv:5: data row 4", "stroke 'left' before it has one row", "at least two"}},
      {"a transition of one row",
       kHeader + kHome + kLeft + kLeft,
       {"t.csv:3: data row 2", "the transition before it has one row"}},
      {"one row at the end",
       kHeader + kLeft + kLeft + kHome,
       {"t.csv: the transition before it has one row"}},
      {"a stroke twice",
       kHeader + kLeft + kLeft + kRight + kRight + kLeft + kLeft,
       {"t.csv:6: data row 5", "stroke: 'left' comes twice"}},
      {"no process", kHeader + kLine + kLine, {"fewer than two rows whose process is 1"}},
      {"process again",
       kHeader + kLeft + kLeft + kLine + kLeft,
       {"t.csv:5: data row 4", "process: is 1 again"}},
      {"process in a transition",
       kHeader + ",,,0,0,0,0,0,0,0,,1\n" + kHome,
       {"t.csv:2: data row 1", "process: is 1 in a transition"}},
  });
}

TEST(JobResult, Solved) {
  const Json json = Json::parse(to_json(plan_of_two(), two_strokes()));
  EXPECT_EQ(json["status"], "solved");
  EXPECT_EQ(json["cost"], 6.25);
  EXPECT_EQ(json["lattice_cost"], 6.0);
  EXPECT_EQ(json["bound"], 5.0);
  EXPECT_EQ(json["bound_any"], 4.0);
  EXPECT_EQ(json["bound_orders"], 4.5);
  EXPECT_NEAR(json["gap"].get<double>(), 0.2, 1e-12);
  EXPECT_EQ(json["order"], Json::parse(R"([{"stroke": "right", "reversed": true},
                                           {"stroke": "left", "reversed": false}])"));
  ASSERT_EQ(json["runs"].size(), 2u);
  EXPECT_EQ(json["runs"][0]["stroke"], "right");
  EXPECT_EQ(json["runs"][0]["cost"], 2.0);
  EXPECT_EQ(json["runs"][0]["least_cost"], 1.0);
  EXPECT_EQ(json["runs"][0]["min_clearance"], 0.01);
  EXPECT_TRUE(json["runs"][0]["diagnosis"].is_null());
  EXPECT_EQ(json["transitions"],
            Json::parse(R"([{"from": null, "to": "right", "cost": 1.0, "via": 0},
                            {"from": "right", "to": "left", "cost": 1.0, "via": 1},
                            {"from": "left", "to": null, "cost": 1.0, "via": 0}])"));
  EXPECT_EQ(json["transition_counters"],
            Json::parse(R"({"pairs": 7, "searches": 2, "rounds": 3})"));
  ASSERT_EQ(json["parts"].size(), 5u);
  EXPECT_TRUE(json["parts"][0]["stroke"].is_null());
  EXPECT_EQ(json["parts"][0]["rows"][1]["joints"][0], 0.25);
  EXPECT_FALSE(json["parts"][0]["rows"][1].contains("s"));
  EXPECT_EQ(json["parts"][1]["reversed"], true);
  EXPECT_EQ(json["parts"][3]["rows"][1]["process"], false);
  EXPECT_EQ(json["parts"][3]["rows"][2]["process"], true);
  EXPECT_EQ(json["parts"][3]["rows"][2]["branch"], 5);
  Answer optimal = plan_of_two();
  optimal.bound = optimal.lattice_cost;
  EXPECT_EQ(Json::parse(to_json(optimal, two_strokes()))["gap"], 0.0);
  optimal.lattice_cost = optimal.bound = 0;
  EXPECT_EQ(Json::parse(to_json(optimal, two_strokes()))["gap"], 0.0);
  optimal.lattice_cost = 1;
  EXPECT_TRUE(Json::parse(to_json(optimal, two_strokes()))["gap"].is_null());
}

/// Returns the result where a stroke has no path, or where no way leads to a run.
Answer without_a_job(bool stroke) {
  Answer result = plan_of_two();
  result.status = PlanStatus::kInfeasible;
  result.arm().parts.clear();
  if (stroke) {
    result.arm().runs[0].status = PlanStatus::kInfeasible;
    result.arm().runs[0].diagnosis.emplace();
    return result;
  }
  result.arm().no_transition = {
      .to = 2, .where = NoTransition::Where::kEndBefore, .bodies = {{"link_5", "post"}}};
  return result;
}

TEST(JobResult, Unsolved) {
  const Json stroke = Json::parse(to_json(without_a_job(true), two_strokes()));
  for (const char* const key :
       {"cost", "bound", "bound_any", "bound_orders", "gap", "checked", "no_transition"})
    EXPECT_TRUE(stroke[key].is_null()) << key;
  EXPECT_EQ(stroke["runs"][0]["status"], "infeasible");
  EXPECT_TRUE(stroke["runs"][0]["least_cost"].is_null());
  EXPECT_TRUE(stroke["runs"][0]["cost"].is_null());
  EXPECT_FALSE(stroke["runs"][0]["diagnosis"].is_null());
  EXPECT_EQ(stroke["parts"], Json::array());
  const Json way = Json::parse(to_json(without_a_job(false), two_strokes()));
  EXPECT_EQ(way["no_transition"], Json::parse(R"({"from": "left", "to": null, "where": "end",
                            "bodies": ["link_5", "post"]})"));
}

/// Returns a motion in time of two_strokes(), or why its fourth part has none.
MotionTiming timed_plan(bool executable) {
  MotionTiming timed;
  if (!executable) {
    timed.failure = NoMotion{0.05, "the solution changes from branch 4 to 5"};
    timed.failed_part = 3;
    return timed;
  }
  ArmMotion& motion = timed.motion.emplace().arms.emplace_back();
  motion.rows.resize(3);
  motion.rate = 250;
  motion.duration = 0.008;
  motion.events = {{0.004, 1, 0, true}, {0.008, 1, 0.1, false}};
  motion.warnings = {"a warning"};
  return timed;
}

TEST(JobResult, Motions) {
  const Problem job = two_strokes();
  EXPECT_TRUE(Json::parse(to_json(plan_of_two(), job))["motion"].is_null());
  Answer good = plan_of_two(), bad = plan_of_two(), stopped = plan_of_two();
  good.motion = timed_plan(true);
  bad.motion = timed_plan(false);
  stopped.stopped = true;
  EXPECT_EQ(Json::parse(to_json(good, job))["motion"],
            Json::parse(R"({"executable": true, "reason": null, "part": null, "at_s": null,
                            "rate": 250.0, "samples": 3, "duration": 0.008, "events": [
                            {"t": 0.004, "stroke": "right", "s": 0.0, "process": "on"},
                            {"t": 0.008, "stroke": "right", "s": 0.1, "process": "off"}],
                            "warnings": ["a warning"]})"));
  EXPECT_EQ(Json::parse(to_json(bad, job))["motion"], Json::parse(R"({"executable": false,
                            "reason": "the solution changes from branch 4 to 5",
                            "part": 3, "at_s": 0.05})"));
  EXPECT_EQ(Json::parse(to_json(stopped, job))["motion"]["reason"], "stopped");
}

TEST(JobResult, Refinements) {
  Answer answer = plan_of_two();
  EXPECT_TRUE(Json::parse(to_json(answer, two_strokes()))["refinement"].is_null());
  ASSERT_EQ(answer.arm().runs.size(), 2u);
  RefinedRuns& refined = answer.refinement.emplace();
  refined.cost_before = 3;
  refined.cost = 2.5;
  refined.runs = {{.refined = true, .cost_before = 2, .cost = 1.5},
                  {.reason = "stopped", .cost_before = 1, .cost = 1}};
  const Json json = Json::parse(to_json(answer, two_strokes()))["refinement"];
  EXPECT_EQ(json["cost_before"], 3);
  EXPECT_EQ(json["cost"], 2.5);
  ASSERT_EQ(json["runs"].size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    const StrokeRun& run = answer.arm().runs[k].run;
    EXPECT_EQ(json["runs"][k]["stroke"], two_strokes().arm().strokes[run.stroke].name);
    EXPECT_EQ(json["runs"][k]["reversed"], run.reversed);
    EXPECT_EQ(json["runs"][k]["refined"], k == 0);
    EXPECT_EQ(json["runs"][k]["cost"], refined.runs[k].cost);
  }
  EXPECT_EQ(json["runs"][1]["reason"], "stopped");
}

/// Adds the names of all keys of a document; list items count as one.
void add_keys(const Json& value, const std::string& at, std::set<std::string>& keys) {
  if (value.is_array())
    for (const Json& item : value) add_keys(item, at + "[]", keys);
  if (!value.is_object()) return;
  for (const auto& [key, item] : value.items()) {
    keys.insert(at + "." + key);
    if (key != "stages" && key != "removed") add_keys(item, at + "." + key, keys);
  }
}

/// Adds the names of all keys that a schema allows.
void add_keys_of_schema(const Json& schema, const std::string& at, std::set<std::string>& keys) {
  if (schema.contains("anyOf")) {
    for (const Json& option : schema["anyOf"]) add_keys_of_schema(option, at, keys);
    return;
  }
  if (schema["type"] == "array") add_keys_of_schema(schema["items"], at + "[]", keys);
  if (!schema.contains("properties")) return;
  for (const auto& [key, item] : schema["properties"].items()) {
    keys.insert(at + "." + key);
    add_keys_of_schema(item, at + "." + key, keys);
  }
}

TEST(JobResult, KeysAreThoseOfTheSchema) {
  std::set<std::string> known, seen;
  const Json schema = Json::parse(result_json_schema());
  for (const Json& option : schema["anyOf"])
    if (option["properties"].contains("parts")) add_keys_of_schema(option, "", known);
  EXPECT_GE(known.size(), 100u);
  Answer turning = plan_of_two();
  turning.arm().parts[1].rows[0].roll = 0.1;
  Answer unproved = turning;
  unproved.arm().partial.swap(unproved.arm().parts);
  for (const Answer& result : {turning, unproved, without_a_job(true), without_a_job(false)})
    add_keys(Json::parse(to_json(result, two_strokes())), "", seen);
  Answer timed = plan_of_two();
  timed.motion = timed_plan(true);
  timed.refinement.emplace().runs.resize(timed.arm().runs.size());
  add_keys(Json::parse(to_json(timed, two_strokes())), "", seen);
  Answer lifted = plan_of_two();
  lifted.arm().lift_offs.push_back({{0, 0.05, 0.05}, 0.06, {.kind = Cause::Kind::kSingular}});
  add_keys(Json::parse(to_json(lifted, executed_problem(two_strokes(), lifted))), "", seen);
  AdviceList advice;
  advice.changes.push_back({.change = Advice::Change::kHome, .home = Config::Zero()});
  advice.alone.push_back({"left", false, {Advice{}}});
  add_keys(Json::parse(to_json(without_a_job(true), two_strokes(), {.advice = &advice})), "", seen);
  for (const std::string& key : seen) EXPECT_TRUE(known.contains(key)) << key;
  // The parts that plans have as well are tested with those (result_test.cpp, tests/docs).
  for (const std::string& key : known) {
    const bool of_plans = key.starts_with(".runs[].") && key.find('.', 8) != std::string::npos;
    if (!of_plans && !key.starts_with(".held[]") && !key.starts_with(".robot_pairs."))
      EXPECT_TRUE(seen.contains(key)) << key;
  }
}

}  // namespace
}  // namespace swivel::io::test
