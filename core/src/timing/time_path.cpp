// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/timing/time_path.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/timing/time_arms.hpp"
#include "timing/derivative_weights.hpp"

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

/// Returns the travel of an arm's tool at a parameter.
double travel_at(const TimedArm& arm, double x) {
  return arm.travel != nullptr ? arm.travel->travel(x) : x;
}
/// Returns the joints of an arm at a parameter; none where it has no solution.
std::optional<Config> joints_at(const TimedArm& arm, double x) {
  return arm.motion->joints(travel_at(arm, x));
}
/// Returns the pose of an arm's tool on its path at a parameter, in the base frame.
Pose tool_at(const TimedArm& arm, double x) {
  return arm.motion->path().at_travel(travel_at(arm, x));
}
/// Returns that pose in the frame in which the speed of the tool is asked for: on the leader's tool
/// where there is one, else in the base frame. `tool` is the pose in the base frame.
Pose process_pose(const TimedArm& arm, const Pose& tool, double x) {
  return arm.leader != nullptr ? tool_at(*arm.leader, x).inverse() * tool : tool;
}

/// The most arms that move by one clock.
constexpr std::size_t kMostArms = 2;
/// The arms of a motion, one or two.
using Arms = std::span<const TimedArm>;

/// The geometry of one arm's motion at one place: derivatives of the joints by the parameter, and
/// the tool's speeds per metre of it.
struct ArmSample {
  double s = 0;  // m along the path
  Config q, first, second, third;
  double along = 0, turning = 0;                  // m/m and rad/m
  double along_in_base = 0, turning_in_base = 0;  // the same in the base frame
  // 1/m: over a straight move of the joints the tool strays by this times the square of the
  // parameter's change.
  double chord = 0;
};
/// A place of a motion, by its parameter: of one arm, the travel of its tool.
struct PathSample {
  double x = 0;  // m
  std::array<ArmSample, kMostArms> arm;
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
  std::size_t arm = 0;
  int joint = -1;  // -1: the speed asked for
  JointRate rate = JointRate::kSpeed;
};

