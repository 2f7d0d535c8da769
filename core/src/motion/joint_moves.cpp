// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/motion/joint_moves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swivel {

namespace {

/// A motion along [0, 1] from rest to rest within a speed, an acceleration and a jerk, in the least
/// time.
class DoubleS {
 public:
  DoubleS(double speed, double acceleration, double jerk) : jerk_(jerk) {
    // reached within half the way, or else lower ones
    const double ramp_jerk =
        speed * jerk < acceleration * acceleration ? std::sqrt(speed / jerk) : acceleration / jerk;
    const double ramp = ramp_jerk + speed / (jerk * ramp_jerk);
    if (ramp * speed <= 1) {
      jerk_time_ = ramp_jerk;
      ramp_ = ramp;
      cruise_ = 1 / speed - ramp;
    } else if (const double most = acceleration / jerk; 2 * jerk * most * most * most <= 1) {
      jerk_time_ = most;
      ramp_ = most / 2 + std::sqrt(most * most / 4 + 1 / acceleration);
    } else {
      jerk_time_ = std::cbrt(1 / (2 * jerk));
      ramp_ = 2 * jerk_time_;
    }
    speed_ = jerk_ * jerk_time_ * (ramp_ - jerk_time_);
  }

  [[nodiscard]] double duration() const { return 2 * ramp_ + cruise_; }
  struct State {
    double x = 0, v = 0, a = 0;
  };
  [[nodiscard]] State at(double t) const {
    if (t <= duration() / 2) return before_middle(t);
    const State mirrored = before_middle(duration() - t);
    return {1 - mirrored.x, mirrored.v, -mirrored.a};
  }

 private:
  [[nodiscard]] State before_middle(double t) const {
    const double j = jerk_, tj = jerk_time_;
    if (t <= 0) return {};
    if (t < tj) return {j * t * t * t / 6, j * t * t / 2, j * t};
    if (t < ramp_ - tj)
      return {j * tj * (3 * t * t - 3 * tj * t + tj * tj) / 6, j * tj * (t - tj / 2), j * tj};
    const double left = ramp_ - t, middle = speed_ * ramp_ / 2;
    if (left > 0)
      return {middle - speed_ * left + j * left * left * left / 6, speed_ - j * left * left / 2,
              j * left};
    return {middle - speed_ * left, speed_, 0};
  }
  double jerk_, jerk_time_ = 0, ramp_ = 0, cruise_ = 0, speed_ = 0;
};

}  // namespace

std::vector<TimedRow> time_joint_moves(const std::vector<Config>& corners, const JointRates& rates,
                                       double rapid, double rate) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  // room for the rounding of samples to doubles, whose third differences it would spoil
  constexpr double kUse = 1 - 1e-4;
  std::vector<TimedRow> rows(1);
  rows[0].row.q = corners.front();
  for (std::size_t k = 1; k < corners.size(); ++k) {
    const Config move = corners[k] - corners[k - 1];
    double speed = kInfinity, acceleration = kInfinity, jerk = kInfinity;
    for (Eigen::Index j = 0; j < kDof; ++j) {
      const double way = std::abs(move[j]);
      if (way == 0) continue;
      speed = std::min(speed, rapid * rates.speed[j] / way);
      acceleration = std::min(acceleration, rates.acceleration[j] / way);
      jerk = std::min(jerk, rates.jerk[j] / way);
    }
    const double start = rows.back().t;
    const auto first = std::llround(start * rate);
    if (jerk == kInfinity) {  // nothing moves but what has no rates
      rows.back().row.q = corners[k];
      continue;
    }
    const DoubleS profile(kUse * speed, kUse * acceleration, kUse * jerk);
    const auto samples = static_cast<std::int64_t>(std::ceil(profile.duration() * rate));
    const double stretch = profile.duration() * rate / static_cast<double>(samples);
    for (std::int64_t n = 1; n <= samples; ++n) {
      const DoubleS::State at = profile.at(stretch * static_cast<double>(n) / rate);
      TimedRow row;
      row.t = static_cast<double>(first + n) / rate;
      row.row.q = n == samples ? corners[k] : Config(corners[k - 1] + at.x * move);
      row.v = n == samples ? Config::Zero() : Config(at.v * stretch * move);
      row.a = n == samples ? Config::Zero() : Config(at.a * stretch * stretch * move);
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace swivel
