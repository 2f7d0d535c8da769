// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/self_motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "arms.hpp"
#include "seed.hpp"

namespace swivel {
namespace {

using namespace test;

double pose_distance(const Pose& a, const Pose& b) {
  return std::max((a.translation() - b.translation()).norm(), (a.linear() - b.linear()).norm() / std::sqrt(2.0));
}

double turn(double x) {
  return std::remainder(x, kTwoPi);
}

/// Newton from anywhere, by pseudo-inverse; written apart from the library's.
bool solve(const Chain& chain, const Pose& tool, Config& q) {
  for (int step = 0; step < 60; ++step) {
    const Pose reached = chain.tool(q);
    if (pose_distance(reached, tool) < 1e-10) return true;
    Eigen::Matrix<double, 6, 1> error;
    const Eigen::AngleAxisd way(tool.linear() * reached.linear().transpose());
    error << tool.translation() - reached.translation(), way.angle() * way.axis();
    const auto J = chain.jacobian(q);
    const Eigen::Matrix<double, 6, 6> A = J * J.transpose() + 1e-4 * error.squaredNorm() * Eigen::Matrix<double, 6, 6>::Identity();
    const Config move = J.transpose() * A.ldlt().solve(error);
    q += move * std::min(1.0, 0.5 / std::max(move.norm(), 1e-12));
  }
  return false;
}

double distance_to(const SelfMotionArc& arc, const Config& q) {
  double least = 1e9;
  for (std::size_t k = 0; k < arc.q.size(); ++k) {
    if (k + 1 == arc.q.size() && !arc.closed) {
      Config d;
      for (int j = 0; j < kDof; ++j) d[j] = turn(q[j] - arc.q[k][j]);
      least = std::min(least, d.norm());
      break;
    }
    const Config &a = arc.q[k], &b = arc.q[(k + 1) % arc.q.size()];
    Config d, c;
    for (int j = 0; j < kDof; ++j) {
      d[j] = turn(q[j] - a[j]);
      c[j] = turn(b[j] - a[j]);
    }
    least = std::min(least, (d - std::clamp(d.dot(c) / std::max(c.squaredNorm(), 1e-30), 0.0, 1.0) * c).norm());
  }
  return least;
}

/// Inside the limits; a bounded joint is moved to its image there.
bool inside(const Chain& chain, Config& q) {
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    if (limit.continuous || limit.upper - limit.lower >= kTwoPi) continue;
    if (q[j] >= limit.lower && q[j] <= limit.upper) continue;  // no rounding through the image
    const double middle = (limit.lower + limit.upper) / 2;
    q[j] = middle + turn(q[j] - middle);
    if (q[j] < limit.lower || q[j] > limit.upper) return false;
  }
  return true;
}

TEST(SelfMotion, MissesNoArcThatRandomSeedsFind) {
  Random random(seed("SelfMotion.MissesNoArcThatRandomSeedsFind"));
  int seeds = 0, poses = 0;
  for (ArmTable table : {arms_7r()[0], arms_7r()[1], arms_7r()[3], arms_6r()[0], arms_6r()[4]}) {
    const Chain chain = chain_of(table);
    const SelfMotion motion(chain, lock_method(chain), 0);
    int missed = 0, arcs_in_all = 0;
    double worst = 0, length = 0;
    for (int trial = 0; trial < trials(8); ++trial) {
      Config q;
      for (int j = 0; j < kDof; ++j) {
        const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
        q[j] = limit.continuous ? random.uniform(-kPi, kPi) : random.uniform(limit.lower, limit.upper);
      }
      const Pose tool = chain.tool(q);
      const auto arcs = motion.arcs(tool);
      ++poses;
      arcs_in_all += static_cast<int>(arcs.size());
      for (const SelfMotionArc& arc : arcs) {
        for (std::size_t k = 0; k < arc.q.size(); ++k) {
          worst = std::max(worst, pose_distance(chain.tool(arc.q[k]), tool));
          Config copy = arc.q[k];
          EXPECT_TRUE(inside(chain, copy));
          if (k > 0) {
            double step = 0;
            for (int j = 0; j < kDof; ++j) step += turn(arc.q[k][j] - arc.q[k - 1][j]) * turn(arc.q[k][j] - arc.q[k - 1][j]);
            EXPECT_LE(std::sqrt(step), 0.1 + 1e-9);
            length += std::sqrt(step);
          }
        }
        if (arc.first_limit >= 0) {
          const JointLimit& limit = chain.limit[static_cast<std::size_t>(arc.first_limit)];
          EXPECT_TRUE(arc.q[0][arc.first_limit] == limit.lower || arc.q[0][arc.first_limit] == limit.upper);
        }
      }
      for (int k = 0; k < 500; ++k) {
        Config x;
        for (int j = 0; j < kDof; ++j) x[j] = random.uniform(-kPi, kPi);
        if (k == 0) x = q;
        if (!solve(chain, tool, x) || !inside(chain, x)) continue;
        ++seeds;
        double nearest = 1e9;
        for (const SelfMotionArc& arc : arcs) nearest = std::min(nearest, distance_to(arc, x));
        missed += nearest > 0.02;
      }
    }
    std::printf("  %s: %.1f arcs a pose, mean length %.2f, residual %.1e, seeds off every arc %d\n", table.name.c_str(),
                static_cast<double>(arcs_in_all) / trials(8), length / std::max(1, arcs_in_all), worst, missed);
    EXPECT_LE(worst, 1e-9);
    EXPECT_EQ(missed, 0) << table.name;
  }
  EXPECT_GT(seeds, 20 * poses);
  EXPECT_EQ(poses, 5 * trials(8));
}

}  // namespace
}  // namespace swivel
