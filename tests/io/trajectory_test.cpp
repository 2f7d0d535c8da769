// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <functional>
#include <random>
#include <sstream>

#include "io_support.hpp"
#include "seed.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io::test {
namespace {

const std::array<std::string, kDof> kNames{"a", "b", "c", "d", "e", "f", "g"};

PlanResult random_result(int rows) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-4, 4);
  PlanResult result;
  result.joint_names = kNames;
  for (int k = 0; k < rows; ++k) {
    TrajectoryRow row;
    row.s = uniform(random) * 1e-9;
    row.phi = uniform(random);
    row.branch = k % 8;
    for (double& angle : row.q.coordinates()) angle = uniform(random);
    result.trajectory.push_back(row);
  }
  result.trajectory[0].q = {0.1, -0.0, 1e-300, 5e-324, 1e300, kPi, 1.0 / 3};
  return result;
}

TEST(Trajectory, MotionKeepsEveryBitAndTheHeaderTellsWhatAFileIs) {
  const TempFolder folder;
  const PlanResult result = random_result(40);
  TimedPath motion;
  for (std::size_t k = 0; k < result.trajectory.size(); ++k) {
    TimedRow row;
    row.t = static_cast<double>(k) / 30;
    row.row = result.trajectory[k];
    row.v = row.row.q * 1.1;
    row.a = row.row.q * 1.3;
    motion.rows.push_back(row);
  }
  const std::string text = to_timed_csv(motion, kNames);
  EXPECT_TRUE(text.starts_with(
      "t,s,phi,branch,a,b,c,d,e,f,g,a_v,b_v,c_v,d_v,e_v,f_v,g_v,a_a,b_a,c_a,d_a,e_a,f_a,g_a\n"));
  const TrajectoryFile file = load_trajectory_file(folder.write("m.csv", text), kNames);
  ASSERT_EQ(file.timed.size(), motion.rows.size());
  ASSERT_EQ(file.rows.size(), motion.rows.size());
  for (std::size_t k = 0; k < file.timed.size(); ++k) {
    EXPECT_EQ(file.timed[k].t, motion.rows[k].t);
    EXPECT_EQ(file.timed[k].v, motion.rows[k].v);
    EXPECT_EQ(file.timed[k].a, motion.rows[k].a);
    EXPECT_EQ(file.rows[k].q, motion.rows[k].row.q);
    EXPECT_EQ(file.timed[k].row.s, motion.rows[k].row.s);
  }
  const TrajectoryFile plain = load_trajectory_file(folder.write("t.csv", to_csv(result)), kNames);
  EXPECT_TRUE(plain.timed.empty());
  EXPECT_EQ(plain.rows.size(), result.trajectory.size());
}

TEST(Trajectory, RoundTripKeepsEveryBit) {
  const TempFolder folder;
  const fs::path file = folder.path() / "t.csv";
  const PlanResult result = random_result(40);
  write_trajectory(file, result);
  EXPECT_TRUE(TempFolder::read(file).starts_with("s,phi,branch,a,b,c,d,e,f,g\n"));
  const auto rows = load_trajectory_file(file, kNames).rows;
  ASSERT_EQ(rows.size(), result.trajectory.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(rows[k].s, result.trajectory[k].s);
    EXPECT_EQ(rows[k].phi, result.trajectory[k].phi);
    EXPECT_EQ(rows[k].branch, result.trajectory[k].branch);
    EXPECT_EQ(rows[k].q, result.trajectory[k].q);
  }
}

TEST(Trajectory, SeventeenDigits) {
  const TempFolder folder;
  PlanResult result = random_result(2);
  result.trajectory[1].s = 0.1;
  write_trajectory(folder.path() / "t.csv", result);
  EXPECT_NE(TempFolder::read(folder.path() / "t.csv").find("\n0.10000000000000001,"),
            std::string::npos);
}

