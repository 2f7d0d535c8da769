// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/srs/limit_arcs.hpp"

#include <algorithm>
#include <cmath>

namespace swivel {

namespace {

constexpr double kRounding = 1e-12;  // rad, by which a whole turn may fall short
constexpr double kDoubtful = 1e-6;   // shorter vectors do not tell on which side they lie

/// Returns a number that grows with the angle from -pi to pi, and is as precise.
double order(const Angle& x) {
  const double part = x.sine / (std::abs(x.cosine) + std::abs(x.sine));
  if (x.cosine >= 0) return part;
  return x.sine >= 0 ? 2 - part : -2 - part;
}

/// Returns the angle half-way from a to b, counter-clockwise.
Angle between(const Angle& a, const Angle& b) {
  const double cosine = a.cosine * b.cosine + a.sine * b.sine,
               sine = a.cosine * b.sine - a.sine * b.cosine;
  // the sum vanishes at half a turn
  if (cosine < 0) return Angle::of(b.sine - a.sine, a.cosine - b.cosine);
  const double sign = sine >= 0 ? 1 : -1;
  return Angle::of(sign * (a.cosine + b.cosine), sign * (a.sine + b.sine));
}

/// Returns the value of a row of a circle at an arm angle.
double value(const std::array<double, 3>& row, const Angle& phi) {
  return row[0] * phi.sine + row[1] * phi.cosine + row[2];
}

/// The arm angles at which a joint of a triple comes to an end of its range.
struct ArcEnds {
  static constexpr std::size_t kMost = 12;  // three joints, two ends of ranges, two roots
  struct End {
    double order;
    Angle phi;
  };
  std::array<End, kMost> at;
  std::size_t count = 0;

  void add(const Angle& phi) { at[count++] = {order(phi), phi}; }

  /// Adds the arm angles at which the rows p and q of a circle have the direction `end`.
  void add_meetings(const std::array<double, 3>& p, double p_sign, const std::array<double, 3>& q,
                    const Angle& end, double sign) {
    const double c = p_sign * end.sine, s = end.cosine;
    for (const Angle& phi :
         roots(Wave{c * p[2] - s * q[2], c * p[1] - s * q[1], c * p[0] - s * q[0]}, 0))
      if (sign * (p_sign * value(p, phi) * end.cosine + value(q, phi) * end.sine) > -kDoubtful)
        add(phi);
  }

  /// Sorts the ends from -pi to pi and drops repeated ones.
  void sort() {
    for (std::size_t k = 1; k < count; ++k)  // twelve at most: insertion
      for (std::size_t j = k; j > 0 && at[j].order < at[j - 1].order; --j)
        std::swap(at[j], at[j - 1]);
    const auto same = [](const End& a, const End& b) { return a.phi == b.phi; };
    count = static_cast<std::size_t>(
        std::unique(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(count), same) -
        at.begin());
  }

