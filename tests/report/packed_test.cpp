// SPDX-License-Identifier: BSD-3-Clause
// What pages hold packed, against plain decoders.
#include "page/packed.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <map>
#include <optional>

#include "page_data.hpp"
#include "seed.hpp"

namespace swivel::detail {
namespace {

using namespace test;

/// Returns the numbers that varints with signs stand for.
std::vector<std::int64_t> signed_varints(const Bytes& bytes) {
  std::vector<std::int64_t> values;
  std::uint64_t value = 0;
  unsigned shift = 0;
  for (const unsigned char byte : bytes) {
    value |= static_cast<std::uint64_t>(byte & 127) << shift;
    shift += 7;
    if (byte & 128) continue;
    values.push_back(static_cast<std::int64_t>(value >> 1) ^ -static_cast<std::int64_t>(value & 1));
    value = shift = 0;
  }
  return values;
}

/// Returns a number that is small, any, or one of the ends of its kind.
template <class T>
T random_number(Random& random) {
  using Limits = std::numeric_limits<T>;
  const int kind = random.below(4);
  return kind == 0   ? static_cast<T>(random.below(200) - 100)
         : kind == 1 ? static_cast<T>(random.uniform(Limits::min(), Limits::max()))
         : kind == 2 ? Limits::min()
                     : Limits::max();
}

TEST(Packed, SamplesComeBack) {
  Random random(seed("Packed.SamplesComeBack"));
  int jumps = 0, empty = 0;
  const int kTrials = trials(400);
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto width = static_cast<std::size_t>(1 + random.below(7)),
               count = static_cast<std::size_t>(random.below(60));
    std::vector<std::int32_t> values(width * count);
    for (std::int32_t& value : values) value = random_number<std::int32_t>(random);
    const std::vector<std::int64_t> bends = signed_varints(encode_samples(values, width));
    ASSERT_EQ(bends.size(), values.size());
    for (std::size_t k = 0; k < width; ++k)
      for (std::size_t n = 0; n < count; ++n) {
        const auto at = [&](std::size_t back) -> std::int64_t {
          return n < back ? 0 : values[(n - back) * width + k];
        };
        ASSERT_EQ(bends[k * count + n], at(0) - 2 * at(1) + at(2));
        jumps += std::abs(bends[k * count + n]) > std::numeric_limits<std::int32_t>::max();
      }
    empty += count == 0;
  }
  EXPECT_GE(jumps, at_least(10000));
  EXPECT_GE(empty, at_least_among(2));
}

/// A map's cells by column, panel and row: the pose that each shows, or none.
using Map = std::map<std::array<int, 3>, int>;

/// Returns cells of which some have poses, some that of the cell below.
Map random_map(Random& random, PosedCells& cells, int& poses) {
  const int columns = random.below(6), panels = 1 + random.below(3), rows = 1 + random.below(8);
  const double share = random.uniform(0, 1.2);
  cells = {static_cast<std::size_t>(rows), static_cast<std::size_t>(rows * panels), {}};
  Map map;
  poses = 0;
  for (int column = 0; column < columns; ++column)
    for (int panel = 0; panel < panels; ++panel)
      for (int row = 0; row < rows; ++row) {
        const bool again = row > 0 && cells.pose.back() >= 0 && random.coin(0.2);
        cells.pose.push_back(again ? poses - 1 : random.coin(share) ? poses++ : -1);
        if (cells.pose.back() >= 0) map[{column, panel, row}] = cells.pose.back();
      }
  return map;
}

TEST(Packed, PosesComeBack) {
  Random random(seed("Packed.PosesComeBack"));
  int by_bend = 0, by_slope = 0, others = 0;
  const int kTrials = trials(400);
  for (int trial = 0; trial < kTrials; ++trial) {
    PosedCells cells;
    int poses = 0;
    const Map map = random_map(random, cells, poses);
    const auto width = static_cast<std::size_t>(1 + random.below(7));
    std::vector<std::int16_t> values(width * static_cast<std::size_t>(poses)), back = values;
    for (std::int16_t& value : values) value = random_number<std::int16_t>(random);
    const std::vector<std::int64_t> added = signed_varints(encode_poses(values, width, cells));
    ASSERT_EQ(added.size(), values.size());
    std::size_t next = 0;
    for (std::size_t k = 0; k < width; ++k) {
      const auto at = [&](int pose) -> std::int64_t {
        return back[static_cast<std::size_t>(pose) * width + k];
      };
      int decoded = 0;
      for (const auto& [cell, pose] : map) {
        if (pose != decoded) continue;  // again
        const auto beside = [&](int left, int below) -> std::optional<std::int64_t> {
          const auto found = map.find({cell[0] - left, cell[1], cell[2] - below});
          return found == map.end() ? std::nullopt : std::optional(at(found->second));
        };
        const auto a = beside(0, 1), aa = beside(0, 2), l = beside(1, 0), la = beside(1, 1),
                   laa = beside(1, 2);
        std::int64_t told = decoded > 0 ? at(decoded - 1) : 0;
        if (a && aa && l && la && laa)
          told = 2 * *a - *aa + *l - 2 * *la + *laa, ++by_bend;
        else if (a && l && la)
          told = *a + *l - *la, ++by_slope;
        else if (a && aa)
          told = 2 * *a - *aa, ++others;
        else if (l || a)
          told = l ? *l : *a, ++others;
        back[static_cast<std::size_t>(decoded) * width + k] =
            static_cast<std::int16_t>(told + added[next++]);
        ++decoded;
      }
      ASSERT_EQ(decoded, poses);
    }
    ASSERT_EQ(back, values) << "trial " << trial;
  }
  EXPECT_GE(by_bend, at_least(2500));
  EXPECT_GE(by_slope, at_least(1000));
  EXPECT_GE(others, at_least(1000));
}

TEST(Packed, TextsComeBack) {
  Random random(seed("Packed.TextsComeBack"));
  const int kTrials = trials(200);
  for (int trial = 0; trial < kTrials; ++trial) {
    const int kinds = 1 + random.below(256);
    std::string text(static_cast<std::size_t>(random.below(3) * random.below(20000)), ' ');
    for (char& c : text) c = static_cast<char>(random.below(kinds));
    const std::string packed = compressed(text);
    ASSERT_EQ(inflated(packed), text);
    ASSERT_EQ(compressed(text), packed);
  }
}

}  // namespace
}  // namespace swivel::detail