TEST(Trajectory, BadFiles) {
  const TempFolder folder;
  const std::string header = "s,phi,branch,a,b,c,d,e,f,g\n", good = "0,0,0,0,0,0,0,0,0,0\n";
  const struct {
    const char* name;
    std::string text;
    std::vector<std::string> needles;
  } cases[] = {
      {"other joints",
       "s,phi,branch,a,b,c,d,e,f,x\n" + good + good,
       {"t.csv:1", "'x'", "no joint of the arm", "a, b, c, d, e, f, g"}},
      {"a joint is missing",
       "s,phi,branch,a,b,c,d,e,f\n0,0,0,0,0,0,0,0,0\n",
       {"t.csv:1", "'g' is missing"}},
      {"a joint twice", "a,b,c,d,e,f,g,c\n" + good, {"t.csv:1", "'c' is there twice"}},
      {"speeds of some joints", "t,a,b,c,d,e,f,g,a_v\n" + good, {"t.csv:1", "'b_v' is missing"}},
      {"speeds without times",
       "a,b,c,d,e,f,g,a_v,b_v,c_v,d_v,e_v,f_v,g_v\n" + good,
       {"t.csv:1", "'t' is missing"}},
      {"times that stand still",
       "t,a,b,c,d,e,f,g\n0,0,0,0,0,0,0,0\n0,0,0,0,0,0,0,0\n",
       {"t.csv:3", "data row 2", ": t", "ascend"}},
      {"infinite",
       "a,b,c,d,e,f,g\n0,0,0,0,0,0,0\n0,0,0,0,0,0,inf\n",
       {"t.csv:3", "data row 2", ": g"}},
      {"no header", "0,0,0,0,0,0,0\n0,0,0,0,0,0,1\n", {"t.csv:1", "'0'"}},
      {"one row", header + good, {"1 data row"}},
      {"NaN", header + good + "0,0,0,0,0,nan,0,0,0,0\n", {"t.csv:3", "data row 2", ": c"}},
      {"columns", header + good + "0,0,0\n", {"t.csv:3", "data row 2", "3 columns"}},
      {"branch 8", header + good + "0,0,8,0,0,0,0,0,0,0\n", {"data row 2", "branch", "0 to 7"}},
      {"branch -1", header + good + "0,0,-1,0,0,0,0,0,0,0\n", {"data row 2", "branch"}},
      {"branch 1.5", header + good + "0,0,1.5,0,0,0,0,0,0,0\n", {"data row 2", "branch"}},
  };
  for (const auto& [name, text, needles] : cases) {
    SCOPED_TRACE(name);
    const fs::path file = folder.write("t.csv", text);
    expect_message(input_error([&] { (void)load_trajectory_file(file, kNames); }), needles);
  }
}

/// A motion at even steps of time, its joints anywhere.
TimedPath random_motion(swivel::test::Random& random, double rate, bool roll = false) {
  TimedPath motion;
  motion.rate = rate;
  motion.roll = roll;
  const int rows = 2 + random.below(40);
  for (int k = 0; k < rows; ++k) {
    TimedRow row;
    row.t = k / rate;
    for (Config* values : {&row.row.q, &row.v, &row.a})
      for (double& value : values->coordinates())
        value = random.uniform(-4, 4) * std::pow(10, random.below(20) - 15);
    motion.rows.push_back(row);
  }
  return motion;
}

/// The joints of a CSV by name in another order, with or without speeds and accelerations.
std::string shuffled_csv(const TimedPath& motion, const JointNames& names,
                         swivel::test::Random& random, const Stated& stated, bool timed) {
  struct Column {
    std::string name;
    std::function<double(const TimedRow&)> value;
  };
  std::vector<Column> columns;
  if (timed) columns.push_back({"t", [](const TimedRow& row) { return row.t; }});
  if (stated.s) columns.push_back({"s", [](const TimedRow& row) { return row.row.s; }});
  if (stated.phi) columns.push_back({"phi", [](const TimedRow& row) { return row.row.phi; }});
  if (stated.branch)
    columns.push_back({"branch", [](const TimedRow& row) { return row.row.branch; }});
  for (Eigen::Index j = 0; j < kDof; ++j) {
    const std::string& name = names[static_cast<std::size_t>(j)];
    columns.push_back({name, [j](const TimedRow& row) { return row.row.q[j]; }});
    if (stated.v) columns.push_back({name + "_v", [j](const TimedRow& row) { return row.v[j]; }});
    if (stated.a) columns.push_back({name + "_a", [j](const TimedRow& row) { return row.a[j]; }});
  }
  for (std::size_t k = columns.size(); k > 1; --k)
    std::swap(columns[k - 1], columns[static_cast<std::size_t>(random.below(static_cast<int>(k)))]);
  std::ostringstream text;
  text.precision(17);
  for (const Column& column : columns)
    text << (&column == columns.data() ? "" : ",") << column.name;
  for (const TimedRow& row : motion.rows) {
    text << '\n';
    for (const Column& column : columns)
      text << (&column == columns.data() ? "" : ",") << column.value(row);
  }
  return text.str() + '\n';
}

