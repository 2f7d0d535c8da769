// SPDX-License-Identifier: BSD-3-Clause
// The door panel and its polishing path: made again byte for byte, closed, and where the path says
// it is.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using Vec = std::array<float, 3>;
using Triangle = std::array<Vec, 3>;
const std::filesystem::path kData = SWIVEL_DATA_DIR;

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  EXPECT_TRUE(in) << file;
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}

std::vector<Triangle> read_stl(const std::filesystem::path& file) {
  const std::string bytes = read(file);
  std::vector<Triangle> result((bytes.size() - 84) / 50);
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  EXPECT_EQ(count, result.size());
  for (std::size_t k = 0; k < result.size(); ++k)
    std::memcpy(&result[k], bytes.data() + 84 + 50 * k + 12, sizeof(Triangle));
  return result;
}

double triple(const std::array<double, 3>& a, const std::array<double, 3>& b,
              const std::array<double, 3>& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

struct Case {
  const char* arguments;
  const char* file;
  friend std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.file; }
};
class Regenerated : public testing::TestWithParam<Case> {};

TEST_P(Regenerated, GivesTheSameBytes) {
  const auto folder = std::filesystem::path(testing::TempDir()) /
                      ("swivel_door_" + std::filesystem::path(GetParam().file).stem().string());
  std::filesystem::create_directories(folder);
  const auto made = folder / "made";
  const std::string command = std::string("\"") + SWIVEL_MAKE_DOOR + "\" " + GetParam().arguments +
                              " \"" + made.string() + "\"";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  EXPECT_TRUE(read(made) == read(kData / GetParam().file))
      << GetParam().file << " differs from what make_door writes";
  std::filesystem::remove_all(folder);
}
INSTANTIATE_TEST_SUITE_P(Door, Regenerated,
                         testing::Values(Case{"--triangles 2000", "meshes/door_2k.stl"},
                                         Case{"--triangles 20000", "meshes/door_20k.stl"},
                                         Case{"--path", "paths/door_polish.csv"}));

class Panel : public testing::TestWithParam<Case> {};

TEST_P(Panel, IsClosedAndOriented) {
  const std::vector<Triangle> triangles = read_stl(kData / GetParam().file);
  std::map<Vec, int> ids;
  std::map<std::pair<int, int>, int> uses;
  double volume = 0;
  for (const Triangle& t : triangles) {
    std::array<int, 3> v{};
    std::array<std::array<double, 3>, 3> p{};
    for (std::size_t k = 0; k < 3; ++k) {
      v[k] = ids.try_emplace(t[k], static_cast<int>(ids.size())).first->second;
      p[k] = {t[k][0], t[k][1], t[k][2]};
    }
    EXPECT_TRUE(v[0] != v[1] && v[1] != v[2] && v[2] != v[0]);
    for (std::size_t k = 0; k < 3; ++k) ++uses[{v[k], v[(k + 1) % 3]}];
    volume += triple(p[0], p[1], p[2]) / 6;
  }
  for (const auto& [edge, count] : uses) {
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(uses.contains({edge.second, edge.first}));
  }
  EXPECT_EQ(uses.size(), 3 * triangles.size());
  // One body with one hole: V - E + F = 0.
  EXPECT_EQ(static_cast<long>(ids.size()) - static_cast<long>(uses.size() / 2) +
                static_cast<long>(triangles.size()),
            0);
  // About 1.5 m x 1.0 m less window, 40 mm thick; positive when the triangles face outwards.
  EXPECT_GT(volume, 0.035);
  EXPECT_LT(volume, 0.055);
}
INSTANTIATE_TEST_SUITE_P(Door, Panel,
                         testing::Values(Case{"", "meshes/door_2k.stl"},
                                         Case{"", "meshes/door_20k.stl"}));

TEST(PolishingPath, StandsTwelveMillimetresOffTheSurface) {
  const std::vector<Triangle> triangles = read_stl(kData / "meshes/door_20k.stl");
  std::istringstream csv(read(kData / "paths/door_polish.csv"));
  std::string line;
  std::getline(csv, line);
  ASSERT_EQ(line, "x,y,z,qw,qx,qy,qz");
  int rows = 0;
  double length = 0;
  std::array<double, 3> last{};
  while (std::getline(csv, line)) {
    for (char& c : line)
      if (c == ',') c = ' ';
    std::istringstream numbers(line);
    std::array<double, 3> p{};
    double w = 0, x = 0, y = 0, z = 0;
    ASSERT_TRUE(numbers >> p[0] >> p[1] >> p[2] >> w >> x >> y >> z) << line;
    EXPECT_NEAR(w * w + x * x + y * y + z * z, 1, 1e-11);
    const std::array<double, 3> tool_z{2 * (x * z + w * y), 2 * (y * z - w * x),
                                       1 - 2 * (x * x + y * y)};
    double nearest = 1e9;  // first triangle that the tool's z axis meets
    for (const Triangle& t : triangles) {
      const auto from = [&](std::size_t k) {
        return std::array<double, 3>{t[k][0] - p[0], t[k][1] - p[1], t[k][2] - p[2]};
      };
      const auto a = from(0), b = from(1), c = from(2);
      const double u = triple(tool_z, b, c), v = triple(tool_z, c, a), s = triple(tool_z, a, b);
      if (!((u >= 0 && v >= 0 && s >= 0) || (u <= 0 && v <= 0 && s <= 0)) || u + v + s == 0)
        continue;
      const double distance = triple(a, b, c) / (u + v + s);
      if (distance > 0 && distance < nearest) nearest = distance;
    }
    EXPECT_NEAR(nearest, 0.012, 0.0002) << "row " << rows;
    if (rows > 0) length += std::hypot(p[0] - last[0], p[1] - last[1], p[2] - last[2]);
    last = p;
    ++rows;
  }
  EXPECT_EQ(rows, 19);
  EXPECT_GT(length, 0.40);
  EXPECT_LT(length, 0.50);
}

}  // namespace
