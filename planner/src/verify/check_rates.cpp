// SPDX-License-Identifier: BSD-3-Clause
#include "verify/check_rates.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/timing/time_path.hpp"

namespace swivel {

namespace {

/// A motion's samples in time, as executed by a controller that moves joints straight from each to
/// the next: speeds are constant between samples and change at them. Joints rest before the first
/// sample and after the last.
class Samples {
 public:
  explicit Samples(const std::vector<TimedRow>& rows)
      : rows_(&rows), n_(static_cast<std::ptrdiff_t>(rows.size())) {
    constexpr double kStill = 1e-9;  // rad
    std::vector<double> steps, sorted;
    for (std::size_t k = 1; k < rows.size(); ++k) {
      steps.push_back(rows[k].t - rows[k - 1].t);
      if (!((rows[k].row.q - rows[k - 1].row.q).lpNorm<Eigen::Infinity>() <= kStill))
        sorted.push_back(steps.back());
    }
    if (sorted.empty()) sorted = steps;
    // Messages state times in whole nanoseconds, and doubles of late times are coarse: steps that
    // differ by no more than that count as equal.
    const double same = 2e-9 + 4 * std::numeric_limits<double>::epsilon() *
                                   std::max(std::abs(rows.front().t), std::abs(rows.back().t));
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    double sum = 0, count = 0;
    for (const double step : steps)
      if (std::abs(step - *middle) <= same) sum += step, ++count;
    usual_ = sum / count;
    steps_.push_back(usual_);
    for (const double step : steps)
      steps_.push_back(std::abs(step - usual_) <= same ? usual_ : step);
    for (std::ptrdiff_t k = 0; k < n_; ++k) usual_at_.push_back(usual_about(k));
  }

  [[nodiscard]] std::ptrdiff_t size() const { return n_; }
  [[nodiscard]] const TimedRow& at(std::ptrdiff_t k) const {
    return (*rows_)[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, n_ - 1))];
  }
  /// Returns the median of the steps in which a joint moves, s.
  [[nodiscard]] double usual_step() const { return usual_; }
  /// Returns the time from sample k - 1 to sample k, s.
  [[nodiscard]] double step(std::ptrdiff_t k) const {
    return k < 1 || k >= n_ ? usual_ : steps_[static_cast<std::size_t>(k)];
  }
  /// Returns the speed from sample k - 1 to sample k, rad/s.
  [[nodiscard]] Config speed(std::ptrdiff_t k) const {
    return (at(k).row.q - at(k - 1).row.q) / step(k);
  }
  /// Returns the usual step at sample k, s: that of the motion, or the median of the steps on one
  /// side of the sample if that is less than half of it, as where a motion of few samples goes on
  /// with many.
  [[nodiscard]] double usual_step(std::ptrdiff_t k) const {
    return k < 0 || k >= n_ ? usual_ : usual_at_[static_cast<std::size_t>(k)];
  }
  /// Returns the acceleration at sample k, rad/s^2: the change of speed there, made within the time
  /// from the middle of the step before to the middle of the step after, or within a usual step if
  /// that is less. So a gap in time leaves no more time for a change than any step does.
  [[nodiscard]] Config acceleration(std::ptrdiff_t k) const {
    return (speed(k + 1) - speed(k)) / std::min((step(k) + step(k + 1)) / 2, usual_step(k));
  }
  /// Returns the jerk between samples k and k + 1, rad/s^3: the change of acceleration, made within
  /// the mean of the three steps around it, or within a usual step if that is less.
  [[nodiscard]] Config jerk(std::ptrdiff_t k) const {
    const double usual = std::min(usual_step(k), usual_step(k + 1));
    return (acceleration(k + 1) - acceleration(k)) /
           std::min((step(k) + step(k + 1) + step(k + 2)) / 3, usual);
  }
  /// Returns the mean speed over both steps beside sample k, rad/s.
  [[nodiscard]] Config mean_speed(std::ptrdiff_t k) const {
    return (at(k + 1).row.q - at(k - 1).row.q) / (step(k) + step(k + 1));
  }

 private:
  /// Returns the median of three steps on the side of sample k where it is shorter, s, if that is
  /// less than half of the motion's usual step; else the usual step.
  [[nodiscard]] double usual_about(std::ptrdiff_t k) const {
    const auto median = [&](std::ptrdiff_t first) {
      const double a = step(first), b = step(first + 1), c = step(first + 2);
      return std::max(std::min(a, b), std::min(std::max(a, b), c));
    };
    const double about = std::min(median(k - 2), median(k + 1));
    return about < usual_ / 2 ? about : usual_;
  }

  const std::vector<TimedRow>* rows_;
  std::ptrdiff_t n_;
  std::vector<double> steps_;     // [k]: to sample k
  std::vector<double> usual_at_;  // [k]: at sample k
  double usual_ = 0;
};

/// Returns true if times ascend; otherwise calls `fail` for each pair that does not.
bool ascend(const std::vector<TimedRow>& rows,
            const std::function<void(const std::string&)>& fail) {
  bool all = true;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    if (rows[k].t > rows[k - 1].t && std::isfinite(rows[k].t) && std::isfinite(rows[k - 1].t))
      continue;
    all = false;
    fail(formatted("rows %zu-%zu: t is %.9g s after %.9g s: allowed are times that ascend", k - 1,
                   k, rows[k].t, rows[k - 1].t));
  }
  return all;
}

/// Examines the rates of a motion, sample by sample, and notes the largest.
class RateCheck {
 public:
  RateCheck(const Chain& chain, const JointRates& rates, const std::vector<TimedRow>& rows,
            const std::function<void(const std::string&)>& fail)
      : chain_(chain), rates_(rates), samples_(rows), fail_(fail) {
    motion_.duration = rows.back().t - rows.front().t;
  }

