// SPDX-License-Identifier: BSD-3-Clause
#include "check_rates.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstddef>
#include <cstdio>

namespace swivel {

namespace {

[[gnu::format(printf, 1, 2)]] std::string line(const char* format, ...) {
  char text[400];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

}  // namespace

CheckResult::Motion examine_rates(const Chain& chain, const Limits& limits, const std::string& source,
                                  const std::vector<TimedRow>& rows, const std::vector<Pose>& tools,
                                  const std::function<void(const std::string&)>& fail) {
  const JointRates rates = joint_rates(chain, limits, source);
  CheckResult::Motion motion;
  motion.duration = rows.back().t - rows.front().t;
  // Two rows of rest on both sides, as far apart as the rows there.
  const auto n = static_cast<std::ptrdiff_t>(rows.size());
  const auto at = [&](std::ptrdiff_t k) -> const TimedRow& {
    return rows[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, n - 1))];
  };
  const auto time = [&](std::ptrdiff_t k) {
    if (k < 0) return at(0).t + static_cast<double>(k) * (at(1).t - at(0).t);
    return k < n ? at(k).t : at(n - 1).t + static_cast<double>(k - n + 1) * (at(n - 1).t - at(n - 2).t);
  };
  const char* const names[] = {"speed", "acceleration", "jerk"};
  const Config* const bounds[] = {&rates.speed, &rates.acceleration, &rates.jerk};
  for (std::ptrdiff_t k = -2; k < n + 2; ++k) {
    const auto difference = [&](std::ptrdiff_t i) -> Config { return (at(i + 1).row.q - at(i).row.q) / (time(i + 1) - time(i)); };
    const auto second = [&](std::ptrdiff_t i) -> Config {
      return 2 * (difference(i + 1) - difference(i)) / (time(i + 2) - time(i));
    };
    const Config by_order[] = {difference(k), second(k), 3 * (second(k + 1) - second(k)) / (time(k + 3) - time(k))};
    for (std::size_t order = 0; order < 3; ++order)
      for (int j = 0; j < kDof; ++j) {
        const double ratio = std::abs(by_order[order][j]) / (*bounds[order])[j];
        if (!(ratio <= 1 + 1e-6))
          fail(line("t = %.6g s: %s of joint '%s' is %.6g times what it can do", time(k), names[order],
                    chain.joint_names[static_cast<std::size_t>(j)].c_str(), ratio));
        if (ratio > motion.peaks[order].ratio) motion.peaks[order] = {ratio, j, time(k)};
      }
    if (k < 1 || k + 1 >= n) continue;
    const double dt = std::max(time(k + 1) - time(k), time(k) - time(k - 1));
    const Config v = (at(k + 1).row.q - at(k - 1).row.q) / (time(k + 1) - time(k - 1)), a = second(k - 1);
    for (int j = 0; j < kDof; ++j) {
      if (!(std::abs(at(k).v[j] - v[j]) <= rates.acceleration[j] * dt + 1e-6) ||
          !(std::abs(at(k).a[j] - a[j]) <= rates.jerk[j] * dt + 1e-3))
        fail(line("t = %.6g s: joint '%s' is said to have %.6g rad/s and %.6g rad/s^2, its positions say %.6g and %.6g", time(k),
                  chain.joint_names[static_cast<std::size_t>(j)].c_str(), at(k).v[j], at(k).a[j], v[j], a[j]));
    }
  }
  for (std::ptrdiff_t k = 1; k < n; ++k) {
    const double dt = time(k) - time(k - 1);
    const Pose &from = tools[static_cast<std::size_t>(k - 1)], &to = tools[static_cast<std::size_t>(k)];
    motion.tool_speed = std::max(motion.tool_speed, (to.translation() - from.translation()).norm() / dt);
    motion.turn_speed = std::max(motion.turn_speed, Eigen::AngleAxisd(from.linear().transpose() * to.linear()).angle() / dt);
  }
  if (limits.tool_speed && !(motion.tool_speed <= 1.001 * *limits.tool_speed))
    fail(line("the tool moves at up to %.6g m/s: limits.tool_speed is %.6g", motion.tool_speed, *limits.tool_speed));
  if (limits.tool_turn_speed && !(motion.turn_speed <= 1.001 * *limits.tool_turn_speed))
    fail(line("the tool turns at up to %.6g rad/s: limits.tool_turn_speed is %.6g", motion.turn_speed, *limits.tool_turn_speed));
  return motion;
}

}  // namespace swivel
