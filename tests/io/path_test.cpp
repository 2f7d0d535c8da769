// SPDX-License-Identifier: BSD-3-Clause
#include "io_support.hpp"

namespace swivel::io::test {
namespace {

const std::string kHeader = "x,y,z,qw,qx,qy,qz\n";

TEST(Path, RowsAsWritten) {
  const TempFolder folder;
  const auto path = load_path(folder.write(
      "p.csv",
      "\xef\xbb\xbfx, y, z,qw,qx,qy,qz\r\n1,-2.5,+3e-1,0.9995,0,0,0\r\n\r\n 4 ,5,6,0,0,0,-1\r\n"));
  ASSERT_EQ(path.size(), 2u);
  EXPECT_EQ(path[0].position, Vector3d(1, -2.5, 0.3));
  EXPECT_EQ(path[0].orientation.w(), 0.9995);  // not normalised here
  EXPECT_EQ(path[1].orientation.z(), -1);
}

TEST(Path, NoNewlineAtTheEnd) {
  const TempFolder folder;
  EXPECT_EQ(load_path(folder.write("p.csv", kHeader + "0,0,0,1,0,0,0\n1,0,0,1,0,0,0")).size(), 2u);
}

TEST(Path, BadFiles) {
  const TempFolder folder;
  const std::string good = "0,0,0,1,0,0,0\n";
  const struct {
    const char* name;
    std::string text;
    std::vector<std::string> needles;
  } cases[] = {
      {"empty", "", {"empty"}},
      {"header alone", kHeader, {"0 data row"}},
      {"one row", kHeader + good, {"1 data row"}},
      {"no header", good + good, {"p.csv:1", "header", "x,y,z,qw,qx,qy,qz"}},
      {"wrong header", "x,y,z,qx,qy,qz,q\n" + good + good, {"p.csv:1", "header", "qw"}},
      {"column missing",
       kHeader + good + "0,0,0,1,0,0\n",
       {"p.csv:3", "data row 2", "counted from 1", "6 columns"}},
      {"column too many",
       kHeader + good + "0,0,0,1,0,0,0,\n",
       {"p.csv:3", "data row 2", "8 columns"}},
      {"word", kHeader + "0,abc,0,1,0,0,0\n" + good, {"p.csv:2", "data row 1", "y", "'abc'"}},
      {"empty field", kHeader + "0,,0,1,0,0,0\n" + good, {"p.csv:2", "data row 1", "y"}},
      {"trailing letters", kHeader + "0,1m,0,1,0,0,0\n" + good, {"data row 1", "'1m'"}},
      {"NaN", kHeader + good + "0,0,nan,1,0,0,0\n", {"p.csv:3", "data row 2", "z", "finite"}},
      {"inf", kHeader + good + "inf,0,0,1,0,0,0\n", {"p.csv:3", "data row 2", "x", "finite"}},
      {"overflow", kHeader + good + "1e999,0,0,1,0,0,0\n", {"data row 2", "x"}},
      {"zero quaternion",
       kHeader + good + "\n0,0,0,0,0,0,0\n",
       {"p.csv:4", "data row 2", "quaternion"}},
      {"long quaternion",
       kHeader + good + "0,0,0,1.0011,0,0,0\n",
       {"data row 2", "quaternion", "1e-3"}},
      {"short quaternion", kHeader + good + "0,0,0,0.9989,0,0,0\n", {"data row 2", "quaternion"}},
      {"control characters", kHeader + good + "0,0,\x01\x02,1,0,0,0\n", {"data row 2", "z"}},
  };
  for (const auto& [name, text, needles] : cases) {
    SCOPED_TRACE(name);
    const fs::path file = folder.write("p.csv", text);
    const std::string message = input_error([&] { (void)load_path(file); });
    expect_message(message, needles);
    expect_message(message, {file.string()});
  }
  expect_message(input_error([&] { (void)load_path(folder.path() / "absent.csv"); }),
                 {"absent.csv"});
}

}  // namespace
}  // namespace swivel::io::test