/// A motion as a file of one format, and what the file states.
struct MotionFile {
  const char* name;
  std::string text;
  Stated stated;
  bool timed = true;
};

/// Returns a motion in every format, and as a CSV with columns drawn at random.
std::vector<MotionFile> motion_files(const TimedPath& motion, const JointNames& names,
                                     swivel::test::Random& random) {
  const bool has_v = random.coin(), has_a = random.coin(), placed = random.coin(),
             timed = random.coin();
  const Stated some{placed, placed, placed, placed, true, timed && has_v, timed && has_a},
      in_message{false, false, false, false, !motion.roll, true, true},
      in_log{false, false, false, false, !motion.roll, true, false};
  return {
      {"m.csv", to_timed_csv(motion, names), {}},
      {"shuffled.csv", shuffled_csv(motion, names, random, some, timed), some, timed},
      {"m.json", to_trajectory_json(motion, names, "base \"1\""), in_message},
      {"m.yaml", to_trajectory_yaml(motion, names, "base"), in_message},
      {"no_ending", to_trajectory_yaml(motion, names, "base") + "---\n", in_message},
      {"m.mcap", to_mcap(motion, names, "base"), in_log},
  };
}

/// Expects what was read of the file to be the motion: bits of what the file states, times of
/// messages to the nanosecond.
void expect_motion(const MotionFile& file, const TimedPath& motion, const TrajectoryFile& read) {
  ASSERT_EQ(read.rows.size(), motion.rows.size());
  ASSERT_EQ(read.timed.size(), file.timed ? motion.rows.size() : 0);
  EXPECT_EQ(read.stated.s, file.stated.s);
  EXPECT_EQ(read.stated.phi, file.stated.phi);
  EXPECT_EQ(read.stated.branch, file.stated.branch);
  EXPECT_EQ(read.stated.roll, file.stated.roll);
  EXPECT_EQ(read.stated.last_joint, file.stated.last_joint);
  EXPECT_EQ(read.stated.v, file.stated.v);
  EXPECT_EQ(read.stated.a, file.stated.a);
  const Eigen::Index joints = file.stated.last_joint ? kDof : kDof - 1;
  const double time_error = std::string(file.name).ends_with(".csv") ? 0 : 0.5001e-9;
  for (std::size_t k = 0; k < read.rows.size(); ++k) {
    const TimedRow& row = motion.rows[k];
    EXPECT_EQ(read.rows[k].q.head(joints), row.row.q.head(joints));
    if (!file.timed) continue;
    EXPECT_NEAR(read.timed[k].t, row.t, time_error);
    EXPECT_EQ(read.timed[k].row.q.head(joints), row.row.q.head(joints));
    EXPECT_EQ(read.timed[k].v.head(joints),
              Config(file.stated.v ? row.v : Config::Zero()).head(joints));
    EXPECT_EQ(read.timed[k].a.head(joints),
              Config(file.stated.a ? row.a : Config::Zero()).head(joints));
  }
}

/// Every format keeps every bit of what it holds, messages times to the nanosecond, and says what
/// it does not hold.
TEST(TrajectoryFiles, RandomMotionsAreReadAsTheyWereWritten) {
  using swivel::test::Random;
  const TempFolder folder;
  const std::uint64_t base = swivel::test::seed("TrajectoryFiles");
  const double rates[] = {3, 20, 50, 125, 240, 250, 999, 1000};
  int count = 0, without_roll = 0;
  for (int trial = 0; trial < swivel::test::trials(150); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    JointNames names = kNames;
    const bool roll = random.coin(0.3);
    if (roll) names.back() = "roll";
    const TimedPath motion = random_motion(random, rates[random.below(8)], roll);
    for (const MotionFile& file : motion_files(motion, names, random)) {
      SCOPED_TRACE(std::string(file.name) + ", trial " + std::to_string(trial));
      expect_motion(file, motion, load_trajectory_file(folder.write(file.name, file.text), names));
      if (HasFatalFailure()) return;
      ++count;
      without_roll += !file.stated.last_joint;
    }
  }
  std::printf("%d files, %d without the roll\n", count, without_roll);
  EXPECT_GE(count, swivel::test::at_least(900));
  EXPECT_GE(without_roll, swivel::test::at_least(100));
}

