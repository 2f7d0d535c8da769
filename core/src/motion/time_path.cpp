// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/motion/time_path.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

bool roll_allowed(const Chain& chain, const ToolPath& path, double travel,
                  const TrajectoryRow& row) {
  if (!chain.tool_may_turn()) return true;
  // rad; check allows a little more
  const double roll = roll_of(chain, row), slack = std::max(0.9 * path.rounding(), 5e-7);
  const auto within = [&](const Roll& range) {
    return roll >= range.lower - slack && roll <= range.upper + slack;
  };
  return within(path.window_at(travel)) &&
         (!chain.free_roll || chain.free_roll->circle() || within(*chain.free_roll));
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// part of the rates, by the analytic estimate; the rest is for interpolation
constexpr double kTarget = 0.99;

double angle_between(const Pose& a, const Pose& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

/// Returns the weights of values at five places for the value and first three derivatives at x.
/// Source: Fornberg 1988.
Eigen::Matrix<double, 5, 4> derivative_weights(const double* places, double x) {
  Eigen::Matrix<double, 5, 4> c = Eigen::Matrix<double, 5, 4>::Zero();
  double c1 = 1, c4 = places[0] - x;
  c(0, 0) = 1;
  for (int i = 1; i < 5; ++i) {
    const int orders = std::min(i, 3);
    double c2 = 1;
    const double c5 = c4;
    c4 = places[i] - x;
    for (int j = 0; j < i; ++j) {
      const double c3 = places[i] - places[j];
      c2 *= c3;
      if (j == i - 1) {
        for (int k = orders; k >= 1; --k)
          c(i, k) = c1 * (k * c(i - 1, k - 1) - c5 * c(i - 1, k)) / c2;
        c(i, 0) = -c1 * c5 * c(i - 1, 0) / c2;
      }
      for (int k = orders; k >= 1; --k) c(j, k) = (c4 * c(j, k) - k * c(j, k - 1)) / c3;
      c(j, 0) = c4 * c(j, 0) / c3;
    }
    c1 = c2;
  }
  return c;
}

/// A motion's geometry at one place of its travel: derivatives of the joints by the travel, and the
/// tool's speeds per metre of it.
struct PathSample {
  double x = 0;  // m of travel
  double s = 0;  // m along the path
  Config q, first, second, third;
  double along = 0, turning = 0;  // m/m and rad/m
  // 1/m: over a straight move of the joints the tool strays by this times the square of the travel.
  double chord = 0;
};

/// The least and the largest speed of the tool that is asked for on a stretch of the path, m/s.
struct AskedSpeeds {
  double least = 0, most = 0;
};
/// Returns the speeds asked for from s = `from` to s = `to`, m, the ends included.
AskedSpeeds speeds_between(const TimingOptions& options, double from, double to) {
  constexpr double kSame = 1e-9;  // m
  AskedSpeeds found{kInfinity, 0};
  double speed = options.speed, since = -kInfinity;
  for (std::size_t k = 0; k <= options.speeds.size(); ++k) {
    const bool last = k == options.speeds.size();
    const double until = last ? kInfinity : options.speeds[k].s;
    if (since <= to + kSame && until >= from - kSame)
      found = {std::min(found.least, speed), std::max(found.most, speed)};
    if (!last) speed = options.speeds[k].speed, since = until;
  }
  return found;
}

/// The joint and rate that slow a place down.
struct SpeedLimiter {
  int joint = -1;  // -1: the speed asked for
  JointRate rate = JointRate::kSpeed;
};

/// The motion from one rest to the next: its place and speed at each time.
class RestToRest {
 public:
  RestToRest(const JointRates& rates, const TimingOptions& options, std::vector<PathSample> places)
      : rates_(&rates), places_(std::move(places)), n_(places_.size()) {
    asked_.resize(n_);
    speed_cap_.resize(n_);
    acceleration_cap_.resize(n_);
    limiter_.resize(n_);
    speed_scale_.assign(n_, 1);
    acceleration_scale_.assign(n_, 1);
    speed_.assign(n_, 0);
    const auto r = [](double limit, double value) { return value > 0 ? limit / value : kInfinity; };
    filter_ = 0;
    for (int j = 0; j < kDof; ++j)
      if (std::isfinite(rates.acceleration[j]))
        filter_ = std::max(filter_, kShare * rates.acceleration[j] / rates.jerk[j]);
    filter_ = std::max(filter_, 1e-4);
    for (std::size_t k = 0; k < n_; ++k) {
      const PathSample& place = places_[k];
      asked_[k] = r(speeds_between(options, place.s, place.s).least,
                    place.along > kStill ? place.along : 0);
      if (options.turn_speed)
        asked_[k] = std::min(asked_[k], r(*options.turn_speed, place.turning));
      if (options.chord)
        asked_[k] =
            std::min(asked_[k], options.rate * std::sqrt(kTarget * r(*options.chord, place.chord)));
      speed_cap_[k] = asked_[k];
      acceleration_cap_[k] = kInfinity;
      double joint_speed = kInfinity;
      for (int j = 0; j < kDof; ++j) {
        joint_speed = std::min(joint_speed, r(rates.speed[j], std::abs(place.first[j])));
        lower(k, kTarget * r(rates.speed[j], std::abs(place.first[j])), {j, JointRate::kSpeed});
        lower(k, std::sqrt(kTarget * r(rates.acceleration[j], std::abs(place.second[j]))),
              {j, JointRate::kAcceleration});
        lower(k, std::cbrt(kTarget * r(rates.jerk[j], std::abs(place.third[j]))),
              {j, JointRate::kJerk});
        acceleration_cap_[k] = std::min(
            acceleration_cap_[k], kShare * r(rates.acceleration[j], std::abs(place.first[j])));
      }
      if (!std::isfinite(asked_[k])) asked_[k] = joint_speed;
      // Nothing moves: any speed serves.
      const double any = places_.back().x - places_.front().x;
      if (!std::isfinite(asked_[k])) asked_[k] = any;
      if (!std::isfinite(speed_cap_[k])) speed_cap_[k] = any;
      if (!std::isfinite(acceleration_cap_[k])) acceleration_cap_[k] = 1e3 * any;
    }
  }

  [[nodiscard]] double duration() const { return stretch_ * (end_ + filter_); }
  /// Returns the time at the speed asked for throughout, s.
  [[nodiscard]] double ideal() const {
    double time = 0;
    for (std::size_t k = 1; k < n_; ++k)
      time += (places_[k].x - places_[k - 1].x) * 0.5 * (1 / asked_[k] + 1 / asked_[k - 1]);
    return time;
  }

  /// Travel and its first three derivatives by time.
  struct State {
    double x = 0, speed = 0, acceleration = 0, jerk = 0;
    double from = 0, to = 0;  // travel of the unfiltered motion, half a window before and after
  };
  /// Evaluates a piece at times, cheaply for times that ascend.
  class Walk {
   public:
    explicit Walk(const RestToRest& piece) : piece_(&piece) {}
    State at(double t) {
      const RestToRest& p = *piece_;
      t = t / p.stretch_ - p.filter_ / 2;
      const Raw a = p.raw(t - p.filter_ / 2, before_), b = p.raw(t + p.filter_ / 2, after_);
      const double w = p.filter_, z = 1 / p.stretch_;
      return {std::clamp((b.area - a.area) / w, p.places_.front().x, p.places_.back().x),
              (b.x - a.x) / w * z,
              (b.speed - a.speed) / w * z * z,
              (b.acceleration - a.acceleration) / w * z * z * z,
              a.x,
              b.x};
    }

   private:
    const RestToRest* piece_;
    std::size_t before_ = 0, after_ = 0;
  };

  struct Derivatives {
    Config first, second, third;
    double along = 0, turning = 0, asked = 0;
    std::size_t node = 0;
  };
  /// Returns derivatives by the travel, linear between places. `node` is a hint for the place, and
  /// is set to it.
  [[nodiscard]] Derivatives derivatives(double x, std::size_t& node) const {
    seek(x, node);
    const PathSample &a = places_[node], &b = places_[node + 1];
    const double u = std::clamp((x - a.x) / (b.x - a.x), 0.0, 1.0), v = 1 - u;
    return {v * a.first + u * b.first,     v * a.second + u * b.second,
            v * a.third + u * b.third,     v * a.along + u * b.along,
            v * a.turning + u * b.turning, v * asked_[node] + u * asked_[node + 1],
            u < 0.5 ? node : node + 1};
  }

  /// Plans the speeds, verifies them and slows down where a joint is too fast, until none is.
  /// Returns the rounds.
  int plan(const Budget& budget) {
    constexpr int kRounds = 60;
    for (int round = 1;; ++round) {
      budget.poll();
      profile();
      const double worst = verify(round > kRounds / 3, round < kRounds);
      if (worst <= 1) return round;
      if (round == kRounds) {
        stretch(worst);
        return round;
      }
    }
  }
  /// Speeds up the motion after plan(), where the joints have room left: places are passed faster
  /// and accelerations along the path rise, as long as that gains time. Slowing down costs
  /// acceleration and jerk of its own, and the first answer pays for it with more slowing down than
  /// is needed. Returns the rounds.
  int speed_up(const Budget& budget) {
    // of the time at the speed asked for; of the room
    constexpr double kNearIdeal = 1.02, kUse = 0.99;
    constexpr double kFaster = 1.02, kHarder = 1.15;  // most that a round changes
    // times what one joint's acceleration allows: another bend may help
    constexpr double kHardest = 3;
    constexpr double kLittle = 3e-4;  // of the time
    // rounds in all; attempts to keep the rates again
    constexpr int kRounds = 12, kRepairs = 6;
    constexpr int kFew = 2;  // gains that are next to nothing
    int rounds = 0, few = 0;
    std::vector<double> slower = speed_scale_, acceleration_scale = acceleration_scale_;
    double least = end_;
    while (duration() > kNearIdeal * ideal() && rounds < kRounds && few < kFew) {
      for (std::size_t k = 0; k < n_; ++k) {
        speed_scale_[k] =
            std::min(1.0, speed_scale_[k] * std::clamp(std::cbrt(kUse / used_[k]), 1.0, kFaster));
        acceleration_scale_[k] =
            std::min(std::max(acceleration_scale_[k], kHardest),
                     acceleration_scale_[k] * std::clamp(kUse / used_[k], 1.0, kHarder));
      }
      bool kept = false;
      for (int repair = 0; repair < kRepairs && !kept; ++repair) {
        ++rounds;
        budget.poll();
        profile();
        kept = verify(false, true) <= 1;
      }
      if (!kept) break;
      few = end_ < (1 - kLittle) * least ? 0 : few + 1;
      if (end_ >= least) continue;
      least = end_;
      slower = speed_scale_;
      acceleration_scale = acceleration_scale_;
    }
    if (rounds == 0) return 0;
    speed_scale_ = std::move(slower);
    acceleration_scale_ = std::move(acceleration_scale);
    profile();
    return rounds;
  }

  /// Slows down the whole piece by a factor.
  void stretch(double factor) { stretch_ *= factor; }
  /// Slows down by factors of speeds and of accelerations along the path, one for each place;
  /// plan() must follow.
  void slow_down(const std::vector<double>& slower, const std::vector<double>& acceleration_scale) {
    for (std::size_t k = 0; k < n_; ++k)
      speed_scale_[k] *= slower[k], acceleration_scale_[k] *= acceleration_scale[k];
  }
  [[nodiscard]] const SpeedLimiter& limiter(std::size_t node) const { return limiter_[node]; }
  [[nodiscard]] const std::vector<PathSample>& places() const { return places_; }

 private:
  // part of a joint's acceleration for speeding up and slowing down
  static constexpr double kShare = 0.9;
  static constexpr double kNothing = 1e-3;  // of the rates
  static constexpr double kStill = 1e-9;    // m/m: the path only turns
  struct Raw {
    double area = 0, x = 0, speed = 0, acceleration = 0;
  };

  void lower(std::size_t k, double to, const SpeedLimiter& limiter) {
    if (to >= speed_cap_[k]) return;
    speed_cap_[k] = to;
    limiter_[k] = limiter;
  }

  void seek(double x, std::size_t& node) const {
    if (node + 2 > n_ || places_[node].x > x) node = 0;
    while (node + 2 < n_ && places_[node + 1].x <= x) ++node;
  }

  /// Computes the unfiltered speeds: the caps, each kept for as long before and after as the filter
  /// looks, within what accelerations allow.
  void profile() {
    std::vector<double> cap(n_);
    for (std::size_t k = 0; k < n_; ++k) cap[k] = speed_cap_[k] * speed_scale_[k];
    speed_ = cap;
    for (std::size_t k = 0; k < n_; ++k) {
      const double reach = cap[k] * filter_ / 2;
      for (std::size_t i = k; i-- > 0 && places_[k].x - places_[i].x <= reach && cap[i] >= cap[k];)
        speed_[i] = std::min(speed_[i], cap[k]);
      for (std::size_t i = k + 1;
           i < n_ && places_[i].x - places_[k].x <= reach && cap[i] >= cap[k]; ++i)
        speed_[i] = std::min(speed_[i], cap[k]);
    }
    speed_.front() = speed_.back() = 0;
    const auto bound = [&](std::size_t from, std::size_t to) {
      const double acceleration_cap = std::min(acceleration_cap_[from] * acceleration_scale_[from],
                                               acceleration_cap_[to] * acceleration_scale_[to]);
      speed_[to] = std::min(
          speed_[to], std::sqrt(speed_[from] * speed_[from] +
                                2 * acceleration_cap * std::abs(places_[to].x - places_[from].x)));
    };
    for (std::size_t k = 1; k < n_; ++k) bound(k - 1, k);
    for (std::size_t k = n_ - 1; k-- > 0;) bound(k + 1, k);
    time_.assign(n_, 0);
    area_.assign(n_, 0);
    for (std::size_t k = 1; k < n_; ++k) {
      const double h = places_[k].x - places_[k - 1].x, dt = 2 * h / (speed_[k - 1] + speed_[k]);
      const double a = (speed_[k] - speed_[k - 1]) / dt;
      time_[k] = time_[k - 1] + dt;
      area_[k] = area_[k - 1] + dt * (places_[k - 1].x + dt * (speed_[k - 1] / 2 + dt * a / 6));
    }
    end_ = time_.back();
  }

  /// Returns the unfiltered motion at a time, and the integral of its travel over time.
  [[nodiscard]] Raw raw(double t, std::size_t& node) const {
    if (t <= 0) return {t * places_.front().x, places_.front().x, 0, 0};
    if (t >= end_) return {area_.back() + (t - end_) * places_.back().x, places_.back().x, 0, 0};
    if (node + 2 > n_ || time_[node] > t) node = 0;
    while (node + 2 < n_ && time_[node + 1] <= t) ++node;
    const double u = t - time_[node],
                 a = (speed_[node + 1] - speed_[node]) / (time_[node + 1] - time_[node]);
    const double x = places_[node].x, v = speed_[node];
    return {area_[node] + u * (x + u * (v / 2 + u * a / 6)), x + u * (v + u * a / 2), v + u * a, a};
  }

  /// Returns the factor by which the motion as a whole would have to be slower. Where a joint
  /// exceeds its rates and `may_slow_down`, what lies within the filter's window is slowed down:
  /// accelerations along the path, to what the path's own bends leave; where these take nearly all,
  /// the speed as well. With `both`, for motions that take too many rounds, both by the whole
  /// excess.
  double verify(bool both, bool may_slow_down) {
    constexpr double kLeast = 0.5, kPath = 0.9;  // kPath: share of a rate that bends may take
    std::vector<double> slower(n_, 1), acceleration_scale(n_, 1);
    used_.assign(n_, kNothing);
    double worst = 1;
    const double step = std::min(1e-3, filter_ / 8);
    Walk walk(*this);
    std::size_t node = 0, low = 0, high = 0;
    const auto steps = static_cast<long long>(std::ceil((end_ + filter_) / step));
    for (long long i = 0; i <= steps; ++i) {
      const State at = walk.at(static_cast<double>(i) * step * stretch_);
      const Derivatives d = derivatives(at.x, node);
      const double v = at.speed, a = at.acceleration, jerk = at.jerk;
      double path = 1, along = 1;  // factors of speed and of acceleration along the path
      double used = kNothing;
      for (int j = 0; j < kDof; ++j) {
        const double speed = d.first[j] * v, bend = d.second[j] * v * v,
                     third = d.third[j] * v * v * v;
        const double limit[3] = {rates_->speed[j], rates_->acceleration[j], rates_->jerk[j]};
        const double all[3] = {speed, bend + d.first[j] * a,
                               third + 3 * d.second[j] * v * a + d.first[j] * jerk};
        const double of_path[3] = {speed, bend, third};  // at a steady speed
        for (int n = 0; n < 3; ++n) {
          const double ratio = std::abs(all[n]) / (kTarget * limit[n]),
                       share = std::abs(of_path[n]) / (kTarget * limit[n]);
          used = std::max(used, ratio);
          if (ratio <= 1) continue;
          const auto root = [n](double of) {
            return n == 0 ? of : n == 1 ? std::sqrt(of) : std::cbrt(of);
          };
          worst = std::max(worst, root(ratio));
          const bool of_speed = both || n == 0 || share > kPath;
          if (of_speed) {
            path = std::min(path, both || n == 0 ? 0.995 / root(ratio) : root(kPath / share));
            limiter_[d.node] = {j, static_cast<JointRate>(n)};
          }
          const double left = std::min(share, kPath);
          if (both)
            along = std::min(along, 0.98 / ratio);
          else if (n > 0)
            along = std::min(along, (0.98 - left) / (ratio - left));
        }
      }
      seek(at.from, low);
      seek(at.to, high);
      for (std::size_t k = low; k <= std::min(high + 1, n_ - 1); ++k)
        used_[k] = std::max(used_[k], used);
      if (path >= 1 && along >= 1) continue;
      for (std::size_t k = low > 0 ? low - 1 : 0; k <= std::min(high + 2, n_ - 1); ++k) {
        slower[k] = std::min(slower[k], std::max(kLeast, path));
        acceleration_scale[k] = std::min(acceleration_scale[k], std::max(kLeast, along));
      }
    }
    if (may_slow_down) slow_down(slower, acceleration_scale);
    return worst;
  }

  const JointRates* rates_;
  std::vector<PathSample> places_;
  std::size_t n_;
  std::vector<double> asked_;                             // speed of travel asked for, m/s
  std::vector<double> speed_cap_, acceleration_cap_;      // m/s and m/s^2: what the joints allow
  std::vector<double> speed_scale_, acceleration_scale_;  // factors of both, from verifying
  std::vector<SpeedLimiter> limiter_;
  std::vector<double> used_;  // largest part of its rates that a joint uses near each place
  // of the unfiltered motion: constant acceleration between places
  std::vector<double> speed_, time_, area_;
  double filter_ = 0, end_ = 0, stretch_ = 1;
};

/// Returns places from one rest to the next: at least four a step, eight on either side of a
/// rounded corner, and finer ones next to the rests, since a speed that rises from place to place
/// rises more slowly the farther the first one is.
std::vector<double> places_between(const PathMotion& motion, double from, double to) {
  const ToolPath& path = motion.path();
  std::vector<double> knots{from};  // of the arm angle
  for (const double x : motion.knots())
    if (x > from && x < to) knots.push_back(x);
  knots.push_back(to);
  std::vector<double> bends;
  for (const ToolPath::Corner& corner : path.corners()) {
    const double x = path.layer(corner.layer).travel;
    if (corner.reach > 0 && x > from && x < to)
      for (int k = -8; k <= 8; ++k) bends.push_back(x + k * corner.reach / 8);
  }
  std::vector<double> merged;
  std::merge(knots.begin(), knots.end(), bends.begin(), bends.end(), std::back_inserter(merged));
  double most = 0;
  for (std::size_t k = 1; k < knots.size(); ++k) most = std::max(most, knots[k] - knots[k - 1]);
  std::vector<double> places{from};
  const double least = 1e-3 * most / 4;  // nearer places spoil the differences
  for (const double x : merged) {
    const double h = x - places.back();
    if (h < least) continue;
    const int parts = std::max(1, static_cast<int>(std::ceil(4 * h / most - 1e-6)));
    const double begin = places.back();
    for (int k = 1; k <= parts; ++k) places.push_back(k == parts ? x : begin + k * h / parts);
  }
  places.back() = to;
  while (places.size() < 6) {  // five places are needed for a difference
    std::vector<double> finer{places[0]};
    for (std::size_t k = 1; k < places.size(); ++k) {
      finer.push_back((places[k - 1] + places[k]) / 2);
      finer.push_back(places[k]);
    }
    places.swap(finer);
  }
  constexpr int kHalvings = 5;
  const double first = places[1] - from, last = to - places[places.size() - 2];
  std::vector<double> graded{from};
  for (int k = kHalvings; k > 0; --k) graded.push_back(from + std::ldexp(first, -k));
  graded.insert(graded.end(), places.begin() + 1, places.end() - 1);
  for (int k = 1; k <= kHalvings; ++k) graded.push_back(to - std::ldexp(last, -k));
  graded.push_back(to);
  return graded;
}

/// Returns how far along its path, m, the tool is at a travel.
double s_at(const ToolPath& path, double travel) {
  const PathLayer& layer = path.layer(path.step_at(travel));
  const double way = path.layer(path.step_at(travel) + 1).travel - layer.travel;
  const double share = way > 0 ? std::clamp((travel - layer.travel) / way, 0.0, 1.0) : 0;
  return layer.s + share * layer.step_length;
}

/// Computes joints and tool at the places, and their derivatives by the travel. Returns where the
/// arm has no solution, none where it has one everywhere.
std::optional<NoMotion> survey(const PathMotion& motion, const std::vector<double>& xs, bool chords,
                               std::vector<PathSample>& places) {
  const std::size_t n = xs.size();
  places.resize(n);
  std::vector<Pose> tool(n);
  for (std::size_t k = 0; k < n; ++k) {
    places[k].x = xs[k];
    places[k].s = s_at(motion.path(), xs[k]);
    tool[k] = motion.path().at_travel(xs[k]);
    const auto q = motion.joints(xs[k]);
    if (!q) {
      const int i = motion.path().step_at(xs[k]);
      return NoMotion{motion.path().layer(i).s, "the arm has no solution between layers"};
    }
    places[k].q = *q;
  }
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t first = std::min(k > 2 ? k - 2 : 0, n - 5);
    const auto weights = derivative_weights(xs.data() + first, xs[k]);
    PathSample& place = places[k];
    place.first = place.second = place.third = Config::Zero();
    Vector3d along = Vector3d::Zero();
    for (std::size_t i = 0; i < 5; ++i) {
      const auto w = weights.row(static_cast<Eigen::Index>(i));
      place.first += w[1] * places[first + i].q;
      place.second += w[2] * places[first + i].q;
      place.third += w[3] * places[first + i].q;
      along += w[1] * tool[first + i].translation();
    }
    place.along = along.norm();
    const std::size_t a = k > 0 ? k - 1 : 0, b = std::min(k + 1, n - 1);
    place.turning = angle_between(tool[a], tool[b]) / (xs[b] - xs[a]);
    if (!chords) continue;
    // Half-way along a straight move over a travel of h the joints are off by q'' h^2 / 8. What is
    // along the path only shifts the time.
    const double least = 1e-4 / std::max(1.0, place.second.norm());
    const auto moved = [&](double by) -> Vector3d {
      return motion.chain().tool(place.q + by * place.second).translation();
    };
    Vector3d off = (moved(least) - moved(-least)) / (2 * least);
    if (place.along > 0) off -= off.dot(along) / along.squaredNorm() * along;
    place.chord = off.norm() / 8;
  }
  return std::nullopt;
}

/// The sampled motion, and its measures.
class Samples {
 public:
  Samples(const PathMotion& motion, const JointRates& rates, const TimingOptions& options,
          std::vector<RestToRest>& pieces, const Budget& budget)
      : motion_(&motion),
        rates_(&rates),
        options_(&options),
        pieces_(&pieces),
        budget_(&budget),
        near_(1 / options.rate <= 4e-3 * (1 + 1e-9)) {
    for (const RestToRest& piece : pieces) for_tool_.emplace_back(piece.places().size(), 1);
  }

  std::optional<NoMotion> take(TimedPath& out) {
    out.rows.clear();
    travel_.clear();
    tool_.clear();
    asked_.clear();
    double before = 0;
    const double dt = 1 / options_->rate;
    long long k = 0;
    for (std::size_t p = 0; p < pieces_->size(); ++p) {
      const RestToRest& piece = (*pieces_)[p];
      RestToRest::Walk walk(piece), beside(piece);
      std::size_t node = 0;
      const bool last = p + 1 == pieces_->size();
      for (;; ++k) {
        const double t = static_cast<double>(k) * dt, here = t - before;
        const bool done = here >= piece.duration() - 1e-12;
        if (done && !last) break;
        if (k % 256 == 0) budget_->poll();
        const RestToRest::State at = walk.at(std::min(here, piece.duration()));
        const auto q = motion_->joints(at.x);
        if (!q)
          return NoMotion{motion_->row(at.x, Config::Zero()).s,
                          "the arm has no solution between layers"};
        const RestToRest::Derivatives d = piece.derivatives(at.x, node);
        TimedRow row;
        row.t = t;
        row.row = motion_->row(at.x, *q);
        if (!near_ && here > 0 && here < piece.duration() && !differ(piece, beside, here, row))
          return NoMotion{row.row.s, "the arm has no solution between layers"};
        if (!roll_allowed(motion_->chain(), motion_->path(), at.x, row.row))
          return NoMotion{row.row.s,
                          "the tool would turn further than its waypoints allow between layers"};
        out.rows.push_back(row);
        travel_.push_back(at.x);
        tool_.push_back(motion_->path().at_travel(at.x));
        const double share = at.speed / d.asked, slowed = slowed_for_tool(p, d.node);
        asked_.push_back({slowed < 1 ? std::min(1.0, share / slowed) : share, p, d.node});
        if (done) break;
      }
      before += piece.duration();
    }
    for (std::size_t i = 1; near_ && i + 1 < out.rows.size(); ++i) {
      const Config &q0 = out.rows[i - 1].row.q, &q1 = out.rows[i].row.q,
                   &q2 = out.rows[i + 1].row.q;
      out.rows[i].v = (q2 - q0) / (2 * dt);
      out.rows[i].a = ((q2 - q1) - (q1 - q0)) / (dt * dt);
    }
    out.duration = before;
    if (options_->chord) measure_between(out);
    return std::nullopt;
  }

  struct Excess {
    double by = 1;  ///< the factor by which the motion would have to be slower
    double s = 0;   ///< where, m along the path
  };
  Excess measure_peaks(TimedPath& out) const {
    const auto n = static_cast<long long>(out.rows.size());
    Excess worst;
    out.peaks = {};
    for (long long k = -1; k < n + 2; ++k)
      for (int order = 0; order < 3; ++order)
        for (int j = 0; j < kDof; ++j) {
          const double ratio = ratio_at(out, k, order, j);
          TimedPath::Peak& peak =
              out.peaks[static_cast<std::size_t>(order)][static_cast<std::size_t>(j)];
          if (ratio <= peak.ratio) continue;
          const TimedRow& row = out.rows[static_cast<std::size_t>(
              std::clamp(k - order / 2 - (order > 0 ? 1 : 0), 0LL, n - 1))];
          peak = {ratio, j, row.t, row.row.s};
          if (const double by = slower_by(ratio, order); by > worst.by) worst = {by, row.row.s};
        }
    for (std::size_t k = 0; k < out.rows.size(); ++k)
      if (const double by = std::max(slower_for_chord(k), slower_for_tool(k)); by > worst.by)
        worst = {by, out.rows[k].row.s};
    return worst;
  }

  /// Slows down where differences between samples exceed the rates, or the speeds asked of the
  /// tool: at corners they are larger than at the places.
  void slow_down(const TimedPath& out) {
    constexpr double kLeast = 0.5;
    // times the excess of the tool's speed: neighbouring places contribute
    constexpr double kTool = 1.2;
    const auto n = static_cast<long long>(out.rows.size());
    std::vector<std::vector<double>> slower, acceleration_scale;
    for (const RestToRest& piece : *pieces_)
      slower.emplace_back(piece.places().size(), 1), acceleration_scale.push_back(slower.back());
    std::vector<std::vector<double>> for_tool = slower;
    std::vector<bool> changed(pieces_->size(), false);
    for (long long k = -1; k < n + 2; ++k) {
      double speed = 1, acceleration_cap = 1, tool = 1;
      for (int order = 0; order < 3; ++order)
        for (int j = 0; j < kDof; ++j)
          if (const double ratio = ratio_at(out, k, order, j); ratio > 1) {
            speed = std::min(speed, std::max(kLeast, 0.995 / slower_by(ratio, order)));
            if (order > 0)
              acceleration_cap = std::min(acceleration_cap, std::max(kLeast, 0.98 / ratio));
          }
      if (const double by = slower_for_chord(static_cast<std::size_t>(std::clamp(k, 0LL, n - 1)));
          by > 1)
        speed = std::min(speed, std::max(kLeast, 0.995 / by));
      if (const double by = slower_for_tool(static_cast<std::size_t>(std::clamp(k, 0LL, n - 1)));
          by > 1)
        tool = std::max(kLeast, 1 / (1 + kTool * (by - 1)));
      speed = std::min(speed, tool);
      if (speed == 1) continue;
      const Asked &from = asked_[static_cast<std::size_t>(std::clamp(k - 3, 0LL, n - 1))],
                  &to = asked_[static_cast<std::size_t>(std::clamp(k, 0LL, n - 1))];
      for (const Asked* at : {&from, &to}) {
        auto &speeds = slower[at->piece], &pulls = acceleration_scale[at->piece];
        const std::size_t first = at->piece == from.piece ? from.node : 0,
                          last = at->piece == to.piece ? to.node : speeds.size() - 1;
        for (std::size_t place = first > 0 ? first - 1 : 0;
             place <= std::min(last + 1, speeds.size() - 1); ++place) {
          speeds[place] = std::min(speeds[place], speed);
          pulls[place] = std::min(pulls[place], acceleration_cap);
          for_tool[at->piece][place] = std::min(for_tool[at->piece][place], tool);
        }
        changed[at->piece] = true;
      }
    }
    for (std::size_t p = 0; p < pieces_->size(); ++p) {
      if (!changed[p]) continue;
      for (std::size_t k = 0; k < for_tool[p].size(); ++k) for_tool_[p][k] *= for_tool[p][k];
      (*pieces_)[p].slow_down(slower[p], acceleration_scale[p]);
      (*pieces_)[p].plan(*budget_);
    }
  }

  void measure_between(TimedPath& out) {
    const ToolPath& path = motion_->path();
    out.between_position = out.between_angle = 0;
    strayed_.assign(out.rows.size(), 0);
    for (std::size_t k = 1; k < out.rows.size(); ++k) {
      const double middle = (travel_[k - 1] + travel_[k]) / 2, h = travel_[k] - travel_[k - 1];
      if (h <= 0) continue;
      const Pose tool = motion_->chain().tool((out.rows[k - 1].row.q + out.rows[k].row.q) / 2);
      const Pose there = path.at_travel(middle);
      Vector3d off = tool.translation() - there.translation();
      // The part along the path only shifts the time.
      const Vector3d way = tool_[k].translation() - tool_[k - 1].translation();
      if (way.norm() > 1e-12) off -= off.dot(way) / way.squaredNorm() * way;
      strayed_[k] = off.norm();
      out.between_position = std::max(out.between_position, strayed_[k]);
      out.between_angle = std::max(out.between_angle, angle_between(tool, there));
    }
  }

  /// Finds the stretches below 99.5 % of the speed asked for, except those that begin or end at
  /// rest.
  void find_slow(TimedPath& out) const {
    const std::size_t n = out.rows.size();
    const auto slow = [&](std::size_t k) { return asked_[k].share < 0.995; };
    for (std::size_t k = 0; k < n;) {
      if (!slow(k)) {
        ++k;
        continue;
      }
      std::size_t end = k;
      while (end < n && slow(end) && asked_[end].piece == asked_[k].piece) ++end;
      const bool starts = k == 0 || asked_[k - 1].piece != asked_[k].piece;
      const bool stops = end == n || asked_[end].piece != asked_[k].piece;
      report_slow(out, k, end, starts, stops);
      k = end;
    }
  }

 private:
  struct Asked {
    double share = 0;  // part of the speed asked for, as lowered for the tool
    std::size_t piece = 0, node = 0;
  };

  /// Returns the difference of an order (0 speed, 1 acceleration, 2 jerk) that ends at sample k, as
  /// a part of what joint j can do; the arm rests before the first and after the last sample.
  [[nodiscard]] double ratio_at(const TimedPath& out, long long k, int order, int j) const {
    const auto n = static_cast<long long>(out.rows.size());
    const double dt = 1 / options_->rate;
    const auto q = [&](long long i) {
      return out.rows[static_cast<std::size_t>(std::clamp(i, 0LL, n - 1))].row.q[j];
    };
    const double step = q(k) - q(k - 1);
    if (order == 0) return std::abs(step / dt) / rates_->speed[j];
    const double before = q(k - 1) - q(k - 2);
    if (order == 1) return std::abs((step - before) / (dt * dt)) / rates_->acceleration[j];
    return std::abs((step - 2 * before + (q(k - 2) - q(k - 3))) / (dt * dt * dt)) / rates_->jerk[j];
  }
  /// Returns the factor by which the move that ends at a sample would have to be slower for the
  /// tool to stay as near its path as asked.
  [[nodiscard]] double slower_for_chord(std::size_t k) const {
    return options_->chord && strayed_[k] > *options_->chord
               ? std::sqrt(strayed_[k] / *options_->chord)
               : 1;
  }
  /// Returns the factor by which slow_down() has lowered the speed about a place, so that the tool
  /// is no faster than asked.
  [[nodiscard]] double slowed_for_tool(std::size_t piece, std::size_t node) const {
    const std::vector<double>& factors = for_tool_[piece];
    double least = factors[node];
    if (node > 0) least = std::min(least, factors[node - 1]);
    if (node + 1 < factors.size()) least = std::min(least, factors[node + 1]);
    return least;
  }
  /// Returns the tool's speed over the move that ends at sample k as a part of the speed asked for:
  /// the larger of its speed along the path and in turning.
  [[nodiscard]] double tool_share(std::size_t k) const {
    if (k == 0) return 0;
    const double along = (tool_[k].translation() - tool_[k - 1].translation()).norm() *
                         options_->rate /
                         speeds_between(*options_, s_at(motion_->path(), travel_[k - 1]),
                                        s_at(motion_->path(), travel_[k]))
                             .most;
    if (!options_->turn_speed) return along;
    return std::max(along,
                    angle_between(tool_[k - 1], tool_[k]) * options_->rate / *options_->turn_speed);
  }
  /// Returns the factor by which the move that ends at a sample would have to be slower for the
  /// tool to be no faster than asked.
  [[nodiscard]] double slower_for_tool(std::size_t k) const {
    constexpr double kRounding = 5e-7;
    const double share = tool_share(k);
    return share > 1 + kRounding ? share : 1;
  }
  static double slower_by(double ratio, int order) {
    return order == 0 ? ratio : order == 1 ? std::sqrt(ratio) : std::cbrt(ratio);
  }

  /// Computes speeds and accelerations of a row from differences over a few milliseconds. Returns
  /// false where the arm has no solution.
  bool differ(const RestToRest& piece, RestToRest::Walk& walk, double t, TimedRow& row) const {
    constexpr double kStep = 1e-3, kLeast = 1e-4;  // s
    const double step = std::min({kStep, t, piece.duration() - t});
    if (step < kLeast) return true;  // at rest
    const auto before = motion_->joints(walk.at(t - step).x),
               after = motion_->joints(walk.at(t + step).x);
    if (!before || !after) return false;
    row.v = (*after - *before) / (2 * step);
    row.a = ((*after - row.row.q) - (row.row.q - *before)) / (step * step);
    return true;
  }

  void report_slow(TimedPath& out, std::size_t k, std::size_t end, bool starts, bool stops) const {
    // A stretch that starts or stops the tool counts only after its first and before its last
    // fastest moment.
    const auto rises = [&](std::size_t i) { return asked_[i + 1].share > asked_[i].share; };
    std::size_t first = k, last = end - 1;
    if (starts)
      while (first < last && rises(first)) ++first;
    if (stops)
      while (last > first && !rises(last - 1)) --last;
    if ((starts || stops) && first >= last) return;
    std::size_t lowest = first;
    for (std::size_t i = first; i <= last; ++i)
      if (asked_[i].share < asked_[lowest].share) lowest = i;
    const Asked& at = asked_[lowest];
    const RestToRest& piece = (*pieces_)[at.piece];
    // Find the reason nearest to the slowest moment.
    SpeedLimiter limiter = piece.limiter(at.node);
    for (std::size_t off = 1; limiter.joint < 0 && off < 200; ++off) {
      if (at.node + off < piece.places().size()) limiter = piece.limiter(at.node + off);
      if (limiter.joint < 0 && off <= at.node) limiter = piece.limiter(at.node - off);
    }
    TimedPath::Slow slow;
    slow.from_s = out.rows[first].row.s, slow.to_s = out.rows[last].row.s;
    slow.from_t = out.rows[first].t, slow.to_t = out.rows[last].t;
    slow.share = at.share;
    slow.joint = std::max(limiter.joint, 0);
    slow.reason = limiter.rate;
    const auto singular = motion_->nearest_singular(out.rows[lowest].row.q);
    if (singular && singular->angle < 0.3)
      slow.singular = singular->where, slow.singular_angle = singular->angle;
    out.slow.push_back(std::move(slow));
  }

  const PathMotion* motion_;
  const JointRates* rates_;
  const TimingOptions* options_;
  std::vector<RestToRest>* pieces_;
  const Budget* budget_;
  bool near_;  // true: samples are dense enough to give speeds and accelerations
  std::vector<double> travel_;
  std::vector<Pose> tool_;  // at the samples
  // of pieces and places: factors of speeds, from the tool's excess
  std::vector<std::vector<double>> for_tool_;
  std::vector<Asked> asked_;
  // m: how far the tool strays between each sample and the one before
  std::vector<double> strayed_;
};

/// Returns the end of the warning about an assumed rate, where the motion goes as far as it allows
/// and takes longer than at the speed asked for; else "".
std::string what_it_decides(const JointRates::Assumed& assumed, const TimedPath& motion,
                            const Chain& chain) {
  // motions are planned up to 0.99 of a rate, and slowed down to a little less
  constexpr double kLonger = 1.02, kReached = 0.9;
  TimedPath::Peak most;
  for (std::size_t j = 0; j < kDof; ++j)
    if (const TimedPath::Peak& peak = motion.peaks[static_cast<std::size_t>(assumed.rate)][j];
        assumed.of[j] && peak.ratio > most.ratio)
      most = peak;
  if (motion.duration < kLonger * motion.ideal || most.ratio < kReached) return "";
  return ", and this decides how long the motion takes: joint '" +
         chain.joint_names[static_cast<std::size_t>(most.joint)] +
         formatted("' reaches it at s = %.4f m", most.s);
}

/// The places at which a motion rests: the travel of the start, of each corner that the tool stops
/// at, and of the end, m; and the layers of these corners.
struct Rests {
  std::vector<double> travel;
  std::vector<int> layer;
};

/// Returns the places at which a motion rests. Counts the corners that it rounds in `out`, with the
/// most by which it leaves the path there.
Rests rests_along(const PathMotion& motion, TimedPath& out) {
  const ToolPath& path = motion.path();
  Rests rests{{0}, {}};
  for (const ToolPath::Corner& corner : path.corners()) {
    if (corner.reach > 0) {
      ++out.rounded;
      out.rounded_position = std::max(out.rounded_position, corner.position);
      out.rounded_angle = std::max(out.rounded_angle, corner.angle);
      continue;
    }
    rests.travel.push_back(path.layer(corner.layer).travel);
    rests.layer.push_back(corner.layer);
  }
  rests.travel.push_back(motion.length());
  return rests;
}

/// Takes samples of a motion and slows it down until they keep all rates: where it is too fast, and
/// after kLocalRounds rounds as a whole. Returns why there is no such motion, if there is none.
std::optional<NoMotion> slow_down_to_rates(Samples& samples, std::vector<RestToRest>& pieces,
                                           TimedPath& out) {
  constexpr int kLocalRounds = 12, kRounds = 32;
  constexpr double kJump = 100;  // an excess so large is a jump of the joints that was not seen
  for (int round = 1;; ++round) {
    if (auto failure = samples.take(out)) return failure;
    const auto [slower, worst] = samples.measure_peaks(out);
    if (slower <= 1) return std::nullopt;
    if (round == kRounds || slower > kJump)
      return NoMotion{worst, "the joints would have to jump between layers"};
    if (round <= kLocalRounds)
      samples.slow_down(out);
    else
      for (RestToRest& piece : pieces) piece.stretch(slower * (1 + 1e-6));
  }
}

}  // namespace

