// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/closed_form/arm_class.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

namespace {

/// Returns how far six joints are from being singular in every posture: the mean of the absolute
/// determinant of their Jacobian over the cube of the arm's length. That of common arms is 0.002 to
/// 0.02; that of an arm of seven whose elbow is held is 0, or 2e-4 where its axes miss each other
/// by some cm.
double mean_determinant(const Chain& chain) {
  constexpr int kSamples = 64;
  constexpr std::array<double, kSix> kPrime = {2, 3, 5, 7, 11, 13};
  double sum = 0, length = 0;
  for (int sample = 1; sample <= kSamples; ++sample) {
    Config q;
    for (int j = 0; j < kSix; ++j) {  // Kronecker points: multiples of square roots
      const double turns = sample * std::sqrt(kPrime[static_cast<std::size_t>(j)]);
      q[j] = kTwoPi * (turns - std::floor(turns));
    }
    sum += std::abs(chain.jacobian(q).leftCols<kSix>().determinant());
    length = std::max(length, (chain.tool(q).translation() - chain.point[0]).norm());
  }
  return length > 0 ? sum / kSamples / (length * length * length) : 0;
}

}  // namespace

ArmClass classify(const Chain& chain, const std::string& source) {
  ArmClass result;
  const auto other = [&](const std::string& why) {
    result.not_srs = why;
    result.lock = lock_method(chain);
    if (result.lock.best >= 0) result.kind = ArmKind::kArcs;
  };
  if (const int slide = chain.slide(); slide >= 0) {
    const std::string& name = chain.joint_names[static_cast<std::size_t>(slide)];
    if (chain.free_roll)
      throw InputError(source, "path.roll: joint '" + name +
                                   "' is prismatic: allowed where the arm's joints turn: hold it "
                                   "by robot.hold");
    other("joint '" + name + "' slides");
    return result;
  }
  if (chain.roll) {
    other(chain.roll_fixed ? "six joints" : "six joints and the roll of the tool");
    result.redundant = !chain.roll_fixed;
    if (!chain.roll_fixed) return result;
    constexpr double kNone = 1e-7, kLittle = 1e-3;  // of mean_determinant()
    const double determinant = mean_determinant(chain);
    if (determinant < kNone)
      throw InputError(source,
                       "the arm's six joints are singular in every posture, as those of an arm of "
                       "seven are whose elbow is held: allowed is another joint in robot.hold");
    if (determinant < kLittle) {  // the closed form is for solutions that lie apart
      result.lock = LockMethod();
      result.lock.roll = result.lock.roll_fixed = true;
      result.kind = ArmKind::kSampled;
    }
    return result;
  }
  try {
    result.srs = fit_srs(chain, source);
    result.kind = ArmKind::kSrs;
  } catch (const NotSrs& error) {
    if (chain.free_roll) {
      const int lock = lock_method(chain).best;
      throw InputError(
          source,
          "path.roll: of arms of seven joints allowed for those with spherical shoulder and "
          "wrist; here " +
              error.why() +
              (lock < 0 ? std::string()
                        : ": robot.hold: {" + chain.joint_names[static_cast<std::size_t>(lock)] +
                              ": POSITION} makes it an arm of six"));
    }
    other(error.why());
  }
  return result;
}

std::string ArmClass::method() const {
  switch (kind) {
    case ArmKind::kSrs:
      return srs->exact ? "closed form: spherical shoulder and wrist; arm angle"
                        : "closed form of the nearest arm with spherical shoulder and wrist, "
                          "polished; arm angle";
    case ArmKind::kArcs:
      return lock.words() + (redundant ? "; arcs of self-motion" : "; its solutions");
    case ArmKind::kSampled:
      break;
  }
  return lock.words() + (redundant ? "" : "; solutions that a search finds");
}

}  // namespace swivel
