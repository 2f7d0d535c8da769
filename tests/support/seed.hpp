// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace swivel::test {

/// Seed of a property test: SWIVEL_TEST_SEED or a fixed default, printed so that a failure can be
/// repeated.
inline std::uint64_t seed(const char* test) {
  const char* given = std::getenv("SWIVEL_TEST_SEED");
  const std::uint64_t value = given ? std::strtoull(given, nullptr, 10) : 20260701;
  std::printf("%s: SWIVEL_TEST_SEED=%llu\n", test, static_cast<unsigned long long>(value));
  return value;
}

/// How many trials: SWIVEL_TEST_TRIALS, or SWIVEL_TEST_SCALE (0.1: a tenth) times the usual number,
/// at least one.
inline int trials(int usual) {
  if (const char* given = std::getenv("SWIVEL_TEST_TRIALS")) return std::atoi(given);
  const char* scale = std::getenv("SWIVEL_TEST_SCALE");
  return scale ? std::max(1, static_cast<int>(usual * std::atof(scale))) : usual;
}

/// How many of the trials must have met something, for a test to have tried it: nothing is asked of
/// fewer trials than usual.
inline int at_least(int usual) {
  return std::getenv("SWIVEL_TEST_TRIALS") || std::getenv("SWIVEL_TEST_SCALE") ? 0 : usual;
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
