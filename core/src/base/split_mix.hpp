// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

namespace swivel {

/// A pseudo-random generator whose every output is a mix of a counter. Source: Steele, Lea, Flood,
/// Fast splittable pseudorandom number generators, OOPSLA 2014.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t state) : state_(state) {}
  /// Begins the k-th of the independent sequences of a seed.
  SplitMix64(std::uint64_t seed, std::uint64_t k) : state_(SplitMix64(seed).next() ^ k) {
    next();  // one more mix, so that neighbouring sequences share nothing
  }
  /// Returns the next 64 random bits.
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  /// Returns the next random number, uniform in [-1, 1).
  double symmetric() { return static_cast<double>(next() >> 11) * 0x1.0p-52 - 1.0; }

 private:
  std::uint64_t state_;
};

}  // namespace swivel