/// A bad message of another program, and what is said about it.
struct BadMessage {
  const char* name;
  std::string text;
  std::vector<std::string> needles;
};

/// Expects each of the messages to be refused in one line that has its needles.
void expect_refused(const std::vector<BadMessage>& messages) {
  const TempFolder folder;
  for (const auto& [name, text, needles] : messages) {
    SCOPED_TRACE(name);
    const fs::path file = folder.write("t", text);
    expect_message(input_error([&] { (void)load_trajectory_file(file, kNames); }), needles);
  }
}

/// Pieces of messages in YAML: the names of the joints, two points and what they are made of.
const std::string
    kJointNames = "joint_names: [a, b, c, d, e, f, g]\n",
    kTime = "time_from_start: {sec: 0, nanosec: 0}", kZeros = "[0, 0, 0, 0, 0, 0, 0]",
    kFirst = "- {positions: " + kZeros + ", " + kTime + "}\n",
    kSecond = "- {positions: [1, 1, 1, 1, 1, 1, 1], time_from_start: {sec: 1, nanosec: 5}}\n",
    kPoints = "points:\n";

TEST(TrajectoryFiles, AMessageMayHaveNotesAndItsNamesLast) {
  const TempFolder folder;
  const TrajectoryFile good = load_trajectory_file(
      folder.write("t", "# a note\n---\n" + kPoints + kFirst + kSecond + kJointNames), kNames);
  ASSERT_EQ(good.timed.size(), 2u);
  EXPECT_EQ(good.timed[1].t, 1.000000005);
  EXPECT_FALSE(good.stated.v || good.stated.a || good.stated.s);
}

/// Messages of other programs: one line with place, key and what is allowed.
TEST(TrajectoryFiles, MessagesAreReadStrictly) {
  expect_refused({
      {"another joint",
       "joint_names: [a, b, c, d, e, f, g, finger]\n" + kPoints + kFirst,
       {"t:1", "joint_names", "7 names"}},
      {"a joint of another arm",
       "joint_names: [a, b, c, d, e, f, x]\n" + kPoints + kFirst + kSecond,
       {"t: joint_names", "'x'"}},
      {"a joint is missing",
       "joint_names: [a, b, c, d, e, f]\n" + kPoints + kFirst + kSecond,
       {"'g' is missing"}},
      {"a joint twice",
       "joint_names: [a, b, c, d, e, f, f]\n" + kPoints + kFirst + kSecond,
       {"'f' is there twice"}},
      {"one point", kJointNames + kPoints + kFirst, {"1 row"}},
      {"no points", kJointNames, {"t:1", "points: is missing"}},
      {"unknown key",
       kJointNames + kPoints + kFirst + kSecond + "extra: 1\n",
       {"t:5", "'extra' is unknown"}},
      {"unknown key of a point",
       kJointNames + kPoints + "- {position: " + kZeros + "}\n",
       {"t:3", "points[0]", "'position' is unknown"}},
      {"key twice",
       kJointNames + kJointNames + kPoints + kFirst + kSecond,
       {"t:2", "'joint_names' is there twice"}},
      {"no time",
       kJointNames + kPoints + "- {positions: " + kZeros + "}\n",
       {"points[0]", "time_from_start: is missing"}},
      {"too few numbers",
       kJointNames + kPoints + kFirst +
           "- {positions: [1, 2], time_from_start: {sec: 1, nanosec: 0}}\n",
       {"t:4", "points[1]", "positions", "2 numbers"}},
      {"NaN",
       kJointNames + kPoints + kFirst +
           "- {positions: [0, 0, 0, 0, 0, 0, .nan], time_from_start: {sec: 1, nanosec: 0}}\n",
       {"t:4", "points[1]", "positions", "'.nan'"}},
      {"times go back", kJointNames + kPoints + kSecond + kFirst, {"t:4", "points[1]", "ascend"}},
      {"speeds of one point",
       kJointNames + kPoints + "- {positions: " + kZeros + ", velocities: " + kZeros + ", " +
           kTime + "}\n" + kSecond,
       {"t:4", "points[1]", "velocities", "in some rows only"}},
      {"nanoseconds",
       kJointNames + kPoints + kFirst + "- {positions: " + kZeros +
           ", time_from_start: {sec: 1, nanosec: 1000000000}}\n",
       {"t:4", "points[1]", "time_from_start.nanosec", "'1000000000'"}},
      {"fraction of a second",
       kJointNames + kPoints + "- {positions: " + kZeros +
           ", time_from_start: {sec: 0.5, nanosec: 0}}\n",
       {"points[0]", "time_from_start.sec", "'0.5'"}},
      {"seconds in quotes",
       kJointNames + kPoints + "- {positions: " + kZeros +
           ", time_from_start: {sec: \"1\", nanosec: 0}}\n",
       {"t:3", "points[0]", "time_from_start.sec", "the text \"1\"", "a whole number"}},
      {"a position in quotes",
       kJointNames + kPoints + kFirst +
           "- {positions: [0, 0, '0', 0, 0, 0, 0], time_from_start: {sec: 1, nanosec: 0}}\n",
       {"t:4", "points[1]", "positions", "the text \"0\"", "a finite number"}},
      {"empty", "", {"is empty"}},
  });
}

