// SPDX-License-Identifier: BSD-3-Clause
// Jobs: problem files with strokes.
#include "problem_support.hpp"
#include "swivel/core/problem/validate.hpp"

namespace swivel::io::test {
namespace {

using Sections = ProblemFolder::Sections;

/// A folder with a robot, and job files made of sections.
class JobFolder {
 public:
  JobFolder() {
    folder_.folder().write("problems/feed.csv",
                           "x,y,z,qw,qx,qy,qz,feed\n0,0,0,1,0,0,0,0.1\n1,0,0,1,0,0,0,0.02\n");
  }
  /// Sections replace or join those of a job of two strokes.
  [[nodiscard]] fs::path write(const Sections& changes) const {
    Sections sections{{"path", ""},
                      {"strokes", "[{name: a, path: {file: weld.csv}}, {name: b, path: " +
                                      std::string(kPath) + "}]"}};
    for (const auto& [name, text] : changes) sections[name] = text;
    return folder_.write(sections);
  }
  [[nodiscard]] Problem load(const Sections& changes) const { return load_job(write(changes)); }
  /// Returns why a job is refused whose first stroke has these keys besides name and path.
  [[nodiscard]] std::string refusal(const std::string& keys) const {
    return input_error([&] { (void)load({{"strokes", one(keys)}}); });
  }
  /// Returns one stroke with these keys besides name and path.
  [[nodiscard]] static std::string one(const std::string& keys) {
    return "[{name: a, path: " + std::string(kPath) + ", " + keys + "}]";
  }
  [[nodiscard]] const ProblemFolder& folder() const { return folder_; }

  static constexpr const char* kPath =
      "{waypoints: [{xyz: [0.6, -0.1, 0.9]}, {xyz: [0.6, 0.1, 0.9]}]}";

