// SPDX-License-Identifier: BSD-3-Clause
// Motions of arms without an arm angle, and lengths along their self-motion, each against what is
// plainly right.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "inner_posture.hpp"
#include "robots.hpp"
#include "swivel/core/kinematics/self_motion/self_motion.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/motion/arc_lengths.hpp"
#include "swivel/core/motion/path_motion.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "worst_rates.hpp"

namespace swivel {
namespace {

using namespace test;

/// A path from a posture well inside the limits, and rows that drift along the self-motion.
struct Drifting {
  Chain chain;
  ArmClass kind;
  std::optional<ToolPath> path;
  std::vector<TrajectoryRow> rows;
};
std::vector<Chain> chains() {
  std::vector<Chain> result;
  for (const char* const name : {"panda_like", "xarm7_like", "gen3_like", "fetch_like"}) {
    TestRobot robot = data_robot(name);
    robot.tip_link = "flange";
    result.push_back(arm_of(robot).chain);
  }
  result.push_back(arm_of(offset_robot()).chain);
  for (const char* const name : {"kr6_like", "ur5e_like"}) {
    const TestRobot robot = data_robot(name);
    result.push_back(
        build_arm(*robot.model, robot.base_link, "flange", {}, Pose::Identity(), Roll{}).chain);
  }
  return result;
}
std::optional<Drifting> drifting(const Chain& chain, Random& random) {
  Drifting d;
  d.chain = chain;
  d.kind = classify(chain, "test");
  Config q = inner_posture(chain, random);
  std::vector<Waypoint> waypoints{waypoint_of(chain.tool(q))};
  for (int k = 0; k < 3; ++k) {
    Waypoint to = waypoints.back();
    if (random.coin(0.8)) to.position += random_vector(random, random.uniform(0.02, 0.06));
    const Vector3d turn = random_vector(random, random.uniform(0.05, 0.3));
    to.orientation =
        (to.orientation * Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())))
            .normalized();
    waypoints.push_back(to);
  }
  d.path.emplace(waypoints, Resolution{.ds = 0.01, .dphi = 0.05, .dalpha = 0.1}, "test", Budget(),
                 PathSmoothing{});
  const SelfMotion motion(chain, d.kind.lock, 0);
  Config way = Config::Zero();
  for (int i = 0; i < d.path->size(); ++i) {
    for (double& joint : way.coordinates()) joint += random.uniform(-0.01, 0.01);
    const auto image =
        motion.image(q + (i == 0 ? Config(Config::Zero()) : way), d.path->layer(i).tool);
    if (!image || (*image - q).lpNorm<Eigen::Infinity>() > 0.3) return std::nullopt;
    q = *image;
    d.rows.push_back({d.path->layer(i).s, 0, 0, q});
  }
  return d;
}

/// Returns whether all joints are within their limits.
bool within_limits(const Chain& chain, const Config& q) {
  for (std::size_t j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[j];
    const double at = q[static_cast<Eigen::Index>(j)];
    if (!limit.continuous && (at < limit.lower || at > limit.upper)) return false;
  }
  return true;
}

TEST(ArcMotion, KeepsTheRatesOfTheJointsAndTheToolOnItsPath) {
  const std::uint64_t base = seed("ArcMotion");
  const std::vector<Chain> all = chains();
  int timed = 0, places = 0, samples = 0;
  double off_path = 0, off_rows = 0, worst[3] = {0, 0, 0};
  for (int trial = 0; trial < trials(105); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const auto d = drifting(all[static_cast<std::size_t>(trial) % all.size()], random);
    if (!d) continue;
    const auto motion = make_path_motion(d->chain, d->kind, *d->path, d->rows);
    if (!motion->jumps().empty()) continue;
    for (int i = 0; i < d->path->size(); ++i) {
      const auto q = motion->joints(d->path->layer(i).travel);
      ASSERT_TRUE(q) << trial;
      const Config& row = d->rows[static_cast<std::size_t>(i)].q;
      if (!within_limits(d->chain, row)) continue;  // is moved inside
      off_rows = std::max(off_rows, joint_norm(*q - row));
    }
    for (int k = 0; k < 100; ++k) {
      const double x = random.uniform(0, motion->length());
      const auto q = motion->joints(x);
      ASSERT_TRUE(q) << trial;
      ++places;
      off_path =
          std::max(off_path, (d->chain.tool(*q).matrix() - d->path->at_travel(x).matrix()).norm());
      const TrajectoryRow row = motion->row(x, *q);
      EXPECT_EQ(row.q, *q);
      EXPECT_TRUE(!d->chain.roll || row.phi == (*q)[kDof - 1]);
    }
    Limits limits;
    limits.joint_speed.emplace().fill(random.uniform(0.5, 2));
    limits.joint_acceleration.emplace().fill(random.uniform(2, 15));
    limits.joint_jerk.emplace().fill(random.uniform(20, 300));
    const JointRates rates = joint_rates(d->chain, limits, "test");
    EXPECT_EQ(std::isfinite(rates.speed[kDof - 1]), !d->chain.roll);
    const TimingOptions options{.speed = random.coin() ? 0.05 : 0.25,
                                .turn_speed = {},
                                .rate = random.coin() ? 250.0 : 1000.0};
    const TimingResult result = time_path(*motion, rates, options);
    ASSERT_TRUE(result.motion) << trial << ": " << result.failure->reason;
    ++timed;
    samples += keep_worst_rates(result.motion->rows, 1 / options.rate, rates, worst);
  }
  std::printf(
      "%d motions, %d samples, %d places: within %.2g of the path, %.2g rad of the rows; worst "
      "ratios %.4f %.4f %.4f\n",
      timed, samples, places, off_path, off_rows, worst[0], worst[1], worst[2]);
  EXPECT_LE(off_path, 1e-9);
  EXPECT_LE(off_rows, 1e-8);
  for (const double ratio : worst) EXPECT_LE(ratio, 1 + 1e-9);
  EXPECT_GE(timed, at_least(30));
}