TEST(TrajectoryFiles, YamlOfMessagesIsReadStrictly) {
  expect_refused({
      {"alias",
       kJointNames + kPoints + "- &p {positions: " + kZeros + ", " + kTime + "}\n- *p\n",
       {"t:4", "alias"}},
      {"two messages",
       kJointNames + kPoints + kFirst + kSecond + "---\n" + kJointNames + kPoints + kFirst +
           kSecond,
       {"more than one message"}},
      {"a list", "- joint_names: [a]\n", {"'- joint_names: [a]'"}},
      {"broken YAML", kJointNames + "points: [\n", {"not YAML"}},
  });
}

TEST(TrajectoryFiles, JsonOfMessagesIsReadStrictly) {
  expect_refused({
      {"JSON: seconds in quotes",
       R"({"points": [{"positions": [0, 0, 0, 0, 0, 0, 0],
                       "time_from_start": {"sec": "1", "nanosec": 0}}]})",
       {"t: points[0]: time_from_start.sec", "the text \"1\"", "a whole number"}},
      {"JSON: nanoseconds in quotes",
       R"({"points": [{"positions": [0, 0, 0, 0, 0, 0, 0],
                       "time_from_start": {"sec": 1, "nanosec": "0"}}]})",
       {"points[0]: time_from_start.nanosec", "the text \"0\"", "a whole number"}},
      {"JSON: a position in quotes",
       R"({"points": [{"positions": [0, 0, 0, "0", 0, 0, 0]}]})",
       {"points[0]: positions", "the text \"0\"", "a finite number"}},
      {"JSON: effort in quotes",
       R"({"points": [{"effort": ["1"]}]})",
       {"points[0]: effort", "the text \"1\""}},
      {"JSON: true for a position",
       R"({"points": [{"positions": [true]}]})",
       {"points[0]: positions", "'true'"}},
      {"JSON: a number for a name",
       R"({"joint_names": ["a", 2]})",
       {"joint_names", "is 2", "the name of a joint"}},
      {"JSON list", "[1]", {"t:", "is no map"}},
      {"broken JSON", "{\"joint_names\": [\"a\"", {"t:", "JSON"}},
      {"JSON with another key", "{\"schema_version\": 1}", {"'schema_version' is unknown"}},
  });
}

