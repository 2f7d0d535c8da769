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

/// Returns the vector units of this machine, the scalar one first.
std::vector<const CircleKernels*> circle_units() {
  std::vector<const CircleKernels*> units{&scalar_circle_kernels()};
#ifdef SWIVEL_X86_KERNELS
  if (__builtin_cpu_supports("avx2")) units.push_back(&avx2_circle_kernels());
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    units.push_back(&avx512_circle_kernels());
#endif
  return units;
}

/// Arm angles (rad), their sines and cosines, and the lower limits of the shoulder's joints (rad).
struct ArmAngles {
  std::vector<double> phi, s, c;
  double base[3];
};

/// Draws 1 to 70 arm angles and limits.
ArmAngles random_arm_angles(Random& random) {
  ArmAngles angles;
  const int n = 1 + random.below(70);  // tails of every length
  for (int k = 0; k < n; ++k) {
    angles.phi.push_back(random.uniform(-kPi, kPi));
    angles.s.push_back(std::sin(angles.phi.back()));
    angles.c.push_back(std::cos(angles.phi.back()));
  }
  for (double& base : angles.base) base = random.uniform(-7, 1);
  return angles;
}

/// Checks that every unit gives the bits of `scalar`, for all angles at once and for each alone.
void check_bits(const std::vector<const CircleKernels*>& units, const TripleCircle& shoulder,
                double shift, const ArmAngles& angles, const Angles& scalar) {
  const auto& [phi, s, c, base] = angles;
  for (std::size_t unit = 1; unit < units.size(); ++unit) {
    const Angles other = run(*units[unit], shoulder, shift, base, s, c);
    ASSERT_EQ(0,
              std::memcmp(scalar.out.data(), other.out.data(), scalar.out.size() * sizeof(double)))
        << units[unit]->name;
  }
  // An arm angle that is solved alone has the same bits as among others.
  for (std::size_t k = 0; k < s.size(); ++k) {
    const Angles alone = run(*units.back(), shoulder, shift, base, {s[k]}, {c[k]});
    for (std::size_t row = 0; row < 8; ++row)
      ASSERT_EQ(alone.out[row], scalar.out[row * s.size() + k]);
  }
}

/// Counts nodes that were compared with the closed form, those barred, and the worst difference
/// (rad).
struct ClosedFormCounts {
  int compared = 0, barred = 0;
  double worst = 0;
};

/// Compares the shoulder's joints at the k-th arm angle with the closed form, and the mask with the
/// limits.
void check_closed_form(const SrsArm& srs, const std::array<ElbowCircle, 2>& circles,
                       const ArmAngles& angles, const Angles& scalar, std::size_t k,
                       ClosedFormCounts& counts) {
  const double* base = angles.base;
  const auto entry = [&](int row) {
    return scalar.out[static_cast<std::size_t>(row) * angles.s.size() + k];
  };
  for (int sign = 0; sign < 2; ++sign) {
    const Config q = srs_ik(srs, circles, angles.phi[k], sign ? kShoulderBit : 0);
    const double sine = std::abs(std::sin(entry(1) + srs.shoulder.shift));
    if (std::abs(sine - 1e-4) > 1e-9) {
      bool inside = sine >= 1e-4;
      for (int j = 0; j < 3; ++j) inside = inside && entry(sign * 3 + j) <= base[j] + 5;
      ASSERT_EQ(entry(6 + sign), inside ? 0 : std::numeric_limits<double>::infinity());
      counts.barred += !inside;
    }
    if (sine < 1e-4) continue;
    for (int j = 0; j < 3; ++j) {
      const double value = entry(sign * 3 + j);
      counts.worst = std::max(counts.worst, std::abs(std::remainder(value - q[j], kTwoPi)));
      ASSERT_GE(value, base[j] - 1e-12);
      ASSERT_LT(value, base[j] + kTwoPi + 1e-12);
    }
  }
  ++counts.compared;
}

