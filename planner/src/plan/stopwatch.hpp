// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>

namespace swivel {

/// Measures the time of consecutive parts of a computation.
class Stopwatch {
 public:
  /// Returns the time since construction or the last lap, ms, and starts the next lap.
  double lap() {
    const auto now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

}  // namespace swivel
