// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/equations/trigonometric.hpp"

#include <algorithm>
#include <cfloat>
#include <utility>

namespace swivel {

namespace {

/// Returns the largest real root of w^3 + p w + q, where q <= 0 or three roots are real: Newton
/// from a bound above it, where the cubic is convex.
double greatest_root(double p, double q) {
  double w = std::sqrt(std::max(0.0, -p));
  if (q < 0) {  // plus a power of two above the cube root of -q
    int exponent = 0;
    std::frexp(q, &exponent);
    w += std::ldexp(1.0, exponent > 0 ? (exponent + 2) / 3 : exponent / 3);
  }
  for (int step = 0; step < 64; ++step) {
    const double slope = 3 * w * w + p;
    if (!(slope > 0)) break;
    const double next = w - ((w * w + p) * w + q) / slope;
    if (!(next < w)) break;
    w = next;
  }
  return w;
}

/// Returns the largest real root of z^3 + a z^2 + b z + c, known not to be negative.
double resolvent_root(double a, double b, double c) {
  const double shift = -a / 3, p = b - a * a / 3, q = ((shift + a) * shift + b) * shift + c;
  const double turning = std::sqrt(std::max(0.0, -p / 3));  // where the local minimum is
  const bool three = q <= 2 * turning * turning * turning;
  return std::max(0.0, shift + (three ? greatest_root(p, q) : -greatest_root(p, -q)));
}

struct Monic {
  double a, b, c, d;  // t^4 + a t^3 + b t^2 + c t + d
};

/// Improves a root by up to two Newton steps, each taken only where it lessens the value.
double polished(const Monic& f, double t) {
  double value = (((t + f.a) * t + f.b) * t + f.c) * t + f.d;
  for (int step = 0; step < 2; ++step) {
    const double slope = ((4 * t + 3 * f.a) * t + 2 * f.b) * t + f.c;
    if (slope == 0) break;
    const double next = t - value / slope;
    const double next_value = (((next + f.a) * next + f.b) * next + f.c) * next + f.d;
    if (!(std::abs(next_value) < std::abs(value)) || std::abs(next - t) > 0.1 * (1 + t * t)) break;
    t = next;
    value = next_value;
  }
  return t;
}

/// Appends the real or nearly real roots of t^2 + p t + q, a factor of f.
void quadratic(double p, double q, const Monic& f, double slack, std::array<double, 4>& root,
               int& count) {
  const auto at = [&] { return static_cast<std::size_t>(count++); };
  const double middle = -p / 2, discriminant = middle * middle - q;
  if (discriminant >= 0) {
    const double far = middle + std::copysign(std::sqrt(discriminant), middle);
    root[at()] = polished(f, far);
    root[at()] = polished(f, far == 0 ? 0.0 : q / far);
    return;
  }
  // d(angle) = 2 dt / (1 + t^2).
  const double unit = (1 + middle * middle) / 2;
  if (-discriminant > slack * unit * unit) return;
  const double half = std::sqrt(-discriminant);
  root[at()] = middle - half;
  root[at()] = middle + half;
}

/// Returns a number that grows with the angle from -pi to pi.
double order(const Angle& x) {
  return std::copysign(1 - x.cosine, x.sine);
}

Roots everywhere() {
  Roots result;
  result.angle[0] = {1, 0};
  result.angle[1] = {-1, 0};
  result.count = 2;
  return result;
}

}  // namespace

void Wave2::add_square(double factor, const Wave& w) {
  const double c2 = w.cosine * w.cosine, s2 = w.sine * w.sine;
  constant += factor * (w.constant * w.constant + (c2 + s2) / 2);
  cosine += factor * (2 * w.constant * w.cosine);
  sine += factor * (2 * w.constant * w.sine);
  cosine2 += factor * ((c2 - s2) / 2);
  sine2 += factor * (w.cosine * w.sine);
}

Roots roots(const Wave& wave, double slack) {
  Roots result;
  const double square = wave.cosine * wave.cosine + wave.sine * wave.sine;
  const double amplitude = std::sqrt(square);
  if (amplitude < DBL_MIN) return wave.constant == 0 ? everywhere() : result;
  const double discriminant = (amplitude - wave.constant) * (amplitude + wave.constant);
  if (discriminant < -slack * square) return result;
  const double half = std::sqrt(std::abs(discriminant)), c = -wave.constant * wave.cosine,
               s = -wave.constant * wave.sine;
  result.angle[0] = Angle::of(c - half * wave.sine, s + half * wave.cosine);
  result.angle[1] = Angle::of(c + half * wave.sine, s - half * wave.cosine);
  result.count = 2;
  return result;
}

Roots roots(const Wave2& wave, double slack) {
  constexpr double c1 = 0.30901699437494742, s1 = 0.95105651629515357;   // of 72 deg
  constexpr double c2 = -0.80901699437494742, s2 = 0.58778525229247313;  // of 144 deg
  static constexpr std::array<Angle, 5> kOrigin = {
      {{1, 0}, {c1, s1}, {c2, s2}, {c2, -s2}, {c1, -s1}}};
  static constexpr std::array<Angle, 5> kDouble = {
      {{1, 0}, {c2, s2}, {c1, -s1}, {c1, s1}, {c2, -s2}}};
  // The leading coefficient is the value opposite the origin.
  double leading = 0;
  std::size_t best = 0;
  for (std::size_t k = 0; k < 5; ++k) {
    const double value = wave.constant - wave.cosine * kOrigin[k].cosine -
                         wave.sine * kOrigin[k].sine + wave.cosine2 * kDouble[k].cosine +
                         wave.sine2 * kDouble[k].sine;
    if (std::abs(value) > std::abs(leading)) {
      leading = value;
      best = k;
    }
  }
  if (leading == 0) return everywhere();
  const Angle origin = kOrigin[best], twice = kDouble[best];
  const double p0 = wave.constant;
  const double p1 = wave.cosine * origin.cosine + wave.sine * origin.sine;
  const double p2 = wave.sine * origin.cosine - wave.cosine * origin.sine;
  const double p3 = wave.cosine2 * twice.cosine + wave.sine2 * twice.sine;
  const double p4 = wave.sine2 * twice.cosine - wave.cosine2 * twice.sine;
  const double inverse = 1 / (p0 - p1 + p3);
  const Monic f = {(2 * p2 - 4 * p4) * inverse, (2 * p0 - 6 * p3) * inverse,
                   (2 * p2 + 4 * p4) * inverse, (p0 + p1 + p3) * inverse};

  // Ferrari: t = y - a/4 and y^4 + p y^2 + q y + r = (y^2 + u y + v)(y^2 - u y + w).
  const double quarter = f.a / 4, a2 = quarter * quarter;
  const double p = f.b - 6 * a2, q = f.c - 2 * f.b * quarter + 8 * a2 * quarter,
               r = f.d - f.c * quarter + f.b * a2 - 3 * a2 * a2;
  const double u2 = resolvent_root(2 * p, p * p - 4 * r, -q * q), u = std::sqrt(u2);
  const double sum = p + u2, square = sum * sum - 4 * r;
  // w - v can be computed in two ways: one cancels where u is small, the other where v and w are
  // nearly equal.
  const double difference = square > 0.01 * (sum * sum + 4 * std::abs(r)) || u == 0
                                ? std::copysign(std::sqrt(std::max(0.0, square)), q)
                                : q / u;
  std::array<double, 4> t{};
  int count = 0;
  quadratic(2 * quarter + u, a2 + u * quarter + (sum - difference) / 2, f, slack, t, count);
  quadratic(2 * quarter - u, a2 - u * quarter + (sum + difference) / 2, f, slack, t, count);
  Roots result;
  result.count = count;
  for (int k = 0; k < count; ++k) {
    const double x = t[static_cast<std::size_t>(k)], unit = 1 / (1 + x * x);
    result.angle[static_cast<std::size_t>(k)] = origin + Angle{(1 - x * x) * unit, 2 * x * unit};
  }
  for (std::size_t k = 1; k < 4; ++k)  // four at most: insertion
    for (std::size_t j = k; k < static_cast<std::size_t>(count) && j > 0 &&
                            order(result.angle[j]) < order(result.angle[j - 1]);
         --j)
      std::swap(result.angle[j], result.angle[j - 1]);
  return result;
}

}  // namespace swivel