TEST(TrajectoryFiles, LogsAreReadStrictly) {
  const TempFolder folder;
  swivel::test::Random random(3);
  const TimedPath motion = random_motion(random, 100);
  const std::string good = to_mcap(motion, kNames, "base");
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  // The chunk's check sum and the name of its compression stand before the size of its records;
  // both are empty.
  const std::size_t records = good.find("sensor_msgs/msg/JointState") - 4 - 2 - 9,
                    crc = records - 8 - 4 - 4;
  std::string summed = good, packed = good;
  summed[crc] = 1;
  packed.replace(crc + 4, 4, std::string("\4\0\0\0zstd", 8));
  JointNames renamed = kNames;
  renamed[2] = "x";
  JointNames doubled = kNames;
  doubled[2] = "a";
  const struct {
    const char* name;
    std::string text;
    std::vector<std::string> needles;
  } cases[] = {
      {"cut off", good.substr(0, good.size() / 2), {"cut off"}},
      {"mark alone", good.substr(0, 8), {"cut off"}},
      {"another version", changed("MCAP0", "MCAP1"), {"version 0"}},
      {"another message",
       changed("sensor_msgs/msg/JointState", "sensor_msgs/msg/JointStatf"),
       {"no joint states"}},
      {"another encoding", changed("cdr", "xml"), {"/joint_states", "CDR"}},
      {"big-endian",
       changed(std::string("\0\1\0\0", 4), std::string("\0\0\0\0", 4)),
       {"little-endian"}},
      {"check sum", summed, {"check sum"}},
      {"compressed", packed, {"compressed by zstd"}},
      {"another joint", to_mcap(motion, renamed, "base"), {"message 0 of '/joint_states'", "'x'"}},
      {"a joint twice", to_mcap(motion, doubled, "base"), {"'a' is there twice"}},
  };
  for (const auto& [name, text, needles] : cases) {
    SCOPED_TRACE(name);
    const fs::path file = folder.write("m.mcap", text);
    expect_message(input_error([&] { (void)load_trajectory_file(file, kNames); }), needles);
  }
}

/// The rolls of two arms of six joints have columns of their own; files that name both alike, as
/// earlier versions wrote them, are read as well.
TEST(Trajectory, RollsOfTwoArmsAreNamedByArm) {
  const TempFolder folder;
  const std::array<std::string, 2> names{"left", "right"};
  const std::array<JointNames, 2> joints{
      {{"a", "b", "c", "d", "e", "f", "roll"}, {"g", "h", "i", "j", "k", "l", "roll"}}};
  Answer result;
  Motion motion;
  result.arms.clear();
  for (std::size_t k = 0; k < 2; ++k) {
    motion.arms.emplace_back().name = names[k];
    result.arms.push_back(answer_of(random_result(3)).arm());
    result.arms[k].name = names[k];
    result.arms[k].joint_names = joints[k];
    for (std::size_t i = 0; i < 3; ++i) {
      TimedRow& row = motion.arms[k].rows.emplace_back();
      row.t = static_cast<double>(i) / 250;
      row.row = result.arms[k].rows()[i];
    }
  }
  const std::string rows = to_csv(result, two_arms()),
                    timed = text_of_motion(motion, two_arms(), {joints[0], joints[1]}, "t.csv");
  EXPECT_TRUE(rows.starts_with(
      "s_left,s_right,phi_left,phi_right,branch_left,branch_right,a,b,c,d,e,f,roll_left,g,h,i,j,k,"
      "l,roll_right\n"));
  EXPECT_NE(timed.find(",f_v,roll_left_v,g_v,"), std::string::npos);
  Problem cell = two_arms();
  for (std::size_t k = 0; k < 2; ++k) cell.arms[k].name = names[k];
  for (const std::string& text : {rows, timed}) {
    std::string before = text;
    for (const std::string& name : names)
      for (std::size_t at = before.find("roll_" + name); at != std::string::npos;
           at = before.find("roll_" + name))
        before.erase(at + 4, name.size() + 1);
    ASSERT_NE(before, text);
    for (const std::string& one : {text, before}) {
      const GivenAnswer read =
          load_answer(folder.write("t.csv", one), cell, {joints[0], joints[1]});
      EXPECT_EQ(read.has_times(), text == timed);
      for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t i = 0; i < 3; ++i) {
          const GivenArm& arm = read.arms[k];
          const Config& q =
              arm.motion ? arm.motion->rows.at(i).row.q : arm.parts.front().rows.at(i).q;
          EXPECT_EQ(q, result.arms[k].rows()[i].q);
        }
    }
  }
}

}  // namespace
}  // namespace swivel::io::test