TEST(Kernels, EveryVectorUnitGivesTheScalarBitsAndTheClosedFormValues) {
  Random random(seed("Kernels"));
  const std::vector<const CircleKernels*> units = circle_units();
  const TestRobot robot = data_robot("sda5f");
  const Chain chain = arm_of(robot).chain;
  const SrsArm srs = fit_srs(chain, robot.name);
  ClosedFormCounts counts;
  for (int trial = 0; trial < trials(2000); ++trial) {
    const Pose tool = chain.tool(random_config(chain, random));
    const ArmPlane plane = first_plane(srs, tool);
    if (reach_status(srs, plane.reach) != ReachStatus::kReachable) continue;
    const auto circles = elbow_circles(srs, plane, tool);
    const TripleCircle& shoulder = circles[0].shoulder;
    const ArmAngles angles = random_arm_angles(random);
    const Angles scalar =
        run(*units[0], shoulder, srs.shoulder.shift, angles.base, angles.s, angles.c);
    check_bits(units, shoulder, srs.shoulder.shift, angles, scalar);
    for (std::size_t k = 0; k < angles.s.size() && !HasFatalFailure(); ++k)
      check_closed_form(srs, circles, angles, scalar, k, counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%zu units, %d nodes, %d of them barred in one of two signs, worst difference from libm "
      "%.2e\n",
      units.size(), counts.compared, counts.barred, counts.worst);
  EXPECT_GT(counts.compared, trials(2000) * 10);
  EXPECT_LT(counts.worst, 1e-11);
  EXPECT_GT(counts.barred, counts.compared / 10);
}

/// Returns the vector units of this machine, the scalar one first.
std::vector<const NewtonKernels*> newton_units() {
  std::vector<const NewtonKernels*> units{&scalar_newton_kernels()};
#ifdef SWIVEL_X86_KERNELS
  if (__builtin_cpu_supports("avx2")) units.push_back(&avx2_newton_kernels());
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    units.push_back(&avx512_newton_kernels());
#endif
  return units;
}

/// Points (rad) from which one pose of the tool is asked for, and the values of the locked joint
/// (rad), one for each point.
struct NewtonCase {
  Pose tool;
  std::vector<Config> starts;
  std::vector<double> values;
  NewtonTask task;
};

/// Draws a reachable pose and 1 to 30 points about the joints that reach it.
NewtonCase random_newton_case(const Chain& chain, const PoseNewton& newton, NewtonMove move,
                              Random& random) {
  NewtonCase asked;
  asked.starts.resize(static_cast<std::size_t>(1 + random.below(30)));
  Config reached;
  for (double& angle : reached.coordinates()) angle = random.uniform(-kPi, kPi);
  asked.tool = chain.tool(reached);
  const double spread = random.coin(0.3) ? kPi : 0.2;  // far starts mostly fail
  NewtonTask& task = asked.task = newton.task(asked.tool, move, 1 + random.below(8));
  task.joint = random.below(kDof);
  for (Config& start : asked.starts) {
    for (int j = 0; j < kDof; ++j) start[j] = reached[j] + random.uniform(-spread, spread);
    if (random.coin(0.1)) start.setZero();  // singular poses of many arms
    asked.values.push_back(random.coin() ? start[task.joint]
                                         : reached[task.joint] + random.uniform(-spread, spread));
  }
  for (double& scale2 : task.scale2) scale2 = random.uniform(0.01, 1);
  return asked;
}

/// What a unit found for each point: joints (rad), null vectors, and whether it found any.
struct Answer {
  std::vector<Config> q, null;
  std::vector<unsigned char> found;
};

/// Asks a unit about some of the points at once, from the `first` on.
Answer ask(const NewtonKernels& kernels, const NewtonCase& asked, std::size_t first,
           std::size_t points) {
  Answer answer{std::vector<Config>(points), std::vector<Config>(points),
                std::vector<unsigned char>(points, 2)};
  NewtonTask task = asked.task;
  task.n = static_cast<int>(points);
  task.start = asked.starts[first].data();
  task.value = asked.values.data() + first;
  task.q = task.particular = answer.q[0].data();
  task.null = answer.null[0].data();
  task.found = answer.found.data();
  kernels.solve(task);
  return answer;
}

/// Checks that a unit which is asked about all points at once gives the bits of each alone.
void check_bits(const NewtonKernels& unit, const NewtonCase& asked,
                const std::vector<Answer>& one_by_one, const std::string& arm) {
  const Answer all = ask(unit, asked, 0, asked.starts.size());
  for (std::size_t k = 0; k < asked.starts.size(); ++k) {
    ASSERT_EQ(all.found[k], one_by_one[k].found[0]) << arm;
    if (all.found[k] == 0) continue;
    ASSERT_EQ(0, std::memcmp(all.q[k].data(), one_by_one[k].q[0].data(), sizeof(Config))) << arm;
    ASSERT_EQ(0, std::memcmp(all.null[k].data(), one_by_one[k].null[0].data(), sizeof(Config)))
        << arm;
  }
}

/// Counts points that Newton's method found, failed at and met singular, and how far the worst is
/// off its pose (entries of the matrix).
struct NewtonCounts {
  int found = 0, failed = 0, singular = 0;
  double worst = 0;
};

/// Checks what was found for the k-th point.
void check_point(const Chain& chain, const NewtonCase& asked, const Answer& answer, std::size_t k,
                 const std::string& arm, NewtonCounts& counts) {
  const NewtonTask& task = asked.task;
  const Config &q = answer.q[0], &null = answer.null[0];
  if (answer.found[0] == 0) {
    (task.move == NewtonMove::kNone ? counts.singular : counts.failed) += 1;
    return;
  }
  ++counts.found;
  if (task.move == NewtonMove::kNone) {
    const auto J = chain.jacobian(asked.starts[k]);
    ASSERT_LT((J * null.head<kDof>()).norm(), 1e-7 * joint_norm(null)) << arm;
    return;
  }
  counts.worst =
      std::max(counts.worst, (chain.tool(q).matrix() - asked.tool.matrix()).cwiseAbs().maxCoeff());
  ASSERT_NEAR(joint_norm(null), 1, 1e-14);
  if (task.move == NewtonMove::kLocked) {
    ASSERT_EQ(q[task.joint], asked.values[k]);
  }
}

/// Points asked about at once have the bits of one after the other, on every vector unit, and stand
/// where they must.
TEST(Kernels, NewtonGivesEveryPointItsOwnBits) {
  Random random(seed("Newton"));
  const std::vector<const NewtonKernels*> units = newton_units();
  std::vector<ArmTable> arms = arms_7r();
  for (const ArmTable& arm : arms_6r()) arms.push_back(arm);
  NewtonCounts counts;
  for (const ArmTable& arm : arms) {
    const Chain chain = chain_of(arm);
    const PoseNewton newton(chain);
    for (int trial = 0; trial < trials(150); ++trial) {
      const auto move = std::array{NewtonMove::kNone, NewtonMove::kNearest,
                                   NewtonMove::kLocked}[static_cast<std::size_t>(trial % 3)];
      const NewtonCase asked = random_newton_case(chain, newton, move, random);
      std::vector<Answer> one_by_one;
      for (std::size_t k = 0; k < asked.starts.size(); ++k)
        one_by_one.push_back(ask(*units[0], asked, k, 1));
      for (const NewtonKernels* unit : units) {
        check_bits(*unit, asked, one_by_one, arm.name);
        if (HasFatalFailure()) return;
      }
      for (std::size_t k = 0; k < asked.starts.size(); ++k) {
        check_point(chain, asked, one_by_one[k], k, arm.name, counts);
        if (HasFatalFailure()) return;
      }
    }
  }
  std::printf("%zu units, %d points found, %d not, %d singular; off the pose by up to %.1e\n",
              units.size(), counts.found, counts.failed, counts.singular, counts.worst);
  EXPECT_LT(counts.worst, 1e-9);
  EXPECT_GE(counts.found, at_least(10000));
  EXPECT_GE(counts.failed, at_least(3000));
  EXPECT_GE(counts.singular, at_least(10));
}

}  // namespace
}  // namespace swivel