  /// Returns the number of the end after end k, counter-clockwise.
  [[nodiscard]] std::size_t next(std::size_t k) const { return k + 1 < count ? k + 1 : 0; }
};

/// Appends the arcs that the ends cut the circle of arm angles into, as far as they are within the
/// ranges: `inside[k]` says whether the angles from end k to the next one are.
void add_arcs(const ArcEnds& ends, const std::array<bool, ArcEnds::kMost>& inside,
              std::vector<AngleArc>& out) {
  const std::size_t count = ends.count;
  if (std::all_of(inside.begin(), inside.begin() + static_cast<std::ptrdiff_t>(count),
                  [](bool in) { return in; })) {
    out.push_back({-kPi, kPi});
    return;
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (!inside[k] || inside[k > 0 ? k - 1 : count - 1]) continue;  // no arc begins here
    std::size_t last = k;
    while (inside[last]) last = ends.next(last);
    AngleArc arc{ends.at[k].phi.radians(), ends.at[last].phi.radians()};
    if (arc.end <= arc.begin) arc.end += kTwoPi;
    out.push_back(arc);
  }
}

}  // namespace

AngleRange::AngleRange(double lower, double upper)
    : lower_(Angle::of(lower)),
      upper_(Angle::of(upper)),
      all_(upper - lower > kTwoPi - kRounding),
      none_(upper < lower),
      wide_(upper - lower > kPi) {}

bool AngleRange::holds(double x, double y) const {
  if (all_ || none_) return all_;
  const bool after = lower_.cosine * y - lower_.sine * x >= 0,
             before = x * upper_.sine - y * upper_.cosine >= 0;
  return wide_ ? after || before : after && before;
}

TripleLimits::TripleLimits(const std::array<std::array<double, 2>, 3>& ranges, double shift)
    : ranges_{AngleRange(ranges[0][0], ranges[0][1]),
              AngleRange(ranges[1][0] + shift, ranges[1][1] + shift),
              AngleRange(ranges[2][0], ranges[2][1])} {}

void TripleLimits::arcs(const TripleCircle& circle, bool negative,
                        std::vector<AngleArc>& out) const {
  out.clear();
  const double sign = negative ? -1 : 1;
  const auto &x = circle[0], &y = circle[1], &z = circle[2], &u = circle[3], &v = circle[4];
  const auto allowed = [&](const Angle& phi) {
    const double cosine = value(x, phi), sine = value(y, phi);
    return ranges_[0].holds(sign * cosine, sign * sine) &&
           ranges_[1].holds(value(z, phi), sign * std::sqrt(cosine * cosine + sine * sine)) &&
           ranges_[2].holds(-sign * value(u, phi), sign * value(v, phi));
  };

  ArcEnds ends;
  for (const auto end : {&AngleRange::lower, &AngleRange::upper}) {
    if (!ranges_[0].all()) ends.add_meetings(x, 1, y, (ranges_[0].*end)(), sign);
    if (!ranges_[2].all()) ends.add_meetings(u, -1, v, (ranges_[2].*end)(), sign);
    if (const Angle& middle = (ranges_[1].*end)();
        !ranges_[1].all() && sign * middle.sine > -kDoubtful)
      for (const Angle& phi : roots(Wave{z[2] - middle.cosine, z[1], z[0]}, 0)) ends.add(phi);
  }
  if (ends.count == 0) {
    if (allowed({1, 0})) out.push_back({-kPi, kPi});
    return;
  }
  ends.sort();

  // All angles between two neighbouring ends are within the ranges, or none is.
  std::array<bool, ArcEnds::kMost> inside{};
  for (std::size_t k = 0; k < ends.count; ++k) {
    const Angle& a = ends.at[k].phi;
    inside[k] = allowed(ends.count == 1 ? Angle{-a.cosine, -a.sine}
                                        : between(a, ends.at[ends.next(k)].phi));
  }
  add_arcs(ends, inside, out);
}

void common_arcs(const std::vector<AngleArc>& a, const std::vector<AngleArc>& b,
                 std::vector<AngleArc>& out) {
  out.clear();
  for (const AngleArc& one : a)
    for (const AngleArc& other : b) {
      if (one.whole() || other.whole()) {
        out.push_back(one.whole() ? other : one);
        continue;
      }
      for (const double turn : {-kTwoPi, 0.0, kTwoPi}) {
        AngleArc both{std::max(one.begin, other.begin + turn), std::min(one.end, other.end + turn)};
        if (!(both.begin <= both.end)) continue;
        if (both.begin > kPi) both.begin -= kTwoPi, both.end -= kTwoPi;
        if (both.begin < -kPi) both.begin += kTwoPi, both.end += kTwoPi;
        out.push_back(both);
      }
    }
  std::sort(out.begin(), out.end(),
            [](const AngleArc& x, const AngleArc& y) { return x.begin < y.begin; });
}

}  // namespace swivel
