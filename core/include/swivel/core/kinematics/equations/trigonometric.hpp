// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// An angle as the point (cosine, sine) of the unit circle.
struct Angle {
  double cosine = 1, sine = 0;
  /// Returns the angle of the direction (x, y); 0 where both vanish.
  [[nodiscard]] static Angle of(double x, double y) {
    const double length = std::sqrt(x * x + y * y);
    return length > 0 ? Angle{x / length, y / length} : Angle{};
  }
  /// Returns the angle of so many radians.
  [[nodiscard]] static Angle of(double radians) { return {std::cos(radians), std::sin(radians)}; }
  /// Returns the angle in radians, in (-pi, pi].
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

/// The function constant + cosine cos(x) + sine sin(x).
struct Wave {
  double constant = 0, cosine = 0, sine = 0;
  [[nodiscard]] double operator()(const Angle& x) const {
    return constant + cosine * x.cosine + sine * x.sine;
  }
};

/// The function constant + cosine cos(x) + sine sin(x) + cosine2 cos(2x) + sine2 sin(2x).
struct Wave2 {
  double constant = 0, cosine = 0, sine = 0, cosine2 = 0, sine2 = 0;
  /// Adds factor * w^2 to this function.
  void add_square(double factor, const Wave& w);
};

/// Roots of a Wave (at most two) or Wave2 (at most four).
struct Roots {
  std::array<Angle, 4> angle;
  int count = 0;
  [[nodiscard]] const Angle* begin() const { return angle.data(); }
  [[nodiscard]] const Angle* end() const { return angle.data() + count; }
};
/// Returns the roots of a wave. A pair of complex roots whose discriminant is within `slack`
/// (relative) of zero gives two real roots, as far apart as the pair: they are starts for an
/// iteration. A wave that vanishes everywhere gives the representatives 0 and pi.
[[nodiscard]] Roots roots(const Wave& wave, double slack);
/// Returns the roots of a second-order wave, in the order of angles from -pi to pi, by the quartic
/// in the tangent of the half angle (Ferrari); of five origins of the angle it takes the one that
/// keeps roots farthest from infinity. Nearly real pairs count as real as for a Wave (`slack`); a
/// wave that vanishes gives 0 and pi. Uses + - * / and sqrt alone.
[[nodiscard]] Roots roots(const Wave2& wave, double slack);

}  // namespace swivel
