// SPDX-License-Identifier: BSD-3-Clause
// Joint moves in time: ends, rates by differences, and how far they are from the least time.
#include <gtest/gtest.h>

#include <algorithm>

#include "robots.hpp"
#include "swivel/core/motion/joint_moves.hpp"

namespace swivel {
namespace {

using namespace test;

/// Returns the greatest differences of samples of each order as parts of the rates, with rest
/// before the first and after the last sample.
std::array<double, 3> greatest_shares(const std::vector<TimedRow>& rows, const JointRates& rates,
                                      double rapid, double rate) {
  std::array<double, 3> most{};
  std::vector<Config> values;
  for (int k = 0; k < 3; ++k) values.push_back(rows.front().row.q);
  for (const TimedRow& row : rows) values.push_back(row.row.q);
  for (int k = 0; k < 3; ++k) values.push_back(rows.back().row.q);
  for (std::size_t order = 0; order < 3; ++order) {
    for (std::size_t k = 0; k + 1 < values.size(); ++k)
      values[k] = (values[k + 1] - values[k]) * rate;
    values.pop_back();
    const Config& limit = order == 0   ? Config(rapid * rates.speed)
                          : order == 1 ? rates.acceleration
                                       : rates.jerk;
    for (const Config& value : values)
      most[order] =
          std::max(most[order], value.cwiseAbs().cwiseQuotient(limit).head<kDof>().maxCoeff());
  }
  return most;
}

TEST(JointMoves, RestAtCornersAndKeepRates) {
  Random random(seed("JointMoves"));
  int at_speed = 0, at_acceleration = 0, at_jerk = 0;
  const int count = trials(400);
  for (int trial = 0; trial < count; ++trial) {
    JointRates rates;
    for (int j = 0; j < kDof; ++j) {
      rates.speed[j] = random.uniform(0.3, 3);
      rates.acceleration[j] = random.uniform(1, 20);
      rates.jerk[j] = random.uniform(10, 200);
    }
    const double rapid = random.uniform(0.2, 1), rate = random.coin() ? 250 : 100;
    std::vector<Config> corners;
    const double size = std::array{0.01, 0.3, 3.0}[static_cast<std::size_t>(random.below(3))];
    for (int k = 2 + random.below(4); k > 0; --k) {
      Config q;
      for (int j = 0; j < kDof; ++j) q[j] = random.coin(0.1) ? 0 : random.uniform(-size, size);
      corners.push_back(q);
    }
    const std::vector<TimedRow> rows = time_joint_moves(corners, rates, rapid, rate);
    std::size_t next = 0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      ASSERT_NEAR(rows[k].t * rate, static_cast<double>(k), 1e-6);
      if (next < corners.size() && rows[k].row.q == corners[next] && rows[k].v.isZero()) ++next;
    }
    ASSERT_EQ(next, corners.size()) << "trial " << trial;
    ASSERT_EQ(rows.back().row.q, corners.back());
    const auto most = greatest_shares(rows, rates, rapid, rate);
    for (const double share : most) ASSERT_LE(share, 1 + 1e-6) << "trial " << trial;
    at_speed += most[0] > 0.95;
    at_acceleration += most[1] > 0.95;
    at_jerk += most[2] > 0.7;
  }
  std::printf("%d motions: %d at a speed limit, %d at an acceleration, %d at a jerk\n", count,
              at_speed, at_acceleration, at_jerk);
  EXPECT_GT(at_speed, count / 8);
  EXPECT_GT(at_acceleration, count / 8);
  EXPECT_GT(at_jerk, count / 4);
}

}  // namespace
}  // namespace swivel
