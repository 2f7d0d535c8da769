// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/closed_form/closed_form.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "arms.hpp"
#include "seed.hpp"

namespace swivel {
namespace {

using namespace test;

double turn_distance(const Config6& a, const Config6& b) {
  double most = 0;
  for (int j = 0; j < kSix; ++j)
    most = std::max(most, std::abs(std::remainder(a[j] - b[j], kTwoPi)));
  return most;
}

double pose_distance(const Pose& a, const Pose& b) {
  return std::max((a.translation() - b.translation()).norm(),
                  (a.linear() - b.linear()).norm() / std::sqrt(2.0));
}

enum class Draw { kLimits, kTurns, kSquare };

/// Within the limits; or anywhere; or half of the joints at multiples of 90 degrees.
Config draw(const Chain& chain, Draw kind, Random& random) {
  Config q;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    const bool within = kind == Draw::kLimits && !limit.continuous;
    q[j] = within ? random.uniform(limit.lower, limit.upper) : random.uniform(-kPi, kPi);
    if (kind == Draw::kSquare && random.coin()) q[j] = kPi / 2 * random.below(4);
  }
  return q;
}

struct Tally {
  int tried = 0, found = 0, singular = 0, unsolved = 0, solutions = 0, most = 0;
  double worst = 0, farthest = 0;
  double missed_at = 0;  // largest |det J| of a configuration that was not found
};

Tally round_trip(const Chain& chain, int lock, Draw kind, int count, Random& random) {
  Tally tally;
  for (int trial = 0; trial < count; ++trial) {
    const Config whole = draw(chain, kind, random);
    const SixChain six = lock_joint(chain, lock, whole[lock]);
    const Pose tool = chain.tool(whole);
    const Config6 q = without_joint(whole, lock);
    ++tally.tried;
    const auto form = ClosedForm::of(six);
    const double determinant = std::abs(six.jacobian(q).determinant());
    const bool singular = determinant <= 1e-7;
    tally.singular += singular;
    if (!form) {
      EXPECT_TRUE(singular);
      ++tally.unsolved;
      continue;
    }
    const auto solutions = form->solve(tool);
    tally.solutions += solutions.count;
    tally.most = std::max(tally.most, solutions.count);
    double nearest = 1e9;
    for (const Config6& solution : solutions) {
      EXPECT_TRUE((solution.array() > -kPi).all() && (solution.array() <= kPi).all())
          << solution.transpose();
      tally.worst = std::max(
          tally.worst, pose_distance(chain.tool(with_joint(solution, lock, whole[lock])), tool));
      nearest = std::min(nearest, turn_distance(solution, q));
    }
    if (singular) {
      tally.unsolved += solutions.count == 0;
    } else if (nearest < 1e-5) {
      ++tally.found;
      tally.farthest = std::max(tally.farthest, nearest);
    } else {
      tally.missed_at = std::max(tally.missed_at, determinant);
    }
  }
  return tally;
}

std::vector<ArmTable> all_arms() {
  std::vector<ArmTable> arms = arms_7r();
  for (const ArmTable& arm : arms_6r()) arms.push_back(arm);
  return arms;
}

class ClosedFormOf : public testing::TestWithParam<int> {};

TEST_P(ClosedFormOf, FindsEveryConfigurationAgain) {
  const ArmTable arm = all_arms()[static_cast<std::size_t>(GetParam())];
  const Chain chain = chain_of(arm);
  const LockMethod method = lock_method(chain);
  std::printf("%s: %s\n", arm.name.c_str(), method.words().c_str());
  ASSERT_GE(method.best, 0);
  Random random(seed(arm.name.c_str()));
  const int count = trials(10000);
  // Where the axes miss each other by more than 0.01 mm, a few configurations beside folds are
  // lost, but none that is regular.
  const FitDeviation& deviation = method.by_joint[static_cast<std::size_t>(method.best)]->deviation;
  const bool near = deviation.offset > 1e-5 || deviation.angle > 1e-5;
  for (const Draw kind : {Draw::kLimits, Draw::kTurns, Draw::kSquare}) {
    const Tally tally = round_trip(chain, method.best, kind, count, random);
    const int missed = tally.tried - tally.found - tally.singular;
    std::printf(
        "  %s: tried %d, found %d, singular %d (unsolved %d), missed %d (|det| to %.1e), solutions "
        "%.2f (most %d), residual %.1e, "
        "own "
        "within %.1e\n",
        kind == Draw::kLimits  ? "limits"
        : kind == Draw::kTurns ? "turns "
                               : "square",
        tally.tried, tally.found, tally.singular, tally.unsolved, missed, tally.missed_at,
        static_cast<double>(tally.solutions) / tally.tried, tally.most, tally.worst,
        tally.farthest);
    EXPECT_EQ(tally.tried, count);
    EXPECT_GT(tally.found, tally.tried / 2 - 100);
    EXPECT_LE(tally.missed_at, near ? 1e-4 : 0);
    EXPECT_LE(missed, near ? tally.tried / 1000 : 0);
    EXPECT_EQ(tally.unsolved, 0);
    EXPECT_LE(tally.worst, 1e-9);
  }
}
INSTANTIATE_TEST_SUITE_P(Arms, ClosedFormOf, testing::Range(0, static_cast<int>(all_arms().size())),
                         [](const auto& parameter) {
                           std::string name =
                               all_arms()[static_cast<std::size_t>(parameter.param)].name;
                           for (char& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

TEST(ClosedForm, LocksEveryJointItNames) {
  Random random(seed("ClosedForm.LocksEveryJointItNames"));
  int locks = 0;
  for (const ArmTable& arm : all_arms()) {
    const Chain chain = chain_of(arm);
    const LockMethod method = lock_method(chain);
    for (int lock = 0; lock < kDof; ++lock) {
      if (!method.by_joint[static_cast<std::size_t>(lock)] ||
          !method.by_joint[static_cast<std::size_t>(lock)]->exact)
        continue;
      ++locks;
      const Tally tally = round_trip(chain, lock, Draw::kTurns, trials(500), random);
      EXPECT_EQ(tally.found + tally.singular, tally.tried) << arm.name << " joint " << lock + 1;
      EXPECT_LT(tally.singular, tally.tried / 20) << arm.name << " joint " << lock + 1;
    }
  }
  EXPECT_GT(locks, 30);
}

TEST(ClosedForm, AgreesWithTheArmAngle) {
  const Chain chain = chain_of(arms_7r().back());
  const SrsArm srs = fit_srs(chain, "iiwa7");
  Random random(seed("ClosedForm.AgreesWithTheArmAngle"));
  int compared = 0;
  for (int trial = 0; trial < trials(1000); ++trial) {
    const Config q = draw(chain, Draw::kLimits, random);
    const Pose tool = chain.tool(q);
    const ArmPlane plane = first_plane(srs, tool);
    if (reach_status(srs, plane.reach) != ReachStatus::kReachable) continue;
    const auto circles = elbow_circles(srs, plane, tool);
    for (int branch = 0; branch < kBranches; ++branch) {
      const Config expected = srs_ik(srs, circles, plane.angle_of(srs.elbow_axis(q)), branch);
      const SixChain six = lock_joint(chain, 2, expected[2]);
      const Config6 rest = without_joint(expected, 2);
      if (std::abs(six.jacobian(rest).determinant()) < 1e-7) continue;
      const auto solutions = ClosedForm::of(six)->solve(tool);
      ++compared;
      EXPECT_TRUE(std::any_of(solutions.begin(), solutions.end(),
                              [&](const Config6& x) { return turn_distance(x, rest) < 1e-6; }));
    }
  }
  EXPECT_GT(compared, 7 * trials(1000));
}

TEST(ClosedForm, SaysWhatItLocks) {
  const auto arms = all_arms();
  const auto words = [&](const char* name) {
    for (const ArmTable& arm : arms)
      if (arm.name == name) return lock_method(chain_of(arm)).words();
    return std::string();
  };
  EXPECT_EQ(words("panda"),
            "closed form: axes 1, 2 and 3 meet in a point; locks joint 5 (or 4, 6, 7)");
  EXPECT_EQ(words("fetch"),
            "closed form: axes 5, 6 and 7 meet in a point; locks joint 3 (or 1, 2, 4)");
  EXPECT_EQ(
      words("gen3"),
      "closed form: axes 5, 6 and 7 meet in a point within 0.18 mm; locks joint 3 (or 1, 2, 4)");
  EXPECT_EQ(words("ur10e-like"),
            "closed form: axes 2, 3 and 4 are parallel; locks joint 7 (or 5, 6)");
  // An arm like Sawyer: every triple is 1 cm and more from a point.
  ArmTable none = arms_7r()[0];
  for (JointRow& joint : none.joints) joint.xyz += Vector3d(0.02, 0.03, 0.05);
  EXPECT_EQ(lock_method(chain_of(none)).best, -1);
  EXPECT_EQ(lock_method(chain_of(none)).words(),
            "no closed form: no three neighbouring axes meet in a point or are parallel where one "
            "joint is locked");
}

TEST(ClosedForm, OutOfReachHasNoSolution) {
  for (const ArmTable& arm : all_arms()) {
    const Chain chain = chain_of(arm);
    const auto form = ClosedForm::of(lock_joint(chain, lock_method(chain).best, 0.3));
    ASSERT_TRUE(form);
    Pose far = chain.tool(Config::Constant(0.3));
    far.translation() += Vector3d(5, 0, 0);
    EXPECT_EQ(form->solve(far).count, 0) << arm.name;
  }
}

/// Roots with sign changes of a fine sampling between them, by chance also near double ones.
TEST(Trigonometric, FindsTheRootsOfAWave) {
  Random random(seed("Trigonometric.FindsTheRootsOfAWave"));
  int changes = 0, doubles = 0;
  for (int trial = 0; trial < trials(2000); ++trial) {
    const auto coefficient = [&] {
      return random.uniform(-1, 1) * std::pow(10.0, random.uniform(-3, 0));
    };
    Wave2 wave{coefficient(), coefficient(), coefficient(), coefficient(), coefficient()};
    const auto value = [&](double x) {
      return wave.constant + wave.cosine * std::cos(x) + wave.sine * std::sin(x) +
             wave.cosine2 * std::cos(2 * x) + wave.sine2 * std::sin(2 * x);
    };
    if (trial % 4 == 0) {  // the least value becomes a double root
      double least = 0;
      for (int k = 1; k < 1000; ++k)
        least = value(kTwoPi * k / 1000) < value(least) ? kTwoPi * k / 1000 : least;
      for (int step = 0; step < 50; ++step) {
        const double h = 1e-4, slope = (value(least + h) - value(least - h)) / (2 * h),
                     curve = (value(least + h) - 2 * value(least) + value(least - h)) / (h * h);
        if (curve > 0) least -= slope / curve;
      }
      wave.constant -= value(least);
      const Roots found = roots(wave, 1e-6);
      EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const Angle& x) {
        return std::abs(std::remainder(x.radians() - least, kTwoPi)) < 1e-3;
      }));
      ++doubles;
      continue;
    }
    const Roots found = roots(wave, 0);
    for (int k = 0; k < found.count; ++k) {
      EXPECT_LT(std::abs(value(found.angle[static_cast<std::size_t>(k)].radians())), 1e-12);
      EXPECT_LE(found.angle[static_cast<std::size_t>(std::max(k, 1)) - 1].radians(),
                found.angle[static_cast<std::size_t>(k)].radians());
    }
    constexpr int kSteps = 1000;
    for (int k = 0; k < kSteps; ++k) {
      const double low = kTwoPi * k / kSteps, high = kTwoPi * (k + 1) / kSteps;
      if (std::signbit(value(low)) == std::signbit(value(high))) continue;
      ++changes;
      EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const Angle& x) {
        const double past = std::remainder(x.radians() - low, kTwoPi);
        return past >= -1e-9 && past <= high - low + 1e-9;
      }));
    }
  }
  EXPECT_GT(changes, trials(2000));
  EXPECT_GT(doubles, trials(2000) / 8);
}

}  // namespace
}  // namespace swivel
