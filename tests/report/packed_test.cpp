// SPDX-License-Identifier: BSD-3-Clause
// What pages hold packed, against plain decoders.
#include "page/packed.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "page_data.hpp"
#include "seed.hpp"

namespace swivel::detail {
namespace {

using namespace test;

/// Returns the numbers that a text of varints stands for.
std::vector<std::int64_t> signed_varints(const std::string& text) {
  std::vector<std::int64_t> values;
  std::uint64_t value = 0;
  unsigned shift = 0;
  for (const char c : unpacked(text)) {
    const auto byte = static_cast<unsigned char>(c);
    value |= static_cast<std::uint64_t>(byte & 127) << shift;
    shift += 7;
    if (byte & 128) continue;
    values.push_back(static_cast<std::int64_t>(value >> 1) ^ -static_cast<std::int64_t>(value & 1));
    value = shift = 0;
  }
  return values;
}

/// Encodes and decodes random samples of numbers of one kind.
template <class T>
void samples_come_back(Random& random) {
  using Limits = std::numeric_limits<T>;
  int jumps = 0, empty = 0;
  const int kTrials = trials(400);
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto width = static_cast<std::size_t>(1 + random.below(7)),
               count = static_cast<std::size_t>(random.below(60));
    std::vector<T> values(width * count);
    for (T& value : values) {
      const int kind = random.below(4);  // small, any, or one of the ends
      value = kind == 0   ? static_cast<T>(random.below(200) - 100)
              : kind == 1 ? static_cast<T>(random.uniform(Limits::min(), Limits::max()))
              : kind == 2 ? Limits::min()
                          : Limits::max();
    }
    const std::vector<std::int64_t> bends = signed_varints(encode_samples(values, width));
    ASSERT_EQ(bends.size(), values.size());
    for (std::size_t k = 0; k < width; ++k)
      for (std::size_t n = 0; n < count; ++n) {
        const auto at = [&](std::size_t back) -> std::int64_t {
          return n < back ? 0 : values[(n - back) * width + k];
        };
        ASSERT_EQ(bends[k * count + n], at(0) - 2 * at(1) + at(2));
        jumps += std::abs(bends[k * count + n]) > Limits::max();
      }
    empty += count == 0;
  }
  EXPECT_GE(jumps, at_least(10000));
  EXPECT_GE(empty, at_least_among(2));
}

TEST(Packed, SamplesComeBack) {
  Random random(seed("Packed.SamplesComeBack"));
  samples_come_back<std::int16_t>(random);
  samples_come_back<std::int32_t>(random);
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
