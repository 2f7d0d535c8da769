// SPDX-License-Identifier: BSD-3-Clause
#include "proofs/distances_about.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "seed.hpp"

namespace swivel::detail {
namespace {

using test::Random;
using test::seed;
using test::trials;

TEST(DistancesAbout, AreThoseThatDecideARank) {
  constexpr double kMost = 1e6, kBeside = 1e-3;
  const std::uint64_t base = seed("DistancesAbout");
  std::int64_t asked = 0, cut_short = 0, beside = 0;
  for (int trial = 0; trial < trials(3000); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const std::size_t count = 1 + static_cast<std::size_t>(random.below(300)),
                      rank = static_cast<std::size_t>(random.below(static_cast<int>(count)));
    std::vector<double> all;
    const int kind = random.below(5);
    for (std::size_t k = 0; k < count; ++k) {
      const double x = random.uniform(0, 1);
      all.push_back(kind == 0   ? x
                    : kind == 1 ? std::round(4 * x)               // many alike
                    : kind == 2 ? 2e-3 + 1e-4 * x                 // all beside each other
                    : kind == 3 ? static_cast<double>(k) / count  // the first ones are the least
                                : (random.coin(0.5) ? 0 : std::exp(10 * x)));  // half of them touch
    }
    const auto found = distances_about(
        count, rank, kMost, kBeside, [&](std::size_t k, double enough, double limit) {
          ++asked;
          const double d = all[k];
          cut_short += d < enough || d > limit;
          if (d > limit) return limit;
          return d < enough ? d + random.uniform(0, 0.999) * (enough - d) : d;
        });
    ASSERT_EQ(found.size(), count);
    std::vector<double> plain = all, mine = found;
    std::sort(plain.begin(), plain.end());
    std::sort(mine.begin(), mine.end());
    ASSERT_EQ(mine[rank], plain[rank]) << "SWIVEL_TEST_SEED " << base << " trial " << trial;
    for (std::size_t k = 0; k < count; ++k) {
      if (std::abs(all[k] - plain[rank]) > kBeside) continue;
      ++beside;
      ASSERT_EQ(found[k], all[k]) << "SWIVEL_TEST_SEED " << base << " trial " << trial;
    }
  }
  std::printf("seed %llu: %lld distances asked, %lld cut short, %lld beside the one of the rank\n",
              static_cast<unsigned long long>(base), static_cast<long long>(asked),
              static_cast<long long>(cut_short), static_cast<long long>(beside));
  EXPECT_GT(cut_short, asked / 4);
}

}  // namespace
}  // namespace swivel::detail
