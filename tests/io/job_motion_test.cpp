// SPDX-License-Identifier: BSD-3-Clause
// What is written of a job's motion in time, and read again.
#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "io_support.hpp"
#include "seed.hpp"

namespace swivel::io::test {
namespace {

using swivel::test::Random;

const JointNames kNames{"a", "b", "c", "d", "e", "f", "g"};

/// A job of two strokes, with a home or without.
Problem two_strokes(bool home) {
  Problem job;
  job.source = "job.yaml";
  for (const char* const name : {"left", "right"}) {
    Stroke& stroke = job.arm().strokes.emplace_back();
    stroke.name = name;
    stroke.waypoints.resize(2);
    stroke.waypoints[1].position.x() = 0.1;
  }
  if (home) job.arm().home = Config::Zero();
  return job;
}

/// Returns a motion of two_strokes(), the second first. Its numbers are random. It
/// has lines before and after the strokes where `lines` is true.
ArmMotion random_motion(Random& random, const Problem& job, bool lines, bool rolls) {
  ArmMotion motion;
  motion.rate = 250;
  const std::size_t parts = job.arm().home ? 5 : 3;
  const std::size_t first_run = job.arm().home ? 1 : 0;
  const auto of_run = [&](std::size_t part) { return part % 2 == first_run; };
  for (std::size_t part = 0; part < parts; ++part) {
    const int count = 4 + static_cast<int>(random.below(5));
    for (int k = 0; k < count; ++k) {
      TimedRow row;
      row.t = static_cast<double>(motion.rows.size()) / motion.rate;
      for (Config* values : {&row.row.q, &row.v, &row.a})
        for (double& value : values->coordinates())
          value = random.uniform(-4, 4) * std::pow(10, random.below(20) - 15);
      const bool begins = k + 1 == count && part + 1 < parts && of_run(part + 1);
      if (of_run(part) || begins) {
        row.row.s = begins ? 0 : 0.01 * (k + 1);
        row.row.phi = random.uniform(-4, 4);
        row.row.branch = random.below(8);
        if (rolls) row.row.roll = random.uniform(-4, 4);
      }
      motion.rows.push_back(row);
      motion.part.push_back(part);
    }
    if (!of_run(part)) continue;
    const std::size_t end = motion.rows.size() - 1,
                      begin =
                          motion.rows.size() - static_cast<std::size_t>(count) - (part > 0 ? 1 : 0),
                      on = lines ? begin + 1 : begin, off = lines ? end - 1 : end;
    const std::size_t stroke = part == first_run ? 1 : 0;
    motion.events.push_back({motion.rows[on].t, stroke, motion.rows[on].row.s, true});
    motion.events.push_back({motion.rows[off].t, stroke, motion.rows[off].row.s, false});
  }
  motion.duration = motion.rows.back().t;
  return motion;
}

std::string text_of(const ArmMotion& motion, const Problem& job, const char* name) {
  Motion all;
  all.arms.push_back(motion);
  return text_of_motion(all, job, {kNames}, name);
}

/// Loads a motion from a file that has times.
GivenArm load_motion(const fs::path& file, const Problem& job) {
  GivenAnswer given = load_answer(file, job, {kNames});
  EXPECT_TRUE(given.has_times());
  return std::move(given.arms.front());
}

/// The second stroke, then the first one; directions are not stated.
const std::vector<StrokeRun> kOrder{{1, false}, {0, false}};

void expect_same(const ArmMotion& is, const ArmMotion& was) {
  ASSERT_EQ(is.rows.size(), was.rows.size());
  for (std::size_t k = 0; k < is.rows.size(); ++k) {
    EXPECT_EQ(is.rows[k].t, was.rows[k].t);
    EXPECT_EQ(is.rows[k].v, was.rows[k].v);
    EXPECT_EQ(is.rows[k].a, was.rows[k].a);
    EXPECT_EQ(is.rows[k].row.q, was.rows[k].row.q);
    EXPECT_EQ(is.rows[k].row.s, was.rows[k].row.s);
    EXPECT_EQ(is.rows[k].row.phi, was.rows[k].row.phi);
    EXPECT_EQ(is.rows[k].row.branch, was.rows[k].row.branch);
    EXPECT_EQ(is.rows[k].row.roll, was.rows[k].row.roll);
  }
  EXPECT_EQ(is.part, was.part);
  EXPECT_EQ(is.rate, was.rate);
  EXPECT_EQ(is.duration, was.duration);
  ASSERT_EQ(is.events.size(), was.events.size());
  for (std::size_t k = 0; k < is.events.size(); ++k) {
    EXPECT_EQ(is.events[k].t, was.events[k].t);
    EXPECT_EQ(is.events[k].s, was.events[k].s);
    EXPECT_EQ(is.events[k].stroke, was.events[k].stroke);
    EXPECT_EQ(is.events[k].on, was.events[k].on);
  }
}

TEST(JobMotion, EveryBitIsReadAgain) {
  const TempFolder folder;
  Random random(swivel::test::seed("JobMotion"));
  int rows = 0;
  for (int trial = 0; trial < swivel::test::trials(100); ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const Problem job = two_strokes(random.coin());
    const ArmMotion motion = random_motion(random, job, random.coin(), random.coin());
    const fs::path file = folder.write("m.csv", text_of(motion, job, "m.csv"));
    const GivenArm read = load_motion(file, job);
    expect_same(*read.motion, motion);
    EXPECT_EQ(read.order, kOrder);
    EXPECT_TRUE(read.stated.motions() && !read.states_directions && read.parts.empty());
    rows += static_cast<int>(motion.rows.size());
  }
  std::printf("%d rows\n", rows);
  EXPECT_GE(rows, swivel::test::at_least(1200));
}

TEST(JobMotion, OtherFormatsHaveEventsAndAreReadWithoutThem) {
  const TempFolder folder;
  Random random(5);
  const Problem job = two_strokes(true);
  const ArmMotion motion = random_motion(random, job, true, false);
  for (const char* const name : {"m.json", "m.yaml", "m.mcap"}) {
    SCOPED_TRACE(name);
    const std::string text = text_of(motion, job, name);
    const TrajectoryFile read = load_trajectory_file(folder.write(name, text), kNames);
    ASSERT_EQ(read.rows.size(), motion.rows.size());
    for (std::size_t k = 0; k < read.rows.size(); ++k)
      EXPECT_EQ(read.rows[k].q, motion.rows[k].row.q);
    for (const ProcessEvent& event : motion.events)
      EXPECT_NE(text.find("\"stroke\": \"" + job.arm().strokes[event.stroke].name + "\", \"s\": "),
                std::string::npos);
  }
  const auto json = nlohmann::json::parse(text_of(motion, job, "m.json"));
  ASSERT_EQ(json["events"].size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(json["events"][k]["t"].get<double>(), motion.events[k].t);
    EXPECT_EQ(json["events"][k]["s"].get<double>(), motion.events[k].s);
    EXPECT_EQ(json["events"][k]["stroke"], k < 2 ? "right" : "left");
    EXPECT_EQ(json["events"][k]["process"], k % 2 == 0 ? "on" : "off");
  }
  expect_message(input_error([&] { (void)text_of(motion, job, "m.bag"); }), {"m.bag", ".mcap"});
}

/// Messages and logs hold joints, times to the nanosecond and events; the log no accelerations.
TEST(JobMotion, OtherFormatsAreReadAgain) {
  const TempFolder folder;
  Random random(swivel::test::seed("JobMotionMessages"));
  int files = 0;
  for (int trial = 0; trial < swivel::test::trials(100); ++trial) {
    const Problem job = two_strokes(random.coin());
    const ArmMotion motion = random_motion(random, job, random.coin(), false);
    for (const char* const name : {"m.json", "m.yaml", "m.mcap"}) {
      SCOPED_TRACE(std::string(name) + ", trial " + std::to_string(trial));
      const std::string text = text_of(motion, job, name);
      const GivenArm read = load_motion(folder.write(name, text), job);
      const bool log = name == std::string("m.mcap");
      EXPECT_FALSE(read.stated.s || read.stated.phi || read.stated.branch || read.stated.roll);
      EXPECT_EQ(read.stated.a, !log);
      EXPECT_EQ(read.order, kOrder);
      EXPECT_EQ(read.motion->part, motion.part);
      ASSERT_EQ(read.motion->rows.size(), motion.rows.size());
      for (std::size_t k = 0; k < motion.rows.size(); ++k) {
        const TimedRow &is = read.motion->rows[k], &was = motion.rows[k];
        EXPECT_NEAR(is.t, was.t, 1e-9);
        EXPECT_EQ(is.row.q, was.row.q);
        EXPECT_EQ(is.v, was.v);
        if (!log) EXPECT_EQ(is.a, was.a);
      }
      ASSERT_EQ(read.motion->events.size(), motion.events.size());
      for (std::size_t k = 0; k < motion.events.size(); ++k) {
        const ProcessEvent &is = read.motion->events[k], &was = motion.events[k];
        EXPECT_NEAR(is.t, was.t, 1e-9);
        EXPECT_EQ(is.s, was.s);
        EXPECT_EQ(is.stroke, was.stroke);
        EXPECT_EQ(is.on, was.on);
      }
      ++files;
    }
  }
  EXPECT_GE(files, swivel::test::at_least(300));
}

TEST(JobMotion, TrajectoryFilesRefuseRowsOfJobs) {
  const TempFolder folder;
  Random random(6);
  const Problem job = two_strokes(true);
  const ArmMotion motion = random_motion(random, job, true, false);
  const fs::path file = folder.write("m.csv", text_of(motion, job, "m.csv"));
  expect_message(input_error([&] { (void)load_trajectory_file(file, kNames); }),
                 {"m.csv:1", "'stroke' and 'process' are those of a job's rows"});
  for (const auto& [text, needle] :
       {std::pair(std::string("{\"events\": {}, \"joint_names\": []}"), "events: is no list"),
        std::pair(std::string("{\"events\": 3}"), "events: is '3'"),
        std::pair(std::string("{\"events\": [], \"events\": []}"), "is there twice")})
    expect_message(
        input_error([&] { (void)load_trajectory_file(folder.write("m.json", text), kNames); }),
        {"m.json", needle});
}

TEST(JobMotion, StrokesBetweenTwoSamplesHaveNoRows) {
  Random random(7);
  const Problem job = two_strokes(true);
  ArmMotion motion = random_motion(random, job, true, false);
  motion.events[1].t = motion.events[0].t;
  for (const char* const name : {"m.csv", "m.json", "m.mcap"})
    expect_message(input_error([&] { (void)text_of(motion, job, name); }),
                   {"job.yaml", "stroke 'right' begins and ends between two samples"});
}

/// Fields of rows, to be changed.
using Rows = std::vector<std::vector<std::string>>;

Rows rows_of(const std::string& text) {
  Rows rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string>& row = rows.emplace_back();
    std::istringstream fields(line + ",");
    for (std::string field; std::getline(fields, field, ',');) row.push_back(field);
  }
  return rows;
}

std::string text_of(const Rows& rows) {
  std::string text;
  for (const auto& row : rows) {
    for (std::size_t k = 0; k < row.size(); ++k) text += (k == 0 ? "" : ",") + row[k];
    text += '\n';
  }
  return text;
}

struct BadFile {
  const char* name;
  std::function<void(Rows&)> change;
  std::vector<std::string> needles;
};

/// Applies each change to a motion's file, whose rows are 1 to 3 of a transition (the third at the
/// stroke's begin), 4 to 7 of "right", 8 to 10 of a transition, 11 to 14 of "left", 15 to 17 of a
/// transition; without a home it begins with row 4. Expects each to be refused.
void expect_refused(bool home, const std::vector<BadFile>& files) {
  const TempFolder folder;
  const Problem job = two_strokes(home);
  const std::string place = "0.0,0.5,3", none = ",,";
  std::string text =
      "t,s,phi,branch,a,b,c,d,e,f,g,a_v,b_v,c_v,d_v,e_v,f_v,g_v,a_a,b_a,c_a,d_a,e_a,f_a,g_a,"
      "stroke,process\n";
  int row = 0;
  const auto add = [&](const std::string& stroke, bool placed, bool process) {
    text += std::to_string(row++) + "," + (placed ? place : none);
    for (int k = 0; k < 21; ++k) text += ",0.25";
    text += "," + stroke + (process ? ",1\n" : ",0\n");
  };
  for (const char* const stroke : {"right", "left"}) {
    if (home || row > 0) {
      add("", false, false);
      add("", false, false);
      add("", true, false);
    }
    for (const bool on : {true, true, false, false}) add(stroke, true, on);
  }
  for (int k = 0; home && k < 3; ++k) add("", false, false);
  (void)load_motion(folder.write("m.csv", text), job);
  for (const auto& [name, change, needles] : files) {
    SCOPED_TRACE(name);
    Rows rows = rows_of(text);
    change(rows);
    const fs::path file = folder.write("m.csv", text_of(rows));
    expect_message(input_error([&] { (void)load_answer(file, job, {kNames}); }), needles);
  }
}

constexpr std::size_t kStroke = 25, kProcess = 26;

TEST(JobMotion, BadFields) {
  const auto put = [](std::size_t row, std::size_t column, const char* text) {
    return [=](Rows& rows) { rows[row][column] = text; };
  };
  expect_refused(
      true,
      {
          {"another column", put(0, 4, "x"), {"m.csv:1", "column 'x' is unknown"}},
          {"no times", put(0, 0, "phi"), {"m.csv:1", "column 'phi' is there twice"}},
          {"times go back", put(5, 0, "3"), {"data row 5", "t: is 3", "ascend"}},
          {"no time", put(5, 0, ""), {"data row 5", "t: '' is not a number"}},
          {"no speed", put(5, 12, ""), {"data row 5", "b_v: '' is not a number"}},
          {"infinite", put(5, 5, "inf"), {"data row 5", "b: 'inf' is not a number"}},
          {"no s on a stroke", put(5, 1, ""), {"data row 5", "s: '' is not a number"}},
          {"branch", put(5, 3, "8"), {"data row 5", "branch: is 8"}},
          {"process in words", put(5, kProcess, "on"), {"data row 5", "process: is 'on'"}},
          {"a part of a place", put(2, 1, "0"), {"data row 2", "phi: '' is not a number"}},
          {"no place where a stroke begins",
           [](Rows& rows) { rows[3][1] = rows[3][2] = rows[3][3] = ""; },
           {"data row 3", "s: is empty where a stroke begins"}},
          {"a place in a transition",
           [](Rows& rows) { rows[2][1] = rows[2][2] = rows[2][3] = "0"; },
           {"data row 2", "s: is given in a transition"}},
          {"process in a transition", put(2, kProcess, "1"), {"data row 2", "in a transition"}},
          {"process behind a stroke", put(7, kProcess, "1"), {"data row 7", "1 again"}},
          {"process to the end",
           [](Rows& rows) { rows[6][kProcess] = rows[7][kProcess] = "1"; },
           {"data row 7", "1 in the last row of stroke 'right'"}},
          {"no process",
           [](Rows& rows) { rows[4][kProcess] = rows[5][kProcess] = "0"; },
           {"data row 7", "1 in no row of stroke 'right'"}},
      });
}

TEST(JobMotion, BadParts) {
  const auto without = [](std::size_t first, std::size_t end) {
    return [=](Rows& rows) {
      rows.erase(rows.begin() + static_cast<long>(first), rows.begin() + static_cast<long>(end));
      for (std::size_t k = 1; k < rows.size(); ++k) rows[k][0] = std::to_string(k - 1);
    };
  };
  const auto rename = [](std::size_t first, std::size_t end, const char* name) {
    return [=](Rows& rows) {
      for (std::size_t k = first; k < end; ++k) rows[k][kStroke] = name;
    };
  };
  expect_refused(
      true,
      {
          {"unknown stroke", rename(4, 8, "rihgt"), {"data row 4", "'rihgt' is no stroke of the"}},
          {"twice", rename(11, 15, "right"), {"data row 11", "'right' comes twice"}},
          {"no way from home", without(1, 4), {"data row 1", "is 'right' in the first row"}},
          {"no way home", without(15, 18), {"m.csv: ends with stroke 'left'"}},
          {"no way between", without(8, 11), {"data row 8", "'left' follows 'right' at once"}},
          {"no strokes", rename(4, 15, ""), {"m.csv: has no row of a stroke"}},
      });
  expect_refused(
      false, {
                 {"a way from home", rename(1, 3, ""), {"data row 1", "the job has no home"}},
                 {"a way home",
                  [](Rows& rows) {
                    rows.back()[kStroke] = rows.back()[1] = rows.back()[2] = rows.back()[3] = "";
                  },
                  {"m.csv: ends with a transition"}},
             });
}

}  // namespace
}  // namespace swivel::io::test
