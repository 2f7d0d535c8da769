// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include "swivel/core/timing/time_path.hpp"

namespace swivel::test {

/// Keeps in `worst` the largest ratios of speed, acceleration and jerk to the rates allowed, of
/// rows that follow each other every `dt` s, by differences, at rest before and after. Returns the
/// number of differences.
inline int keep_worst_rates(const std::vector<TimedRow>& rows, double dt, const JointRates& rates,
                            double (&worst)[3]) {
  const auto n = static_cast<std::ptrdiff_t>(rows.size());
  const auto q = [&](std::ptrdiff_t k) {
    return rows[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, n - 1))].row.q;
  };
  const auto share = [](const Config& value, const Config& most) {
    return (value.coordinates().cwiseAbs().array() / most.coordinates().array()).maxCoeff();
  };
  int samples = 0;
  for (std::ptrdiff_t k = -3; k < n + 3; ++k) {
    const Config v = (q(k + 1) - q(k)) / dt, a = (q(k + 2) - 2 * q(k + 1) + q(k)) / (dt * dt),
                 j = (q(k + 3) - 3 * q(k + 2) + 3 * q(k + 1) - q(k)) / (dt * dt * dt);
    worst[0] = std::max(worst[0], share(v, rates.speed));
    worst[1] = std::max(worst[1], share(a, rates.acceleration));
    worst[2] = std::max(worst[2], share(j, rates.jerk));
    ++samples;
  }
  return samples;
}

}  // namespace swivel::test