 private:
  ProblemFolder folder_;
};

TEST(JobFile, Defaults) {
  const JobFolder folder;
  const fs::path file = folder.write({});
  const Problem job = load_job(file);
  EXPECT_EQ(job.source, file.string());
  EXPECT_EQ(job.arm().tip_link, "link_7");
  EXPECT_FALSE(job.arm().home);
  EXPECT_EQ(job.arm().order, StrokeOrder::kGiven);
  EXPECT_FALSE(job.arm().process_speed);
  EXPECT_EQ(job.arm().rapid, 1);
  EXPECT_FALSE(job.arm().roll);
  ASSERT_EQ(job.arm().strokes.size(), 2u);
  for (const Stroke& stroke : job.arm().strokes) {
    EXPECT_EQ(stroke.path_frame, "base_link");
    EXPECT_EQ(stroke.waypoints.size(), 2u);
    EXPECT_FALSE(stroke.reversible);
    EXPECT_EQ(stroke.approach, Vector3d::Zero());
    EXPECT_EQ(stroke.retract, Vector3d::Zero());
    EXPECT_FALSE(stroke.process_speed);
    EXPECT_TRUE(stroke.feed.empty());
    EXPECT_EQ(stroke.limits, Limits());
  }
  EXPECT_EQ(job.arm().strokes[0].name, "a");
  EXPECT_EQ(job.arm().strokes[1].name, "b");
  EXPECT_NO_THROW(validate(job));
}

TEST(JobFile, KeysOfTheJobAndOfStrokes) {
  const JobFolder folder;
  const Problem job = folder.load(
      {{"scene", "[{name: part, box: [0.1, 0.1, 0.1]}]"},
       {"home", "{joints: [0, 0.5, 0, 1, 0, 0.5, 0.1]}"},
       {"approach", "0.05"},
       {"retract", "{xyz: [0.01, 0, -0.02]}"},
       {"order", "best"},
       {"process_speed", "0.2"},
       {"approach_speed", "0.3"},
       {"rapid", "0.5"},
       {"resolution", "{ds: 0.01}"},
       {"cost", "{metric: max, weights: [1, 1, 1, 1, 1, 1, 0.5]}"},
       {"refine", "{smoothing: 0.02}"},
       {"vary", "[{object: part, xyz: [0.1, 0, 0]}]"},
       {"limits", "{clearance: 0.004, joint_step: 0.4, tool_path_error: 0.002, joint_speed: 1}"},
       {"strokes", std::string("[{name: a, path: {frame: part, file: feed.csv}},") +
                       "{name: b, path: " + JobFolder::kPath +
                       ", reversible: true, approach: {xyz: [0, 0.03, 0]}, retract: 0, "
                       "process_speed: 0.3, limits: {clearance: 0.001, tool_path_error: null}}]"}});
  EXPECT_NO_THROW(validate(job));
  ASSERT_TRUE(job.arm().home);
  EXPECT_EQ((*job.arm().home)[6], 0.1);
  EXPECT_EQ(job.arm().order, StrokeOrder::kBest);
  EXPECT_EQ(job.arm().process_speed, 0.2);
  EXPECT_EQ(job.arm().approach_speed, 0.3);
  EXPECT_EQ(job.arm().transition_limits.clearance, 0.004);
  EXPECT_EQ(job.arm().rapid, 0.5);
  EXPECT_EQ(job.scene.size(), 1u);
  EXPECT_EQ(job.vary.size(), 1u);
  const Stroke &a = job.arm().strokes[0], &b = job.arm().strokes[1];
  for (const Stroke* stroke : {&a, &b}) {
    EXPECT_EQ(stroke->resolution.ds, 0.01);
    EXPECT_EQ(stroke->cost.metric, CostMetric::kMax);
    EXPECT_EQ(stroke->cost.weights->back(), 0.5);
    EXPECT_EQ(stroke->refinement.smoothing, 0.02);
    EXPECT_EQ(stroke->limits.joint_step, 0.4);
    EXPECT_EQ((*stroke->limits.joint_speed)[3], 1);
  }
  EXPECT_EQ(a.path_frame, "part");
  EXPECT_EQ(b.path_frame, "base_link");
  EXPECT_EQ(a.approach, Vector3d(0, 0, -0.05));
  EXPECT_EQ(a.retract, Vector3d(0.01, 0, -0.02));
  EXPECT_EQ(a.feed, (std::vector<double>{0.1, 0.02}));
  EXPECT_FALSE(a.process_speed);
  EXPECT_EQ(a.limits.clearance, 0.004);
  EXPECT_EQ(a.limits.tool_path_error, 0.002);
  EXPECT_TRUE(b.reversible);
  EXPECT_EQ(b.approach, Vector3d(0, 0.03, 0));
  EXPECT_EQ(b.retract, Vector3d::Zero());
  EXPECT_TRUE(b.feed.empty());
  EXPECT_EQ(b.process_speed, 0.3);
  EXPECT_EQ(b.limits.clearance, 0.001);
  EXPECT_FALSE(b.limits.tool_path_error);
}

TEST(JobFile, RollIsShared) {
  const JobFolder folder;
  const auto path = [](const std::string& roll, const std::string& window) {
    return "{" + roll + "waypoints: [{xyz: [0.6, -0.1, 0.9]" + window + "}, {xyz: [0.6, 0.1, 0.9]" +
           window + "}]}";
  };
  const auto load = [&](const std::string& first, const std::string& second) {
    return folder.load(
        {{"strokes", "[{name: a, path: " + first + "}, {name: b, path: " + second + "}]"}});
  };
  const Problem free = load(path("roll: free, ", ""), path("roll: free, ", ""));
  EXPECT_EQ(free.arm().roll, Roll{});
  EXPECT_FALSE(free.arm().strokes[1].cost.weights);
  const Problem windows =
      load(path("roll: free, ", ", roll: [-0.5, 0]"), path("roll: free, ", ", roll: [0.1, 0.7]"));
  EXPECT_EQ(windows.arm().roll, (Roll{-0.5, 0.7}));
  EXPECT_NO_THROW(validate(windows));
  const Problem one =
      load(path("roll: [-1, 1], ", ", roll: [-0.5, 0]"), path("roll: [-1, 1], ", ""));
  EXPECT_EQ(one.arm().roll, (Roll{-1, 1}));
  EXPECT_NO_THROW(validate(one));
  expect_message(input_error([&] { (void)load(path("roll: free, ", ""), path("", "")); }),
                 {"strokes[1].path", "another roll than strokes[0].path", "the same `roll`"});
  expect_message(input_error([&] {
                   (void)load(path("roll: free, ", ", roll: [-0.5, 0]"), path("roll: free, ", ""));
                 }),
                 {"leave a whole turn"});
}

TEST(JobFile, OnePathIsAJobOfOneStroke) {
  const ProblemFolder folder;
  const fs::path file = folder.write({{"limits", "{clearance: 0.003}"}});
  const Problem job = load_job(file);
  ASSERT_EQ(job.arm().strokes.size(), 1u);
  EXPECT_EQ(job.arm().strokes[0].name, "path");
  const PathProblem problem = load_path_problem(file);
  EXPECT_EQ(static_cast<const Task&>(job.arm().strokes[0]), static_cast<const Task&>(problem));
  for (const char* const key : {"start: {joints: [0, 0, 0, 0, 0, 0, 0]}", "start_at: 0.1"}) {
    const std::string text = key;
    const auto colon = text.find(':');
    expect_message(
        input_error([&] {
          (void)load_job(folder.write({{text.substr(0, colon), text.substr(colon + 1)}}));
        }),
        {text.substr(0, colon) + ": is of problems with one path", "`home`"});
  }
}

TEST(JobFile, OneOfPathAndStrokes) {
  const JobFolder folder;
  const auto both = [](const auto& load) {
    expect_message(input_error(load), {"problem.yaml:", "path and strokes are both given"});
  };
  both([&] { (void)folder.load({{"path", "{file: weld.csv}"}}); });
  both([&] { (void)load_path_problem(folder.write({{"path", "{file: weld.csv}"}})); });
  for (const char* const strokes : {"", "null"})
    expect_message(input_error([&] {
                     (void)folder.load({{"strokes", strokes}});
                   }),
                   {"path: is missing", "`strokes`"});
}

TEST(JobFile, ProblemsAreNoJobs) {
  const JobFolder folder;
  const std::string message = input_error([&] { (void)load_path_problem(folder.write({})); });
  expect_message(message, {"problem.yaml:2: strokes: makes this file a job",
                           "`swivel plan`, `check`, `time`, `campaign`, `place`", "a `path`"});
  const Sections keys{{"home", "{joints: [0, 0, 0, 0, 0, 0, 0]}"},
                      {"order", "best"},
                      {"rapid", "0.5"},
                      {"approach", "0.1"},
                      {"retract", "0.1"},
                      {"process_speed", "0.1"}};
  for (const auto& [key, text] : keys)
    expect_message(input_error([&] {
                     (void)folder.folder().load({{key, text}});
                   }),
                   {key + ": is given without strokes"});
}

TEST(JobFile, LiftOffs) {
  const JobFolder folder;
  EXPECT_FALSE(folder.load({}).arm().lift);
  EXPECT_FALSE(folder.load({{"lift", "{allowed: false, cost: 2}"}}).arm().lift);
  EXPECT_EQ(folder.load({{"lift", "{allowed: true}"}}).arm().lift, LiftOffs());
  EXPECT_EQ(folder.load({{"lift", "{allowed: true, cost: 2, overlap: 0.01}"}}).arm().lift,
            (LiftOffs{2, 0.01}));
  expect_message(input_error([&] {
                   (void)folder.load({{"lift", "{allowed: true}"}, {"order", "best"}});
                 }),
                 {"lift: is given with `order: best`", "`order: given`"});
  // one path with lift-offs is a job of one stroke
  const auto one = [&](const char* lift) { return folder.folder().write({{"lift", lift}}); };
  const Problem read = load_problem(one("{allowed: true}"));
  EXPECT_FALSE(is_path(read));
  EXPECT_EQ(read.arm().strokes.size(), 1u);
  EXPECT_TRUE(is_path(load_problem(one("{allowed: false}"))));
  expect_message(input_error([&] { (void)load_path_problem(one("{allowed: true}")); }),
                 {"lift: makes this file a job", "no `lift`"});
}

TEST(JobFile, LoadedByItsKey) {
  const JobFolder folder;
  EXPECT_FALSE(is_path(load_problem(folder.write({}))));
  EXPECT_TRUE(is_path(load_problem(folder.folder().write({}))));
}

TEST(JobFile, WhatStrokesMayNotHave) {
  const JobFolder folder;
  struct Case {
    const char* keys;
    std::vector<std::string> needles;
  };
  const Case cases[] = {
      {"closed: true", {"strokes[0].closed: is of the path", "`path` of the stroke"}},
      {"end: {joints: []}", {"strokes[0].end: is of the path", "`path` of the stroke"}},
      {"lift: {allowed: true}", {"strokes[0].lift: is not supported yet"}},
      {"start: {joints: [0, 0, 0, 0, 0, 0, 0]}", {"strokes[0].start: is of problems", "`home`"}},
      {"reversable: true", {"strokes[0].reversable: unknown key", "'reversible'"}},
      {"reversible: maybe", {"strokes[0].reversible: 'maybe' is neither", "true or false"}},
      {"approach: -0.1", {"strokes[0].approach: is -0.1"}},
      {"approach: 50", {"strokes[0].approach: is 50 m", "millimetres", "at most"}},
      {"retract: {xyz: [0, 0, 60]}", {"strokes[0].retract: is 60 m", "millimetres"}},
      {"retract: {rpy: [0, 0, 60]}", {"strokes[0].retract.rpy: unknown key", "xyz"}},
      {"retract: {}", {"strokes[0].retract.xyz: is missing"}},
      {"process_speed: 0", {"strokes[0].process_speed: is 0", "> 0"}},
      {"process_speed: 100", {"strokes[0].process_speed: a speed is 100 m/s", "millimetres"}},
      {"limits: {clearence: 1}", {"strokes[0].limits.clearence: unknown key", "'clearance'"}},
      {"limits: {clearance: 5}", {"strokes[0].limits.clearance: is 5 m", "millimetres"}},
      {"limits: {soft_limits: false}", {"strokes[0].limits.soft_limits: is of the robot"}},
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(one.keys);
    expect_message(folder.refusal(one.keys), one.needles);
  }
}

TEST(JobFile, WhatJobsMayNotHave) {
  const JobFolder folder;
  struct Case {
    const char *key, *text;
    std::vector<std::string> needles;
  };
  const Case cases[] = {
      {"lift", "{}", {"lift.allowed: is missing"}},
      {"lift", "{allowed: 1}", {"lift.allowed: '1' is neither", "true or false"}},
      {"lift", "{allowed: true, cost: -1}", {"lift.cost: is -1", ">= 0"}},
      {"lift", "{allowed: true, overlap: -0.01}", {"lift.overlap: is -0.01", ">= 0"}},
      {"lift", "{allowed: true, retract: 1}", {"lift.retract: unknown key"}},
      {"order", "fastest", {"order: is 'fastest'", "given, best"}},
      {"rapid", "0", {"rapid: is 0", "at most 1"}},
      {"rapid", "1.01", {"rapid: is 1.01", "at most 1"}},
      {"process_speed", "-1", {"process_speed: is -1"}},
      {"home", "{joints: [0, 0]}", {"home.joints: has 2 entries", "7 numbers"}},
      {"home", "{}", {"home.joints: is missing"}},
      {"start", "{joints: [0, 0, 0, 0, 0, 0, 0]}", {"start: is of problems", "`home`"}},
      {"start_tolerance", "0.01", {"start_tolerance: is of problems", "`home`"}},
      {"approach", ".nan", {"approach: is .nan"}},
      {"strokes", "[]", {"strokes: has 0 strokes", "from 1 to 1000"}},
      {"strokes", "{}", {"strokes: a map is not a list"}},
      {"strokes", "[{path: {file: weld.csv}}]", {"strokes[0].name: is missing", "a name"}},
      {"strokes", "[{name: a}]", {"strokes[0].path: is missing"}},
      {"strokes", "[{name: a, path: {file: no.csv}}]", {"strokes[0].path.file", "no.csv"}},
      {"strokes", "[{name: a, path: {frame: part, file: weld.csv}}]", {"unknown frame 'part'"}},
      {"strokes", "[{name: '', path: {file: weld.csv}}]", {"strokes[0].name"}},
      {"strokes", "[{name: 'a,b', path: {file: weld.csv}}]", {"strokes[0].name", "commas"}},
      {"strokes", "[{name: ' a', path: {file: weld.csv}}]", {"strokes[0].name", "outer spaces"}},
      {"strokes", "[{name: 'a\"b', path: {file: weld.csv}}]", {"strokes[0].name", "quotes"}},
      {"strokes", "[{name: \"a\\nb\", path: {file: weld.csv}}]", {"strokes[0].name"}},
      {"strokes",
       "[{name: a, path: {file: weld.csv}}, {name: a, path: {file: weld.csv}}]",
       {"strokes[1].name", "'a' is the name of another stroke"}},
      {"strokes",
       "[{name: a, path: {file: weld.csv, closed: true}}]",
       {"strokes[0].path.closed: is true, but the last waypoint is"}},
      {"strokes",
       "[{name: a, path: {file: weld.csv, end: {joints: [1, 2]}}}]",
       {"strokes[0].path.end.joints: has 2 entries", "7 numbers"}},
      {"strokes",
       "[{name: a, reversible: true, path: {file: weld.csv, end: {joints: [0, 0, 0, 0, 0, 0, "
       "0]}}}]",
       {"strokes[0].path.end: is given of a stroke that may be reversed", "not `reversible`"}},
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(std::string(one.key) + ": " + one.text);
    expect_message(input_error([&] { (void)folder.load({{one.key, one.text}}); }), one.needles);
  }
}

TEST(JobFile, AtMostAThousandStrokes) {
  const JobFolder folder;
  const auto strokes = [](int count) {
    std::string text = "[";
    for (int k = 0; k < count; ++k)
      text += "{name: s" + std::to_string(k) + ", path: {file: weld.csv}}, ";
    return text + "]";
  };
  EXPECT_EQ(folder.load({{"strokes", strokes(1000)}}).arm().strokes.size(), 1000u);
  expect_message(input_error([&] {
                   (void)folder.load({{"strokes", strokes(1001)}});
                 }),
                 {"strokes: has 1001 strokes", "1000"});
}

TEST(JobFile, FeedOfWaypoints) {
  const JobFolder folder;
  const auto load = [&](const std::string& csv) {
    folder.folder().folder().write("problems/f.csv", csv);
    return folder.load({{"strokes", "[{name: a, path: {roll: [-1, 1], file: f.csv}}]"}});
  };
  const std::string rolls = "x,y,z,qw,qx,qy,qz,roll_min,roll_max,feed\n";
  EXPECT_EQ(load(rolls + "0,0,0,1,0,0,0,0,1,0.5\n1,0,0,1,0,0,0,0,1,0.25\n").arm().strokes[0].feed,
            (std::vector<double>{0.5, 0.25}));
  for (const char* const feed : {"0", "-0.1"})
    expect_message(input_error([&] {
                     (void)load(rolls + "0,0,0,1,0,0,0,0,1,0.5\n1,0,0,1,0,0,0,0,1," + feed + "\n");
                   }),
                   {"f.csv:3: data row 2", "feed: is", "> 0"});
  expect_message(
      input_error([&] { (void)load(rolls + "0,0,0,1,0,0,0,0,1,50\n1,0,0,1,0,0,0,0,1,50\n"); }),
      {"strokes[0].path", "50 m/s", "millimetres"});
  // Problems have no feeds: a warning says so.
  const PathProblem problem = folder.folder().load({{"path", "{file: feed.csv}"}});
  ASSERT_EQ(problem.model->warnings.size(), 1u);
  EXPECT_NE(problem.model->warnings[0].find("feed.csv:1: column feed is not used"),
            std::string::npos)
      << problem.model->warnings[0];
}

}  // namespace
}  // namespace swivel::io::test
