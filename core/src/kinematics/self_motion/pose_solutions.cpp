// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/self_motion/pose_solutions.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kinematics/self_motion/self_motion_arcs.hpp"
#include "swivel/core/base/angle.hpp"

namespace swivel {

namespace {

constexpr int kRoll = kDof - 1;

/// Returns the chain with a roll that is free and joints without limits.
Chain unlimited(Chain chain) {
  chain.roll_fixed = false;
  for (JointLimit& limit : chain.limit) limit.continuous = true;
  return chain;
}

/// Adds a configuration unless one that is equal to it, but for whole turns, is there.
void add_distinct(const Config& q, std::vector<Config>& all) {
  constexpr double kSame = 1e-7;  // rad
  const auto equal = [&](const Config& other) {
    for (int j = 0; j < kRoll; ++j)
      if (std::abs(wrap_angle(q[j] - other[j])) > kSame) return false;
    return true;
  };
  if (std::none_of(all.begin(), all.end(), equal)) all.push_back(q);
}

/// Adds the points of a curve at which the roll is 0. Between samples of a chord its sign tells; a
/// curve that touches 0 is met from where it comes nearest.
void add_unturned(const SelfMotion& motion, const Pose& tool, const SelfMotionArc& curve,
                  std::vector<Config>& all) {
  constexpr int kParts = 4;         // of a chord
  constexpr double kTouches = 0.3;  // rad: roll from which Newton is tried
  constexpr double kOpposite = 2;   // rad: rolls this far from 0 change their sign at half a turn
  std::vector<Config> samples;
  for (int chord = 0; chord < curve.chords(); ++chord)
    for (int part = 0; part < kParts; ++part)
      samples.push_back(curve.at(chord, static_cast<double>(part) / kParts));
  if (!curve.closed) samples.push_back(curve.q.back());
  const std::size_t n = samples.size();
  const auto roll = [&](std::size_t k) { return wrap_angle(samples[k % n][kRoll]); };
  const auto add = [&](const Config& from) {
    Config start = from;
    start[kRoll] = 0;
    if (const auto q = motion.with_joint_at(start, tool, kRoll, 0)) add_distinct(*q, all);
  };
  for (std::size_t k = 0; k + (curve.closed ? 0 : 1) < n; ++k) {
    const double a = roll(k), b = roll(k + 1);
    if (std::abs(a) > kOpposite || std::abs(b) > kOpposite) continue;
    if ((a <= 0) != (b <= 0)) {
      Config between = samples[k];
      for (int j = 0; j < kDof; ++j)
        between[j] += a / (a - b) * wrap_angle(samples[(k + 1) % n][j] - samples[k][j]);
      add(between);
    } else if (curve.closed || k > 0) {
      const double before = std::abs(roll(k + n - 1));
      if (std::abs(a) <= std::min(before, std::abs(b)) && std::abs(a) < kTouches) add(samples[k]);
    }
  }
}

}  // namespace

PoseSolutions::PoseSolutions(const Chain& chain, const LockMethod& method) {
  if (method.best == kRoll) {
    closed_form_ = ClosedForm::of(lock_joint(chain, kRoll, 0));
    return;
  }
  const Chain turning = unlimited(chain);
  turning_ = std::make_unique<const SelfMotion>(turning, lock_method(turning), 0);
}

std::vector<Config> PoseSolutions::at(const Pose& tool) const {
  std::vector<Config> all;
  if (closed_form_)
    for (const Config6& q : closed_form_->solve(tool)) all.push_back(with_joint(q, kRoll, 0));
  else
    for (const SelfMotionArc& curve : turning_->curves(tool))
      add_unturned(*turning_, tool, curve, all);
  std::sort(all.begin(), all.end(), less);
  return all;
}

}  // namespace swivel
