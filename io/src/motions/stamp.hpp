// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <cstdint>

namespace swivel::io {

/// A time in the form of ROS 2.
struct Stamp {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};
/// Returns the stamp of a time from 0 to 68 years, s, to the nearest nanosecond.
[[nodiscard]] inline Stamp stamp_of(double t) {
  const double whole = std::floor(t);
  const auto nanosec = static_cast<std::uint32_t>(std::llround((t - whole) * 1e9));
  if (nanosec == 1'000'000'000u) return {static_cast<std::int32_t>(whole) + 1, 0};
  return {static_cast<std::int32_t>(whole), nanosec};
}

}  // namespace swivel::io
