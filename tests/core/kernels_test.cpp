// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "kernels/kernels.hpp"
#include "robots.hpp"

namespace swivel {
namespace {

using namespace test;

struct Angles {
  std::vector<double> out;
  explicit Angles(std::size_t n) : out(8 * n) {}
};

Angles run(const CircleKernels& kernels, const TripleCircle& m, double shift, const double* base, const std::vector<double>& s,
           const std::vector<double>& c) {
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
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
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
      ASSERT_EQ(0, std::memcmp(scalar.out.data(), other.out.data(), scalar.out.size() * sizeof(double))) << units[unit]->name;
    }
    for (int k = 0; k < n; ++k) {  // one at a time: the same bits however asked
      const Angles alone = run(*units.back(), circles[0].shoulder, srs.shoulder.shift, base, {s[static_cast<std::size_t>(k)]},
                               {c[static_cast<std::size_t>(k)]});
      for (int row = 0; row < 8; ++row)
        ASSERT_EQ(alone.out[static_cast<std::size_t>(row)], scalar.out[static_cast<std::size_t>(row * n + k)]);
      for (int sign = 0; sign < 2; ++sign) {
        const Config q = srs_ik(srs, circles, phi[static_cast<std::size_t>(k)], sign ? kShoulderBit : 0);
        const auto entry = [&](int row) { return scalar.out[static_cast<std::size_t>(row * n + k)]; };
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
  std::printf("%zu units, %d nodes, %d of them barred in one of two signs, worst difference from libm %.2e\n", units.size(),
              compared, barred, worst);
  EXPECT_GT(compared, trials(2000) * 10);
  EXPECT_LT(worst, 1e-11);
  EXPECT_GT(barred, compared / 10);
}

}  // namespace
}  // namespace swivel
