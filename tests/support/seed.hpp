// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace swivel::test {

/// Returns the seed of a property test and prints it, so that a failure can be repeated:
/// SWIVEL_TEST_SEED, or a constant. `./swivel test` draws it from the commit, so that each commit
/// tries other inputs.
inline std::uint64_t seed(const char* test) {
  const char* given = std::getenv("SWIVEL_TEST_SEED");
  const std::uint64_t value = given ? std::strtoull(given, nullptr, 10) : 20260701;
  std::printf("%s: SWIVEL_TEST_SEED=%llu\n", test, static_cast<unsigned long long>(value));
  return value;
}

/// Returns the share of a test's full number of trials that is run: SWIVEL_TEST_SCALE, or three
/// tenths. `.ci/more` runs them all.
inline double scale() {
  const char* given = std::getenv("SWIVEL_TEST_SCALE");
  return given ? std::atof(given) : 0.3;
}

/// Returns how many of `full` trials are run, at least one; SWIVEL_TEST_TRIALS where that is set.
inline int trials(int full) {
  if (const char* given = std::getenv("SWIVEL_TEST_TRIALS")) return std::atoi(given);
  return std::max(1, static_cast<int>(full * scale()));
}

/// Returns how many trials must have met something for a test to have tried it: `full` with all
/// trials, a quarter of their share with fewer, since seeds differ, and none with fewer than a
/// quarter of the trials.
inline int at_least(int full) {
  if (std::getenv("SWIVEL_TEST_TRIALS") || scale() < 0.25) return 0;
  return scale() < 1 ? static_cast<int>(full * scale() / 4) : full;
}

/// std::mt19937_64 with uniform doubles that do not depend on the standard library's distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed_value) : engine_(seed_value) {}
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1.0p-53);
  }
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
  bool coin(double p = 0.5) { return uniform(0, 1) < p; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace swivel::test
