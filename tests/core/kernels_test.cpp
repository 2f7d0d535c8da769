// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "arms.hpp"
#include "kinematics/kernels/kernels.hpp"
#include "kinematics/kernels/newton.hpp"
#include "kinematics/newton/pose_newton.hpp"
#include "robots.hpp"

namespace swivel {
namespace {

using namespace test;

struct Angles {
  std::vector<double> out;
  explicit Angles(std::size_t n) : out(8 * n) {}
};

Angles run(const CircleKernels& kernels, const TripleCircle& m, double shift, const double* base,
           const std::vector<double>& s, const std::vector<double>& c) {
  const std::size_t n = s.size();
  Angles result(n);
  TripleTask task;
  for (std::size_t row = 0; row < 5; ++row)
    for (std::size_t column = 0; column < 3; ++column) task.m[row][column] = m[row][column];
  task.shift = shift;
  for (std::size_t j = 0; j < 3; ++j) {
    task.base[j] = base[j];
    task.upper[j] = base[j] + 5;
  }
  task.least_sine = 1e-4;
  task.n = static_cast<int>(n);
  task.sin_phi = s.data();
  task.cos_phi = c.data();
  for (std::size_t sign = 0; sign < 2; ++sign)
    for (std::size_t j = 0; j < 3; ++j) task.q[sign][j] = result.out.data() + (sign * 3 + j) * n;
  for (std::size_t sign = 0; sign < 2; ++sign) task.mask[sign] = result.out.data() + (6 + sign) * n;
  kernels.solve_triple(task);
  return result;
}

TEST(Kernels, EveryVectorUnitGivesTheScalarBitsAndTheClosedFormValues) {
  Random random(seed("Kernels"));
  std::vector<const CircleKernels*> units{&scalar_circle_kernels()};
#ifdef SWIVEL_X86_KERNELS
  if (__builtin_cpu_supports("avx2")) units.push_back(&avx2_circle_kernels());
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    units.push_back(&avx512_circle_kernels());
#endif
  const TestRobot robot = data_robot("sda5f");
  const Chain chain = arm_of(robot).chain;
  const SrsArm srs = fit_srs(chain, robot.name);
  int compared = 0, barred = 0;
  double worst = 0;
  for (int trial = 0; trial < trials(2000); ++trial) {
    const Pose tool = chain.tool(random_config(chain, random));
    const ArmPlane plane = first_plane(srs, tool);
    if (reach_status(srs, plane.reach) != ReachStatus::kReachable) continue;
    const auto circles = elbow_circles(srs, plane, tool);
    const int n = 1 + random.below(70);  // tails of every length
    std::vector<double> phi, s, c;
    for (int k = 0; k < n; ++k) {
      phi.push_back(random.uniform(-kPi, kPi));
      s.push_back(std::sin(phi.back()));
      c.push_back(std::cos(phi.back()));
    }
    const double base[3] = {random.uniform(-7, 1), random.uniform(-7, 1), random.uniform(-7, 1)};
    const Angles scalar = run(*units[0], circles[0].shoulder, srs.shoulder.shift, base, s, c);
    for (std::size_t unit = 1; unit < units.size(); ++unit) {
      const Angles other = run(*units[unit], circles[0].shoulder, srs.shoulder.shift, base, s, c);
      ASSERT_EQ(
          0, std::memcmp(scalar.out.data(), other.out.data(), scalar.out.size() * sizeof(double)))
          << units[unit]->name;
    }
    for (int k = 0; k < n; ++k) {  // one at a time: the same bits however asked
      const Angles alone = run(*units.back(), circles[0].shoulder, srs.shoulder.shift, base,
                               {s[static_cast<std::size_t>(k)]}, {c[static_cast<std::size_t>(k)]});
      for (int row = 0; row < 8; ++row)
        ASSERT_EQ(alone.out[static_cast<std::size_t>(row)],
                  scalar.out[static_cast<std::size_t>(row * n + k)]);
      for (int sign = 0; sign < 2; ++sign) {
        const Config q =
            srs_ik(srs, circles, phi[static_cast<std::size_t>(k)], sign ? kShoulderBit : 0);
        const auto entry = [&](int row) {
          return scalar.out[static_cast<std::size_t>(row * n + k)];
        };
        const double sine = std::abs(std::sin(entry(1) + srs.shoulder.shift));
        if (std::abs(sine - 1e-4) > 1e-9) {
          bool inside = sine >= 1e-4;
          for (int j = 0; j < 3; ++j) inside = inside && entry(sign * 3 + j) <= base[j] + 5;
          ASSERT_EQ(entry(6 + sign), inside ? 0 : std::numeric_limits<double>::infinity());
          barred += !inside;
        }
        if (sine < 1e-4) continue;
        for (int j = 0; j < 3; ++j) {
          const double value = entry(sign * 3 + j);
          worst = std::max(worst, std::abs(std::remainder(value - q[j], kTwoPi)));
          ASSERT_GE(value, base[j] - 1e-12);
          ASSERT_LT(value, base[j] + kTwoPi + 1e-12);
        }
      }
      ++compared;
    }
  }
  std::printf(
      "%zu units, %d nodes, %d of them barred in one of two signs, worst difference from libm "
      "%.2e\n",
      units.size(), compared, barred, worst);
  EXPECT_GT(compared, trials(2000) * 10);
  EXPECT_LT(worst, 1e-11);
  EXPECT_GT(barred, compared / 10);
}

/// Points asked about at once have the bits of one after the other, on every vector unit, and stand
/// where they must.
TEST(Kernels, NewtonGivesEveryPointItsOwnBits) {
  Random random(seed("Newton"));
  std::vector<const NewtonKernels*> units{&scalar_newton_kernels()};
#ifdef SWIVEL_X86_KERNELS
  if (__builtin_cpu_supports("avx2")) units.push_back(&avx2_newton_kernels());
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    units.push_back(&avx512_newton_kernels());
#endif
  std::vector<ArmTable> arms = arms_7r();
  for (const ArmTable& arm : arms_6r()) arms.push_back(arm);
  int found = 0, failed = 0, singular = 0;
  double worst = 0;
  for (const ArmTable& arm : arms) {
    const Chain chain = chain_of(arm);
    const PoseNewton newton(chain);
    for (int trial = 0; trial < trials(150); ++trial) {
      const int n = 1 + random.below(30);
      const auto count = static_cast<std::size_t>(n);
      Config reached;
      for (double& angle : reached) angle = random.uniform(-kPi, kPi);
      const Pose tool = chain.tool(reached);
      const auto move = std::array{NewtonMove::kNone, NewtonMove::kNearest,
                                   NewtonMove::kLocked}[static_cast<std::size_t>(trial % 3)];
      const double spread = random.coin(0.3) ? kPi : 0.2;  // far starts mostly fail
      std::vector<Config> starts(count);
      std::vector<double> values;
      NewtonTask task = newton.task(tool, move, 1 + random.below(8));
      task.joint = random.below(kDof);
      for (Config& start : starts) {
        for (int j = 0; j < kDof; ++j) start[j] = reached[j] + random.uniform(-spread, spread);
        if (random.coin(0.1)) start.setZero();  // singular poses of many arms
        values.push_back(random.coin() ? start[task.joint]
                                       : reached[task.joint] + random.uniform(-spread, spread));
      }
      for (double& scale2 : task.scale2) scale2 = random.uniform(0.01, 1);
      struct Answer {
        std::vector<Config> q, null;
        std::vector<unsigned char> found;
      };
      const auto ask = [&](const NewtonKernels& kernels, std::size_t first, std::size_t points) {
        Answer answer{std::vector<Config>(points), std::vector<Config>(points),
                      std::vector<unsigned char>(points, 2)};
        task.n = static_cast<int>(points);
        task.start = starts[first].data();
        task.value = values.data() + first;
        task.q = task.particular = answer.q[0].data();
        task.null = answer.null[0].data();
        task.found = answer.found.data();
        kernels.solve(task);
        return answer;
      };
      std::vector<Answer> one_by_one;
      for (std::size_t k = 0; k < count; ++k) one_by_one.push_back(ask(*units[0], k, 1));
      for (const NewtonKernels* unit : units) {
        const Answer all = ask(*unit, 0, count);
        for (std::size_t k = 0; k < count; ++k) {
          ASSERT_EQ(all.found[k], one_by_one[k].found[0]) << arm.name;
          if (all.found[k] == 0) continue;
          ASSERT_EQ(0, std::memcmp(all.q[k].data(), one_by_one[k].q[0].data(), sizeof(Config)))
              << arm.name;
          ASSERT_EQ(0,
                    std::memcmp(all.null[k].data(), one_by_one[k].null[0].data(), sizeof(Config)))
              << arm.name;
        }
      }
      for (std::size_t k = 0; k < count; ++k) {
        const Config &q = one_by_one[k].q[0], &null = one_by_one[k].null[0];
        if (one_by_one[k].found[0] == 0) {
          (move == NewtonMove::kNone ? singular : failed) += 1;
          continue;
        }
        ++found;
        if (move == NewtonMove::kNone) {
          const auto J = chain.jacobian(starts[k]);
          ASSERT_LT((J * null).norm(), 1e-7 * null.norm()) << arm.name;
          continue;
        }
        worst = std::max(worst, (chain.tool(q).matrix() - tool.matrix()).cwiseAbs().maxCoeff());
        ASSERT_NEAR(null.norm(), 1, 1e-14);
        if (move == NewtonMove::kLocked) {
          ASSERT_EQ(q[task.joint], values[k]);
        }
      }
    }
  }
  std::printf("%zu units, %d points found, %d not, %d singular; off the pose by up to %.1e\n",
              units.size(), found, failed, singular, worst);
  EXPECT_LT(worst, 1e-9);
  EXPECT_GE(found, at_least(10000));
  EXPECT_GE(failed, at_least(3000));
  EXPECT_GE(singular, at_least(10));
}

}  // namespace
}  // namespace swivel
