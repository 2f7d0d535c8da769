// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// An angle as the point (cosine, sine) of the unit circle.
struct Angle {
  double cosine = 1, sine = 0;
  /// In the direction of (x, y); 0 where both vanish.
  [[nodiscard]] static Angle of(double x, double y) {
    const double length = std::sqrt(x * x + y * y);
    return length > 0 ? Angle{x / length, y / length} : Angle{};
  }
  [[nodiscard]] static Angle of(double radians) { return {std::cos(radians), std::sin(radians)}; }
  /// In (-pi, pi].
  [[nodiscard]] double radians() const {
    const double angle = std::atan2(sine, cosine);
    return angle > -kPi ? angle : kPi;
  }
  [[nodiscard]] bool operator==(const Angle&) const = default;
  [[nodiscard]] Angle operator-() const { return {cosine, -sine}; }
  [[nodiscard]] Angle operator+(const Angle& b) const {
    return {cosine * b.cosine - sine * b.sine, sine * b.cosine + cosine * b.sine};
  }
};

/// constant + cosine cos(x) + sine sin(x).
struct Wave {
  double constant = 0, cosine = 0, sine = 0;
  [[nodiscard]] double operator()(const Angle& x) const { return constant + cosine * x.cosine + sine * x.sine; }
};

/// constant + cosine cos(x) + sine sin(x) + cosine2 cos(2x) + sine2 sin(2x).
struct Wave2 {
  double constant = 0, cosine = 0, sine = 0, cosine2 = 0, sine2 = 0;
  /// Adds factor * w^2.
  void add_square(double factor, const Wave& w);
};

/// Roots of a wave: at most two or four. Where a pair is complex, but its imaginary part is so small that the discriminant lies
/// within `slack` (relative) of zero, it counts as two real roots as far apart: for starts of an iteration. A wave that vanishes
/// has the representatives 0 and pi.
struct Roots {
  std::array<Angle, 4> angle;
  int count = 0;
  [[nodiscard]] const Angle* begin() const { return angle.data(); }
  [[nodiscard]] const Angle* end() const { return angle.data() + count; }
};
[[nodiscard]] Roots roots(const Wave& wave, double slack);
/// By the quartic in the tangent of the half angle (Ferrari), from the origin, of five, that keeps roots farthest from infinity. In
/// the order of angles. Uses + - * / and sqrt alone.
[[nodiscard]] Roots roots(const Wave2& wave, double slack);

}  // namespace swivel