const char* to_string(JointRate rate) {
  return rate == JointRate::kSpeed          ? "speed"
         : rate == JointRate::kAcceleration ? "acceleration"
                                            : "jerk";
}

TimingResult time_path(const PathMotion& motion, const JointRates& rates,
                       const TimingOptions& options, const Budget& budget) {
  TimingResult result;
  if (!motion.jumps().empty()) {
    result.failure = motion.jumps().front();
    return result;
  }
  TimedPath out;
  out.rate = options.rate;
  out.speed = options.speed;
  out.roll = motion.chain().roll;
  const Rests rests = rests_along(motion, out);
  std::vector<RestToRest> pieces;
  for (std::size_t k = 1; k < rests.travel.size(); ++k) {
    std::vector<PathSample> places;
    result.failure = survey(motion, places_between(motion, rests.travel[k - 1], rests.travel[k]),
                            options.chord.has_value(), places);
    if (result.failure) return result;
    pieces.emplace_back(rates, options, std::move(places));
    const int rounds = pieces.back().plan(budget);
    out.rounds = std::max(out.rounds, rounds + pieces.back().speed_up(budget));
    out.ideal += pieces.back().ideal();
  }
  Samples samples(motion, rates, options, pieces, budget);
  result.failure = slow_down_to_rates(samples, pieces, out);
  if (result.failure) return result;
  double t = 0;
  for (std::size_t k = 0; k + 1 < pieces.size(); ++k) {
    t += pieces[k].duration();
    const PathLayer& stop = motion.path().layer(rests.layer[k]);
    out.stops.push_back({stop.s, t, stop.waypoint});
  }
  if (!options.chord) samples.measure_between(out);
  samples.find_slow(out);
  for (const JointRates::Assumed& assumed : rates.assumed)
    out.warnings.push_back(assumed.text + what_it_decides(assumed, out, motion.chain()));
  if (out.between_position > 10e-6) {
    const std::string text = formatted(
        "between samples the tool leaves its path by up to %.3g mm: a higher --rate brings less",
        1e3 * out.between_position);
    out.warnings.emplace_back(text);
  }
  result.motion = std::move(out);
  return result;
}

}  // namespace swivel
