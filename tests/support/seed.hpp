// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
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

/// Returns the share of the usual trials that SWIVEL_TEST_SCALE asks for (0.1: a tenth), 1 where it
/// is not given.
inline double scale() {
  const char* given = std::getenv("SWIVEL_TEST_SCALE");
  return given ? std::atof(given) : 1;
}

/// Returns how many trials to run: SWIVEL_TEST_TRIALS, or scale() times the usual number, rounded
/// up, at least one.
inline int trials(int usual) {
  if (const char* given = std::getenv("SWIVEL_TEST_TRIALS")) return std::atoi(given);
  return std::max(1, static_cast<int>(std::ceil(usual * scale() - 1e-9)));
}

/// Returns how many of the trials that run must have met something, for a test to have tried it,
/// where `expected` of them are asked for at the full scale: half of that at a scale of a quarter
/// or more, since chance has more to say among few, and none below or where SWIVEL_TEST_TRIALS is
/// given.
inline int at_least_among(int expected) {
  if (std::getenv("SWIVEL_TEST_TRIALS") || scale() < 0.25) return 0;
  return scale() < 1 ? expected / 2 : expected;
}

/// Returns at_least_among() of a number that holds for all usual trials: `usual` of them at the
/// full scale, half of scale() times as many at a quarter or more.
inline int at_least(int usual) {
  return at_least_among(static_cast<int>(usual * std::min(1.0, scale())));
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
  template <class T>
  T one_of(std::initializer_list<T> choices) {
    return choices.begin()[below(static_cast<int>(choices.size()))];
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace swivel::test
