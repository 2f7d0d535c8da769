// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/equations/alignment.hpp"

#include <cmath>
#include <cstddef>

#include "swivel/core/base/angle.hpp"

namespace swivel {

namespace {

constexpr double kMeets = 1e-4;  // m, rad: axes this near a common point or direction make a triple

/// Adds the values of a triple's middle joint at which the axes on both sides of it are parallel.
void add_alignments(const Chain& chain, int first, std::vector<Alignment>& out) {
  const auto f = static_cast<std::size_t>(first);
  const Vector3d &a = chain.axis[f], &b = chain.axis[f + 1], &c = chain.axis[f + 2];
  const Vector3d along = b.dot(c) * b, across = c - along, aside = b.cross(c);
  // det(a, b, c) vanishes where across and aside together lie in the plane of a and b.
  const Vector3d normal = a.cross(b);
  const double angle = std::atan2(-normal.dot(across), normal.dot(aside));
  for (const double x : {angle, angle + kPi}) {
    const Vector3d turned = along + std::cos(x) * across + std::sin(x) * aside;
    if (a.cross(turned).norm() < kMeets) out.push_back({first + 1, wrap_angle(x)});
  }
}

}  // namespace

std::vector<Alignment> alignments_of(const Chain& chain) {
  std::vector<Alignment> result;
  const auto distance = [&](std::size_t i, const Vector3d& p) {
    const Vector3d d = p - chain.point[i];
    return (d - chain.axis[i].dot(d) * chain.axis[i]).norm();
  };
  const int slide = chain.slide();
  const std::size_t joints = chain.coordinates();
  // What axes in a row have in common is of no use where one of them slides.
  const auto turn = [&](std::size_t first, std::size_t last) {
    return slide < static_cast<int>(first) || slide > static_cast<int>(last);
  };
  for (std::size_t k = 0; k + 2 < joints; ++k) {
    if (!turn(k, k + 2)) continue;
    // Where axes k and k + 1 come nearest; do all three meet there?
    const Vector3d &a = chain.axis[k], &b = chain.axis[k + 1];
    const double sine2 = a.cross(b).squaredNorm();
    if (sine2 < 1e-6) continue;
    const Vector3d d = chain.point[k + 1] - chain.point[k];
    const Vector3d meet = chain.point[k] + (d.cross(b).dot(a.cross(b)) / sine2) * a;
    if (distance(k + 1, meet) < kMeets && distance(k + 2, meet) < kMeets)
      add_alignments(chain, static_cast<int>(k), result);
  }
  for (std::size_t k = 0; k + 2 < joints; ++k) {
    if (!turn(k, k + 2)) continue;
    if (chain.axis[k].cross(chain.axis[k + 1]).norm() > kMeets ||
        chain.axis[k].cross(chain.axis[k + 2]).norm() > kMeets)
      continue;
    // A fourth axis parallel to these three, beyond one joint.
    if (k + 4 < joints && turn(k, k + 4)) add_alignments(chain, static_cast<int>(k) + 2, result);
    if (k >= 2 && turn(k - 2, k + 2)) add_alignments(chain, static_cast<int>(k) - 2, result);
  }
  return result;
}

const char* Alignment::where() const {
  return joint == 1 ? "shoulder" : joint < 4 ? "elbow" : "wrist";
}

double Alignment::away(const Config& q) const {
  return std::abs(wrap_angle(q[joint] - angle));
}

}  // namespace swivel