  /// Examines speed, acceleration and jerk of the joints, and what the rows state of them.
  void examine_joints() {
    for (std::ptrdiff_t k = -1; k < samples_.size(); ++k) {
      examine_joints_at(k);
      if (k >= 0) examine_stated_rates(k);
    }
  }

  /// Examines the tool's speeds. `tools` holds its pose at each row, base frame.
  void examine_tool(const std::vector<Pose>& tools, const Limits& limits) {
    for (std::ptrdiff_t k = 1; k < samples_.size(); ++k) {
      const double dt = samples_.step(k);
      const Pose &from = tools[static_cast<std::size_t>(k - 1)],
                 &to = tools[static_cast<std::size_t>(k)];
      motion_.tool_speed =
          std::max(motion_.tool_speed, (to.translation() - from.translation()).norm() / dt);
      motion_.turn_speed =
          std::max(motion_.turn_speed,
                   Eigen::AngleAxisd(from.linear().transpose() * to.linear()).angle() / dt);
    }
    if (limits.tool_speed && !(motion_.tool_speed <= 1.001 * *limits.tool_speed))
      fail_(formatted("the tool moves at up to %.6g m/s: limits.tool_speed is %.6g",
                      motion_.tool_speed, *limits.tool_speed));
    if (limits.tool_turn_speed && !(motion_.turn_speed <= 1.001 * *limits.tool_turn_speed))
      fail_(formatted("the tool turns at up to %.6g rad/s: limits.tool_turn_speed is %.6g",
                      motion_.turn_speed, *limits.tool_turn_speed));
  }

  /// Returns the largest rates found.
  [[nodiscard]] const CheckResult::Motion& motion() const { return motion_; }

 private:
  /// Examines the speed from sample k on, the acceleration at it and the jerk after it.
  void examine_joints_at(std::ptrdiff_t k) {
    const char* const names[] = {"speed", "acceleration", "jerk"};
    const Config* const bounds[] = {&rates_.speed, &rates_.acceleration, &rates_.jerk};
    const double t = samples_.at(k).t;
    const Config by_order[] = {samples_.speed(k + 1), samples_.acceleration(k), samples_.jerk(k)};
    for (std::size_t order = 0; order < 3; ++order)
      for (int j = 0; j < kDof; ++j) {
        const double ratio = std::abs(by_order[order][j]) / (*bounds[order])[j];
        if (!(ratio <= 1 + 1e-6))
          fail_(formatted("t = %.6g s: %s of joint '%s' is %.6g times what it can do", t,
                          names[order], name_of(j), ratio) +
                (order > 0 ? gap_words(k) : ""));
        if (ratio > motion_.peaks[order].ratio) motion_.peaks[order] = {ratio, j, t};
      }
  }

  /// Returns the words that tell of a gap in time beside sample k; "" if there is none.
  [[nodiscard]] std::string gap_words(std::ptrdiff_t k) const {
    const double usual = samples_.usual_step(),
                 longest = std::max({samples_.step(k), samples_.step(k + 1), samples_.step(k + 2)});
    return longest > 1.5 * usual
               ? formatted(", at a gap in time: %.6g s, where rows are %.6g s apart", longest,
                           usual)
               : "";
  }

  /// Compares the speeds and accelerations that row k states with those of its positions.
  void examine_stated_rates(std::ptrdiff_t k) {
    const double dt =
        std::min(std::max(samples_.step(k), samples_.step(k + 1)), samples_.usual_step(k));
    const Config v = samples_.mean_speed(k), a = samples_.acceleration(k);
    const TimedRow& row = samples_.at(k);
    for (int j = 0; j < kDof; ++j) {
      if (!(std::abs(row.v[j] - v[j]) <= rates_.acceleration[j] * dt + 1e-6) ||
          !(std::abs(row.a[j] - a[j]) <= rates_.jerk[j] * dt + 1e-3))
        fail_(
            formatted("t = %.6g s: joint '%s' is said to have %.6g rad/s and %.6g rad/s^2, its "
                      "positions say %.6g and %.6g",
                      row.t, name_of(j), row.v[j], row.a[j], v[j], a[j]));
    }
  }

  [[nodiscard]] const char* name_of(int joint) const {
    return chain_.joint_names[static_cast<std::size_t>(joint)].c_str();
  }

  const Chain& chain_;
  const JointRates& rates_;
  const Samples samples_;
  const std::function<void(const std::string&)>& fail_;
  CheckResult::Motion motion_;
};

}  // namespace

std::optional<CheckResult::Motion> examine_rates(
    const Chain& chain, const Limits& limits, const std::string& source,
    const std::vector<TimedRow>& rows, const std::vector<Pose>& tools,
    const std::function<void(const std::string&)>& fail) {
  const JointRates rates = joint_rates(chain, limits, source);
  if (!ascend(rows, fail)) return std::nullopt;
  RateCheck check(chain, rates, rows, fail);
  check.examine_joints();
  check.examine_tool(tools, limits);
  return check.motion();
}

void complete_rates(std::vector<TimedRow>& rows, const Stated& stated) {
  if (rows.size() < 2 || (stated.v && stated.a && stated.last_joint)) return;
  const Samples samples(rows);
  std::vector<std::pair<Config, Config>> rates;
  for (std::ptrdiff_t k = 0; k < samples.size(); ++k)
    rates.emplace_back(samples.mean_speed(k), samples.acceleration(k));
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (Eigen::Index j = 0; j < kDof; ++j) {
      const bool joint = stated.last_joint || j + 1 < kDof;
      if (!stated.v || !joint) rows[k].v[j] = rates[k].first[j];
      if (!stated.a || !joint) rows[k].a[j] = rates[k].second[j];
    }
}

}  // namespace swivel