/// Rows on a limit: between them the joint stays inside, where a spline through them would not.
TEST(ArcMotion, MovesRowsOffLimits) {
  const std::uint64_t base = seed("OffLimits");
  const std::vector<Chain> all = chains();
  constexpr double kOff = 1e-3;
  int left = 0, kept = 0, tried = 0;
  for (int trial = 0; trial < trials(105); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    auto d = drifting(all[static_cast<std::size_t>(trial) % all.size()], random);
    if (!d) continue;
    // The limit of some joint is put where it is largest, and rows are taken to it wherever they
    // come within a hundredth.
    const auto joint = static_cast<std::size_t>(random.below(d->chain.roll ? kDof - 1 : kDof));
    const auto at = static_cast<Eigen::Index>(joint);
    double most = -1e9;
    for (const TrajectoryRow& row : d->rows) most = std::max(most, row.q[at]);
    JointLimit& limit = d->chain.limit[joint];
    limit.continuous = false;
    limit.upper = most;
    limit.lower = most - 5;
    const auto beyond = [&](double off_limits) -> std::optional<double> {
      const auto motion = make_path_motion(d->chain, d->kind, *d->path, d->rows, 0, off_limits);
      if (!motion->jumps().empty()) return std::nullopt;
      double by = -1e9;
      for (double x = 0; x < motion->length(); x += 0.5e-3)
        if (const auto q = motion->joints(x)) by = std::max(by, (*q)[at] - most);
      return by;
    };
    const auto before = beyond(0), after = beyond(kOff);
    if (!before || !after) continue;
    ++tried;
    if (*before <= 1e-9) continue;
    ++left;
    EXPECT_LE(*after, *before + 1e-9) << trial;
    kept += *after <= 1e-9;
  }
  std::printf("%d of %d motions leave a limit that no row leaves, %d of them no more\n", left,
              tried, kept);
  EXPECT_GE(left, at_least(3));
  EXPECT_GE(kept, at_least_among(left / 2));
}

TEST(ArcLengths, AreThoseOfAWalkInSmallSteps) {
  const std::uint64_t base = seed("ArcLengths");
  const std::vector<Chain> all = chains();
  int compared = 0, nearest = 0;
  double worst = 0;
  for (int trial = 0; trial < trials(105); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const auto d = drifting(all[static_cast<std::size_t>(trial) % all.size()], random);
    if (!d) continue;
    std::vector<Config> origins;
    for (const TrajectoryRow& row : d->rows) origins.push_back(row.q);
    const ArcLengths lengths(d->chain, *d->path, origins);
    const int layer = random.below(d->path->size());
    const Pose& tool = d->path->layer(layer).tool;
    const SelfMotion motion(d->chain, d->kind.lock, 0);
    const auto at = [&](double x) { return lengths.joints(layer, x); };
    ASSERT_TRUE(at(0)) << trial;
    EXPECT_LE(joint_norm(*at(0) - origins[static_cast<std::size_t>(layer)]), 1e-8) << trial;
    for (const double sign : {-1.0, 1.0}) {
      const auto ahead = at(sign * 0.01);
      if (!ahead) continue;
      constexpr double kStep = 2e-3;
      Config q = *at(0), way = (*ahead - q) / joint_norm(*ahead - q);
      for (int k = 1; k <= 400; ++k) {
        const auto next = motion.image(q + kStep * way, tool);
        if (!next) break;
        way = (*next - q) / joint_norm(*next - q);
        q = *next;
        if (k % 50 != 0) continue;
        const auto there = at(sign * k * kStep);
        if (!there) break;
        ++compared;
        EXPECT_LE((d->chain.tool(*there).matrix() - tool.matrix()).norm(), 1e-9) << trial;
        worst = std::max(worst, joint_norm(*there - q));
      }
    }
    // Between two layers: no place on the curve is nearer to the joints half-way.
    if (layer == 0 || layer + 1 == d->path->size()) continue;
    const double x = random.uniform(-0.2, 0.2), y = random.uniform(-0.2, 0.2);
    const auto from = lengths.joints(layer - 1, x), to = lengths.joints(layer + 1, y);
    if (!from || !to) continue;
    const double z = lengths.between(layer, layer - 1, x, layer + 1, y);
    if (z == 0) continue;  // there is none near
    const double t = (lengths.travel(layer) - lengths.travel(layer - 1)) /
                     (lengths.travel(layer + 1) - lengths.travel(layer - 1));
    const Config middle = *from + t * (*to - *from);
    ++nearest;
    for (const double other : {z - 0.01, z + 0.01})
      if (const auto q = at(other)) {
        EXPECT_LE(joint_norm(*at(z) - middle), joint_norm(*q - middle) + 1e-4) << trial;
      }
  }
  std::printf("%d places compared, at most %.2g rad apart; %d between layers\n", compared, worst,
              nearest);
  EXPECT_LE(worst, 5e-3);
  EXPECT_GE(compared, at_least(100));
  EXPECT_GE(nearest, at_least(8));
}

}  // namespace
}  // namespace swivel