/// The motion from one rest to the next: its place and speed at each time.
class RestToRest {
 public:
  RestToRest(Arms arms, std::vector<PathSample> places)
      : arms_(arms), places_(std::move(places)), n_(places_.size()) {
    asked_.assign(n_, kInfinity);
    speed_cap_.resize(n_);
    acceleration_cap_.assign(n_, kInfinity);
    limiter_.resize(n_);
    speed_scale_.assign(n_, 1);
    acceleration_scale_.assign(n_, 1);
    speed_.assign(n_, 0);
    filter_ = 0;
    for (const TimedArm& arm : arms_)
      for (int j = 0; j < kDof; ++j)
        if (std::isfinite(arm.rates->acceleration[j]))
          filter_ = std::max(filter_, kShare * arm.rates->acceleration[j] / arm.rates->jerk[j]);
    filter_ = std::max(filter_, 1e-4);
    for (std::size_t k = 0; k < n_; ++k) {
      for (std::size_t m = 0; m < arms_.size(); ++m) ask(k, m);
      speed_cap_[k] = asked_[k];
      double joint_speed = kInfinity;
      for (std::size_t m = 0; m < arms_.size(); ++m) joint_speed = std::min(joint_speed, cap(k, m));
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

  /// The parameter and its first three derivatives by time.
  struct State {
    double x = 0, speed = 0, acceleration = 0, jerk = 0;
    double from = 0, to = 0;  // of the unfiltered motion, half a window before and after
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

  /// Derivatives of one arm's joints by the parameter.
  struct Derivatives {
    Config first, second, third;
  };
  /// Returns the derivatives of an arm's joints at a parameter, linear between places. `node` is
  /// the place, as seek() sets it.
  [[nodiscard]] Derivatives derivatives(std::size_t arm, double x, std::size_t node) const {
    const ArmSample &a = places_[node].arm[arm], &b = places_[node + 1].arm[arm];
    const double u = share(x, node), v = 1 - u;
    return {v * a.first + u * b.first, v * a.second + u * b.second, v * a.third + u * b.third};
  }
  /// The speed asked for at a parameter, and the place nearest to it.
  struct AskedAt {
    double asked = 0;
    std::size_t node = 0;
  };
  /// Returns the speed asked for at a parameter, linear between places. `node` is a hint for the
  /// place, and is set to it.
  [[nodiscard]] AskedAt asked_at(double x, std::size_t& node) const {
    seek(x, node);
    const double u = share(x, node), v = 1 - u;
    return {v * asked_[node] + u * asked_[node + 1], u < 0.5 ? node : node + 1};
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

  static double over(double limit, double value) { return value > 0 ? limit / value : kInfinity; }

  /// Lowers the speed asked for at place k to that of an arm's tool.
  void ask(std::size_t k, std::size_t m) {
    const ArmSample& place = places_[k].arm[m];
    const TimingOptions& options = *arms_[m].options;
    double& asked = asked_[k];
    asked = std::min(asked, over(speeds_between(options, place.s, place.s).least,
                                 place.along > kStill ? place.along : 0));
    if (options.turn_speed) asked = std::min(asked, over(*options.turn_speed, place.turning));
    if (arms_[m].most_speed)
      asked = std::min(asked, over(*arms_[m].most_speed, place.along_in_base));
    if (arms_[m].most_turn_speed)
      asked = std::min(asked, over(*arms_[m].most_turn_speed, place.turning_in_base));
    if (options.chord)
      asked =
          std::min(asked, options.rate * std::sqrt(kTarget * over(*options.chord, place.chord)));
  }
  /// Lowers the caps of place k to what the joints of an arm can do. Returns the highest speed that
  /// their speeds allow.
  double cap(std::size_t k, std::size_t m) {
    const ArmSample& place = places_[k].arm[m];
    const JointRates& rates = *arms_[m].rates;
    double joint_speed = kInfinity;
    for (int j = 0; j < kDof; ++j) {
      joint_speed = std::min(joint_speed, over(rates.speed[j], std::abs(place.first[j])));
      lower(k, kTarget * over(rates.speed[j], std::abs(place.first[j])), {m, j, JointRate::kSpeed});
      lower(k, std::sqrt(kTarget * over(rates.acceleration[j], std::abs(place.second[j]))),
            {m, j, JointRate::kAcceleration});
      lower(k, std::cbrt(kTarget * over(rates.jerk[j], std::abs(place.third[j]))),
            {m, j, JointRate::kJerk});
      acceleration_cap_[k] = std::min(
          acceleration_cap_[k], kShare * over(rates.acceleration[j], std::abs(place.first[j])));
    }
    return joint_speed;
  }

  void lower(std::size_t k, double to, const SpeedLimiter& limiter) {
    if (to >= speed_cap_[k]) return;
    speed_cap_[k] = to;
    limiter_[k] = limiter;
  }

  void seek(double x, std::size_t& node) const {
    if (node + 2 > n_ || places_[node].x > x) node = 0;
    while (node + 2 < n_ && places_[node + 1].x <= x) ++node;
  }

  /// Returns the share of the way from a place to the next at which a parameter lies.
  [[nodiscard]] double share(double x, std::size_t node) const {
    const double from = places_[node].x, to = places_[node + 1].x;
    return std::clamp((x - from) / (to - from), 0.0, 1.0);
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
    constexpr double kLeast = 0.5;
    std::vector<double> slower(n_, 1), acceleration_scale(n_, 1);
    used_.assign(n_, kNothing);
    double worst = 1;
    const double step = std::min(1e-3, filter_ / 8);
    Walk walk(*this);
    std::size_t node = 0, low = 0, high = 0;
    const auto steps = static_cast<long long>(std::ceil((end_ + filter_) / step));
    for (long long i = 0; i <= steps; ++i) {
      const State at = walk.at(static_cast<double>(i) * step * stretch_);
      const std::size_t nearest = asked_at(at.x, node).node;
      Use use;
      for (std::size_t m = 0; m < arms_.size(); ++m)
        add_use(m, derivatives(m, at.x, node), at, both, nearest, use);
      const double path = use.path, along = use.along;
      worst = std::max(worst, use.worst);
      seek(at.from, low);
      seek(at.to, high);
      for (std::size_t k = low; k <= std::min(high + 1, n_ - 1); ++k)
        used_[k] = std::max(used_[k], use.used);
      if (path >= 1 && along >= 1) continue;
      for (std::size_t k = low > 0 ? low - 1 : 0; k <= std::min(high + 2, n_ - 1); ++k) {
        slower[k] = std::min(slower[k], std::max(kLeast, path));
        acceleration_scale[k] = std::min(acceleration_scale[k], std::max(kLeast, along));
      }
    }
    if (may_slow_down) slow_down(slower, acceleration_scale);
    return worst;
  }

  /// How much of their rates the joints use at one moment, and what keeps them: factors of the
  /// speed and of the acceleration along the path, and of time (`worst`).
  struct Use {
    double path = 1, along = 1, used = kNothing, worst = 1;
  };
  /// Adds the use of an arm's joints in a state of the motion; verify() says what `both` means.
  /// Notes joints that slow down the place `nearest`.
  void add_use(std::size_t m, const Derivatives& d, const State& at, bool both, std::size_t nearest,
               Use& use) {
    constexpr double kPath = 0.9;  // share of a rate that bends may take
    const double v = at.speed, a = at.acceleration, jerk = at.jerk;
    const JointRates& rates = *arms_[m].rates;
    for (int j = 0; j < kDof; ++j) {
      const double speed = d.first[j] * v, bend = d.second[j] * v * v,
                   third = d.third[j] * v * v * v;
      const double limit[3] = {rates.speed[j], rates.acceleration[j], rates.jerk[j]};
      const double all[3] = {speed, bend + d.first[j] * a,
                             third + 3 * d.second[j] * v * a + d.first[j] * jerk};
      const double of_path[3] = {speed, bend, third};  // at a steady speed
      for (int n = 0; n < 3; ++n) {
        const double ratio = std::abs(all[n]) / (kTarget * limit[n]),
                     share = std::abs(of_path[n]) / (kTarget * limit[n]);
        use.used = std::max(use.used, ratio);
        if (ratio <= 1) continue;
        const auto root = [n](double of) {
          return n == 0 ? of : n == 1 ? std::sqrt(of) : std::cbrt(of);
        };
        use.worst = std::max(use.worst, root(ratio));
        const bool of_speed = both || n == 0 || share > kPath;
        if (of_speed) {
          use.path = std::min(use.path, both || n == 0 ? 0.995 / root(ratio) : root(kPath / share));
          limiter_[nearest] = {m, j, static_cast<JointRate>(n)};
        }
        const double left = std::min(share, kPath);
        if (both)
          use.along = std::min(use.along, 0.98 / ratio);
        else if (n > 0)
          use.along = std::min(use.along, (0.98 - left) / (ratio - left));
      }
    }
  }

  Arms arms_;
  std::vector<PathSample> places_;
  std::size_t n_;
  std::vector<double> asked_;                             // speed asked for, m/s of the parameter
  std::vector<double> speed_cap_, acceleration_cap_;      // m/s and m/s^2: what the joints allow
  std::vector<double> speed_scale_, acceleration_scale_;  // factors of both, from verifying
  std::vector<SpeedLimiter> limiter_;
  std::vector<double> used_;  // largest part of its rates that a joint uses near each place
  // of the unfiltered motion: constant acceleration between places
  std::vector<double> speed_, time_, area_;
  double filter_ = 0, end_ = 0, stretch_ = 1;
};

/// Returns the parameter at which an arm's tool has a travel.
double parameter_at(const TimedArm& arm, double travel) {
  return arm.travel != nullptr ? arm.travel->parameter(travel) : travel;
}

/// Returns places from one rest to the next: at least four a step, eight on either side of a
/// rounded corner and of a waypoint at which the ratio of two tools' speeds changes, and finer ones
/// next to the rests, since a speed that rises from place to place rises more slowly the farther
/// the first one is.
std::vector<double> places_between(Arms arms, double from, double to) {
  std::vector<double> knots{from};  // of the redundancy
  std::vector<double> bends;
  for (const TimedArm& arm : arms) {
    const ToolPath& path = arm.motion->path();
    for (const double travel : arm.motion->knots())
      if (const double x = parameter_at(arm, travel); x > from && x < to) knots.push_back(x);
    for (const ToolPath::Corner& corner : path.corners()) {
      const double travel = path.layer(corner.layer).travel, x = parameter_at(arm, travel);
      if (corner.reach > 0 && x > from && x < to)
        for (int k = -8; k <= 8; ++k)
          bends.push_back(parameter_at(arm, travel + k * corner.reach / 8));
    }
    if (arm.travel == nullptr) continue;
    for (const SharedTravel::Blend& blend : arm.travel->blends())
      if (blend.x > from && blend.x < to)
        for (int k = -8; k <= 8; ++k) bends.push_back(blend.x + k * blend.reach / 8);
  }
  knots.push_back(to);
  if (arms.size() > 1) {
    std::sort(knots.begin(), knots.end());
    std::sort(bends.begin(), bends.end());
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
  const PathLayer &from = path.layer(path.step_at(travel)),
                  &to = path.layer(path.step_at(travel) + 1);
  const double way = to.travel - from.travel;
  const double share = way > 0 ? std::clamp((travel - from.travel) / way, 0.0, 1.0) : 0;
  return from.s + share * (to.s - from.s);
}

/// An arm's joints and tool at places.
struct Surveyed {
  std::vector<Pose> tool, process;  // in the base frame, and where its speed is asked for
};

/// Computes derivatives of an arm's joints and its tool's speeds at place k, by differences.
void differentiate(const TimedArm& arm, std::size_t m, const std::vector<double>& xs, std::size_t k,
                   const Surveyed& seen, std::vector<PathSample>& places) {
  const std::size_t n = xs.size(), first = std::min(k > 2 ? k - 2 : 0, n - 5);
  const auto weights = derivative_weights(xs.data() + first, xs[k]);
  ArmSample& place = places[k].arm[m];
  place.first = place.second = place.third = Config::Zero();
  Vector3d along = Vector3d::Zero(), process = Vector3d::Zero();
  for (std::size_t i = 0; i < 5; ++i) {
    const auto w = weights.row(static_cast<Eigen::Index>(i));
    const Config& q = places[first + i].arm[m].q;
    place.first += w[1] * q;
    place.second += w[2] * q;
    place.third += w[3] * q;
    along += w[1] * seen.tool[first + i].translation();
    process += w[1] * seen.process[first + i].translation();
  }
  place.along = process.norm();
  const std::size_t a = k > 0 ? k - 1 : 0, b = std::min(k + 1, n - 1);
  place.turning = angle_between(seen.process[a], seen.process[b]) / (xs[b] - xs[a]);
  if (arm.leader != nullptr) {
    place.along_in_base = along.norm();
    place.turning_in_base = angle_between(seen.tool[a], seen.tool[b]) / (xs[b] - xs[a]);
  }
  if (!arm.options->chord) return;
  // Half-way along a straight move over a travel of h the joints are off by q'' h^2 / 8. What is
  // along the path only shifts the time.
  const double least = 1e-4 / std::max(1.0, joint_norm(place.second));
  const auto moved = [&](double by) -> Vector3d {
    return arm.motion->chain().tool(place.q + by * place.second).translation();
  };
  Vector3d off = (moved(least) - moved(-least)) / (2 * least);
  if (along.norm() > 0) off -= off.dot(along) / along.squaredNorm() * along;
  place.chord = off.norm() / 8;
}

/// What is wrong with the motion of one of the arms.
struct ArmFailure {
  NoMotion what;
  std::size_t arm = 0;
};

/// Computes joints and tools at the places, and their derivatives by the parameter. Returns where
/// an arm has no solution, none where each has one everywhere.
std::optional<ArmFailure> survey(Arms arms, const std::vector<double>& xs,
                                 std::vector<PathSample>& places) {
  places.resize(xs.size());
  for (std::size_t m = 0; m < arms.size(); ++m) {
    const TimedArm& arm = arms[m];
    const ToolPath& path = arm.motion->path();
    Surveyed seen;
    for (std::size_t k = 0; k < xs.size(); ++k) {
      places[k].x = xs[k];
      const double travel = travel_at(arm, xs[k]);
      places[k].arm[m].s = s_at(path, travel);
      seen.tool.push_back(path.at_travel(travel));
      seen.process.push_back(process_pose(arm, seen.tool.back(), xs[k]));
      const auto q = arm.motion->joints(travel);
      if (!q)
        return ArmFailure{
            {path.layer(path.step_at(travel)).s, "the arm has no solution between layers"}, m};
      places[k].arm[m].q = *q;
    }
    for (std::size_t k = 0; k < xs.size(); ++k) differentiate(arm, m, xs, k, seen, places);
  }
  return std::nullopt;
}

/// The sampled motion of the arms, and its measures. `out` is everywhere one motion for each arm.
class Samples {
 public:
  using Motions = std::vector<TimedPath>;

  Samples(Arms arms, std::vector<RestToRest>& pieces, const Budget& budget)
      : arms_(arms),
        rate_(arms.front().options->rate),
        pieces_(&pieces),
        budget_(&budget),
        near_(1 / rate_ <= 4e-3 * (1 + 1e-9)),
        tool_(arms.size()),
        process_(arms.size()),
        strayed_(arms.size()) {
    for (const RestToRest& piece : pieces) for_tool_.emplace_back(piece.places().size(), 1);
  }

  std::optional<ArmFailure> take(Motions& out) {
    x_.clear();
    asked_.clear();
    for (std::size_t m = 0; m < arms_.size(); ++m) {
      out[m].rows.clear();
      tool_[m].clear();
      process_[m].clear();
    }
    double before = 0;
    const double dt = 1 / rate_;
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
        const bool differs = !near_ && here > 0 && here < piece.duration();
        std::optional<Beside> states;
        if (differs) states = states_beside(piece, beside, here);
        for (std::size_t m = 0; m < arms_.size(); ++m)
          if (auto failure = take_row(m, t, at.x, states, out[m]))
            return ArmFailure{*std::move(failure), m};
        x_.push_back(at.x);
        const RestToRest::AskedAt here_asked = piece.asked_at(at.x, node);
        const double share = at.speed / here_asked.asked,
                     slowed = slowed_for_tool(p, here_asked.node);
        asked_.push_back({slowed < 1 ? std::min(1.0, share / slowed) : share, p, here_asked.node});
        if (done) break;
      }
      before += piece.duration();
    }
    for (std::size_t m = 0; m < arms_.size(); ++m) finish_rows(m, before, out[m]);
    return std::nullopt;
  }

  struct Excess {
    double by = 1;        ///< the factor by which the motion would have to be slower
    double s = 0;         ///< where, m along the path of the arm
    std::size_t arm = 0;  ///< the arm whose joints or tool ask for it
  };
  Excess measure_peaks(Motions& out) const {
    Excess worst;
    for (std::size_t m = 0; m < arms_.size(); ++m) measure_peaks(m, out[m], worst);
    return worst;
  }

  /// Slows down where differences between samples exceed the rates, or the speeds asked of the
  /// tool: at corners they are larger than at the places.
  void slow_down(const Motions& out) {
    constexpr double kLeast = 0.5;
    // times the excess of the tool's speed: neighbouring places contribute
    constexpr double kTool = 1.2;
    const auto n = static_cast<long long>(x_.size());
    std::vector<std::vector<double>> slower, acceleration_scale;
    for (const RestToRest& piece : *pieces_)
      slower.emplace_back(piece.places().size(), 1), acceleration_scale.push_back(slower.back());
    std::vector<std::vector<double>> for_tool = slower;
    std::vector<bool> changed(pieces_->size(), false);
    for (long long k = -1; k < n + 2; ++k) {
      double speed = 1, acceleration_cap = 1, tool = 1;
      for (std::size_t m = 0; m < arms_.size(); ++m) {
        for (int order = 0; order < 3; ++order)
          for (int j = 0; j < kDof; ++j)
            if (const double ratio = ratio_at(m, out[m], k, order, j); ratio > 1) {
              speed = std::min(speed, std::max(kLeast, 0.995 / slower_by(ratio, order)));
              if (order > 0)
                acceleration_cap = std::min(acceleration_cap, std::max(kLeast, 0.98 / ratio));
            }
        const auto sample = static_cast<std::size_t>(std::clamp(k, 0LL, n - 1));
        if (const double by = slower_for_chord(m, sample); by > 1)
          speed = std::min(speed, std::max(kLeast, 0.995 / by));
        if (const double by = slower_for_tool(m, sample); by > 1)
          tool = std::min(tool, std::max(kLeast, 1 / (1 + kTool * (by - 1))));
      }
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

  /// Measures how far an arm's tool is off its path half-way between samples.
  void measure_between(std::size_t m, TimedPath& out) {
    const TimedArm& arm = arms_[m];
    std::vector<double>& strayed = strayed_[m];
    out.between_position = out.between_angle = 0;
    strayed.assign(out.rows.size(), 0);
    for (std::size_t k = 1; k < out.rows.size(); ++k) {
      const double middle = (x_[k - 1] + x_[k]) / 2, h = x_[k] - x_[k - 1];
      if (h <= 0) continue;
      const Pose tool = arm.motion->chain().tool((out.rows[k - 1].row.q + out.rows[k].row.q) / 2);
      const Pose there = tool_at(arm, middle);
      Vector3d off = tool.translation() - there.translation();
      // The part along the path only shifts the time, between the samples at both ends.
      const Vector3d way = tool_[m][k].translation() - tool_[m][k - 1].translation();
      if (way.norm() > 1e-12) off -= std::clamp(off.dot(way) / way.squaredNorm(), -0.5, 0.5) * way;
      strayed[k] = off.norm();
      out.between_position = std::max(out.between_position, strayed[k]);
      out.between_angle = std::max(out.between_angle, angle_between(tool, there));
    }
  }

  /// Finds the stretches below 99.5 % of the speed asked for, except those that begin or end at
  /// rest. Each is noted with the arm whose joint causes it.
  void find_slow(Motions& out) const {
    const std::size_t n = x_.size();
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

  /// States of a piece a little before and after a moment.
  struct Beside {
    RestToRest::State before, after;
    double step = 0;  // s
  };
  /// Returns the states beside a moment of a piece; none next to its rests.
  [[nodiscard]] static std::optional<Beside> states_beside(const RestToRest& piece,
                                                           RestToRest::Walk& walk, double t) {
    constexpr double kStep = 1e-3, kLeast = 1e-4;  // s
    const double step = std::min({kStep, t, piece.duration() - t});
    if (step < kLeast) return std::nullopt;  // at rest
    Beside beside{.step = step};
    beside.before = walk.at(t - step);
    beside.after = walk.at(t + step);
    return beside;
  }

  /// Returns the joints of an arm at parameter x as rows have them.
  [[nodiscard]] Config as_in_rows(const TimedArm& arm, double x, const Config& q) const {
    const PathMotion& motion = *arm.motion;
    TrajectoryRow row;
    row.q = q;
    return counted_from_waypoints(motion.chain(), motion.path(), travel_at(arm, x), row).q;
  }

  /// Adds the sample of an arm at parameter x to its motion. `beside` gives its speeds and
  /// accelerations, if set. Returns why the arm has none.
  std::optional<NoMotion> take_row(std::size_t m, double t, double x,
                                   const std::optional<Beside>& beside, TimedPath& out) {
    const TimedArm& arm = arms_[m];
    const PathMotion& motion = *arm.motion;
    const double travel = travel_at(arm, x);
    const auto q = motion.joints(travel);
    if (!q)
      return NoMotion{motion.row(travel, Config::Zero()).s,
                      "the arm has no solution between layers"};
    TimedRow row;
    row.t = t;
    row.row = motion.row(travel, *q);
    if (beside) {
      const auto before = joints_at(arm, beside->before.x), after = joints_at(arm, beside->after.x);
      if (!before || !after) return NoMotion{row.row.s, "the arm has no solution between layers"};
      const Config behind = as_in_rows(arm, beside->before.x, *before),
                   ahead = as_in_rows(arm, beside->after.x, *after), &here = row.row.q;
      row.v = (ahead - behind) / (2 * beside->step);
      row.a = ((ahead - here) - (here - behind)) / (beside->step * beside->step);
    }
    if (!roll_allowed(motion.chain(), motion.path(), travel, row.row))
      return NoMotion{row.row.s,
                      "the tool would turn further than its waypoints allow between layers"};
    out.rows.push_back(row);
    tool_[m].push_back(motion.path().at_travel(travel));
    process_[m].push_back(process_pose(arm, tool_[m].back(), x));
    return std::nullopt;
  }

  /// Computes what follows from the samples of an arm's whole motion.
  void finish_rows(std::size_t m, double duration, TimedPath& out) {
    const double dt = 1 / rate_;
    for (std::size_t i = 1; near_ && i + 1 < out.rows.size(); ++i) {
      const Config &q0 = out.rows[i - 1].row.q, &q1 = out.rows[i].row.q,
                   &q2 = out.rows[i + 1].row.q;
      out.rows[i].v = (q2 - q0) / (2 * dt);
      out.rows[i].a = ((q2 - q1) - (q1 - q0)) / (dt * dt);
    }
    out.duration = duration;
    if (arms_[m].options->chord) measure_between(m, out);
  }

  void measure_peaks(std::size_t m, TimedPath& out, Excess& worst) const {
    const auto n = static_cast<long long>(out.rows.size());
    out.peaks = {};
    for (long long k = -1; k < n + 2; ++k)
      for (int order = 0; order < 3; ++order)
        for (int j = 0; j < kDof; ++j) {
          const double ratio = ratio_at(m, out, k, order, j);
          TimedPath::Peak& peak =
              out.peaks[static_cast<std::size_t>(order)][static_cast<std::size_t>(j)];
          if (ratio <= peak.ratio) continue;
          const TimedRow& row = out.rows[static_cast<std::size_t>(
              std::clamp(k - order / 2 - (order > 0 ? 1 : 0), 0LL, n - 1))];
          peak = {ratio, j, row.t, row.row.s};
          if (const double by = slower_by(ratio, order); by > worst.by) worst = {by, row.row.s, m};
        }
    for (std::size_t k = 0; k < out.rows.size(); ++k)
      if (const double by = std::max(slower_for_chord(m, k), slower_for_tool(m, k)); by > worst.by)
        worst = {by, out.rows[k].row.s, m};
  }

  /// Returns the difference of an order (0 speed, 1 acceleration, 2 jerk) that ends at sample k, as
  /// a part of what joint j of an arm can do; it rests before the first and after the last sample.
  [[nodiscard]] double ratio_at(std::size_t m, const TimedPath& out, long long k, int order,
                                int j) const {
    const auto n = static_cast<long long>(out.rows.size());
    const double dt = 1 / rate_;
    const JointRates& rates = *arms_[m].rates;
    const auto q = [&](long long i) {
      return out.rows[static_cast<std::size_t>(std::clamp(i, 0LL, n - 1))].row.q[j];
    };
    const double step = q(k) - q(k - 1);
    if (order == 0) return std::abs(step / dt) / rates.speed[j];
    const double before = q(k - 1) - q(k - 2);
    if (order == 1) return std::abs((step - before) / (dt * dt)) / rates.acceleration[j];
    return std::abs((step - 2 * before + (q(k - 2) - q(k - 3))) / (dt * dt * dt)) / rates.jerk[j];
  }
  /// Returns the factor by which the move that ends at a sample would have to be slower for an
  /// arm's tool to stay as near its path as asked.
  [[nodiscard]] double slower_for_chord(std::size_t m, std::size_t k) const {
    const auto& chord = arms_[m].options->chord;
    return chord && strayed_[m][k] > *chord ? std::sqrt(strayed_[m][k] / *chord) : 1;
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
  /// Returns the speed of an arm's tool over the move that ends at sample k as a part of the speed
  /// asked for: the largest of its speed along the path and in turning, and of both in the base
  /// frame.
  [[nodiscard]] double tool_share(std::size_t m, std::size_t k) const {
    if (k == 0) return 0;
    const TimedArm& arm = arms_[m];
    const ToolPath& path = arm.motion->path();
    const Pose &from = process_[m][k - 1], &to = process_[m][k];
    const double along = (to.translation() - from.translation()).norm() * rate_ /
                         speeds_between(*arm.options, s_at(path, travel_at(arm, x_[k - 1])),
                                        s_at(path, travel_at(arm, x_[k])))
                             .most;
    double share = along;
    if (arm.options->turn_speed)
      share = std::max(along, angle_between(from, to) * rate_ / *arm.options->turn_speed);
    const Pose &before = tool_[m][k - 1], &after = tool_[m][k];
    if (arm.most_speed)
      share = std::max(
          share, (after.translation() - before.translation()).norm() * rate_ / *arm.most_speed);
    if (arm.most_turn_speed)
      share = std::max(share, angle_between(before, after) * rate_ / *arm.most_turn_speed);
    return share;
  }
  /// Returns the factor by which the move that ends at a sample would have to be slower for an
  /// arm's tool to be no faster than asked.
  [[nodiscard]] double slower_for_tool(std::size_t m, std::size_t k) const {
    constexpr double kRounding = 5e-7;
    const double share = tool_share(m, k);
    return share > 1 + kRounding ? share : 1;
  }
  static double slower_by(double ratio, int order) {
    return order == 0 ? ratio : order == 1 ? std::sqrt(ratio) : std::cbrt(ratio);
  }

  void report_slow(Motions& motions, std::size_t k, std::size_t end, bool starts,
                   bool stops) const {
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
    const PathMotion& motion = *arms_[limiter.arm].motion;
    TimedPath& out = motions[limiter.arm];
    TimedPath::Slow slow;
    slow.from_s = out.rows[first].row.s, slow.to_s = out.rows[last].row.s;
    slow.from_t = out.rows[first].t, slow.to_t = out.rows[last].t;
    slow.share = at.share;
    slow.joint = std::max(limiter.joint, 0);
    slow.reason = limiter.rate;
    const auto singular = motion.nearest_singular(out.rows[lowest].row.q);
    if (singular && singular->angle < 0.3)
      slow.singular = singular->where, slow.singular_angle = singular->angle;
    out.slow.push_back(std::move(slow));
  }

  Arms arms_;
  double rate_;  // samples a second
  std::vector<RestToRest>* pieces_;
  const Budget* budget_;
  bool near_;              // true: samples are dense enough to give speeds and accelerations
  std::vector<double> x_;  // the parameter at the samples
  // of arms and samples: the tool in the base frame, and where its speed is asked for
  std::vector<std::vector<Pose>> tool_, process_;
  // of pieces and places: factors of speeds, from the tool's excess
  std::vector<std::vector<double>> for_tool_;
  std::vector<Asked> asked_;
  // m: how far an arm's tool strays between each sample and the one before
  std::vector<std::vector<double>> strayed_;
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

/// Returns the layers of the corners that a path does not round.
std::vector<int> unrounded_corners(const ToolPath& path) {
  std::vector<int> layers;
  for (const ToolPath::Corner& corner : path.corners())
    if (!(corner.reach > 0)) layers.push_back(corner.layer);
  return layers;
}

/// Counts the corners that a path rounds, with the most by which it leaves the polyline there.
void count_rounded(const ToolPath& path, TimedPath& out) {
  for (const ToolPath::Corner& corner : path.corners()) {
    if (!(corner.reach > 0)) continue;
    ++out.rounded;
    out.rounded_position = std::max(out.rounded_position, corner.position);
    out.rounded_angle = std::max(out.rounded_angle, corner.angle);
  }
}

/// Takes samples of the arms' motions and slows them down until they keep all rates: where they are
/// too fast, and after kLocalRounds rounds as a whole. Returns why there are no such motions, if
/// there are none.
std::optional<ArmFailure> slow_down_to_rates(Samples& samples, std::vector<RestToRest>& pieces,
                                             std::vector<TimedPath>& out) {
  constexpr int kLocalRounds = 12, kRounds = 32;
  // An excess so large, at once or in time, is a jump of the joints that was not seen.
  constexpr double kJump = 100;
  const auto duration = [&] {
    double sum = 0;
    for (const RestToRest& piece : pieces) sum += piece.duration();
    return sum;
  };
  const double first = duration();
  for (int round = 1;; ++round) {
    if (auto failure = samples.take(out)) return failure;
    const auto [slower, worst, arm] = samples.measure_peaks(out);
    if (slower <= 1) return std::nullopt;
    if (round == kRounds || slower > kJump || slower * duration() > kJump * first)
      return ArmFailure{{worst, "the joints would have to jump between layers"}, arm};
    if (round <= kLocalRounds)
      samples.slow_down(out);
    else
      for (RestToRest& piece : pieces) piece.stretch(slower * (1 + 1e-6));
  }
}

/// Notes the stops at layers, the rests between pieces.
void note_stops(Arms arms, const std::vector<int>& rests, const std::vector<RestToRest>& pieces,
                std::vector<TimedPath>& out) {
  double t = 0;
  for (std::size_t k = 0; k < rests.size(); ++k) {
    t += pieces[k].duration();
    for (std::size_t m = 0; m < arms.size(); ++m) {
      const PathMotion& named = arms[m].leader ? *arms[m].leader->motion : *arms[m].motion;
      out[m].stops.push_back(
          {arms[m].motion->path().layer(rests[k]).s, t, named.path().layer(rests[k]).waypoint});
    }
  }
}

/// Adds warnings about assumed rates and about samples that are far apart to a motion.
void add_warnings(const TimedArm& arm, TimedPath& out) {
  for (const JointRates::Assumed& assumed : arm.rates->assumed)
    out.warnings.push_back(assumed.text + what_it_decides(assumed, out, arm.motion->chain()));
  if (out.between_position > 10e-6) {
    const std::string text = formatted(
        "between samples the tool leaves its path by up to %.3g mm: a higher --rate brings less",
        1e3 * out.between_position);
    out.warnings.emplace_back(text);
  }
}

/// Returns the pieces from one rest to the next, with their speeds planned; adds what they take to
/// the motions. Sets `failure` where an arm has no solution.
std::vector<RestToRest> plan_pieces(Arms arms, const std::vector<int>& rests, const Budget& budget,
                                    std::vector<TimedPath>& out,
                                    std::optional<ArmFailure>& failure) {
  const TimedArm& first = arms.front();
  // A path that goes on from `start_at` keeps the travel of the whole one.
  std::vector<double> stops{parameter_at(first, first.motion->path().layer(0).travel)};
  for (const int layer : rests)
    stops.push_back(parameter_at(first, first.motion->path().layer(layer).travel));
  stops.push_back(parameter_at(first, first.motion->length()));
  std::vector<RestToRest> pieces;
  for (std::size_t k = 1; k < stops.size(); ++k) {
    std::vector<PathSample> places;
    failure = survey(arms, places_between(arms, stops[k - 1], stops[k]), places);
    if (failure) break;
    RestToRest& piece = pieces.emplace_back(arms, std::move(places));
    int rounds = piece.plan(budget);
    rounds += piece.speed_up(budget);
    for (TimedPath& motion : out) {
      motion.rounds = std::max(motion.rounds, rounds);
      motion.ideal += piece.ideal();
    }
  }
  return pieces;
}

}  // namespace

const char* to_string(JointRate rate) {
  return rate == JointRate::kSpeed          ? "speed"
         : rate == JointRate::kAcceleration ? "acceleration"
                                            : "jerk";
}

ArmsTiming time_arms(std::span<const TimedArm> arms, const std::vector<int>& rests,
                     const Budget& budget) {
  ArmsTiming result;
  std::vector<TimedPath> out(arms.size());
  for (std::size_t m = 0; m < arms.size(); ++m) {
    const PathMotion& motion = *arms[m].motion;
    if (!motion.jumps().empty()) {
      result.failure = motion.jumps().front();
      result.failed_arm = m;
      return result;
    }
    out[m].rate = arms.front().options->rate;
    out[m].speed = arms[m].options->speed;
    out[m].roll = motion.chain().roll;
    count_rounded(motion.path(), out[m]);
  }
  std::optional<ArmFailure> failure;
  std::vector<RestToRest> pieces = plan_pieces(arms, rests, budget, out, failure);
  std::optional<Samples> samples;
  if (!failure) {
    samples.emplace(arms, pieces, budget);
    failure = slow_down_to_rates(*samples, pieces, out);
  }
  if (failure) {
    result.failure = std::move(failure->what);
    result.failed_arm = failure->arm;
    return result;
  }
  note_stops(arms, rests, pieces, out);
  for (std::size_t m = 0; m < arms.size(); ++m)
    if (!arms[m].options->chord) samples->measure_between(m, out[m]);
  samples->find_slow(out);
  for (std::size_t m = 0; m < arms.size(); ++m) add_warnings(arms[m], out[m]);
  result.motions = std::move(out);
  return result;
}

TimingResult time_path(const PathMotion& motion, const JointRates& rates,
                       const TimingOptions& options, const Budget& budget) {
  const TimedArm arm{.motion = &motion, .rates = &rates, .options = &options};
  ArmsTiming timed = time_arms({&arm, 1}, unrounded_corners(motion.path()), budget);
  TimingResult result;
  result.failure = std::move(timed.failure);
  if (!result.failure) result.motion = std::move(timed.motions.front());
  return result;
}

}  // namespace swivel
