// SPDX-License-Identifier: BSD-3-Clause
#include <random>

#include "io_support.hpp"
#include "swivel/io/motion.hpp"

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
    for (double& angle : row.q) angle = uniform(random);
    result.trajectory.push_back(row);
  }
  result.trajectory[0].q << 0.1, -0.0, 1e-300, 5e-324, 1e300, kPi, 1.0 / 3;
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
  EXPECT_TRUE(text.starts_with("t,s,phi,branch,a,b,c,d,e,f,g,a_v,b_v,c_v,d_v,e_v,f_v,g_v,a_a,b_a,c_a,d_a,e_a,f_a,g_a\n"));
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
  EXPECT_THROW(load_trajectory(folder.write("m.csv", text), kNames), InputError);
}

TEST(Trajectory, RoundTripKeepsEveryBit) {
  const TempFolder folder;
  const fs::path file = folder.path() / "t.csv";
  const PlanResult result = random_result(40);
  write_trajectory(file, result);
  EXPECT_TRUE(TempFolder::read(file).starts_with("s,phi,branch,a,b,c,d,e,f,g\n"));
  const auto rows = load_trajectory(file, kNames);
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
  EXPECT_NE(TempFolder::read(folder.path() / "t.csv").find("\n0.10000000000000001,"), std::string::npos);
}

TEST(Trajectory, BadFiles) {
  const TempFolder folder;
  const std::string header = "s,phi,branch,a,b,c,d,e,f,g\n", good = "0,0,0,0,0,0,0,0,0,0\n";
  const struct {
    const char* name;
    std::string text;
    std::vector<std::string> needles;
  } cases[] = {
      {"other joints", "s,phi,branch,a,b,c,d,e,f,x\n" + good + good, {"t.csv:1", "header", "s,phi,branch,a,b,c,d,e,f,g"}},
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
    expect_message(input_error([&] { (void)load_trajectory(file, kNames); }), needles);
  }
}

}  // namespace
}  // namespace swivel::io::test
