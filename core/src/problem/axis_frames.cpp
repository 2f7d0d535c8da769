// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/problem/axis_frames.hpp"

#include <cmath>

namespace swivel {

namespace {

/// Returns the direction of the part of a vector perpendicular to the unit vector z.
Vector3d across(const Vector3d& vector, const Vector3d& z) {
  return (vector - vector.dot(z) * z).normalized();
}

}  // namespace

Vector3d carried_x(const Vector3d& x, const Vector3d& z, const Vector3d& to) {
  constexpr double kOpposite = 1e-6;  // rad from 180 deg
  if (z == to) return x;
  if ((z + to).norm() <= kOpposite) return across(x, to);
  return across(x - x.dot(to) / (1 + z.dot(to)) * (z + to), to);
}

void carry_frames(std::vector<Waypoint>& waypoints) {
  constexpr double kAcross = 0.1;      // of the length of a way
  constexpr double kSamePlace = 1e-9;  // m
  constexpr double kAlongX = 0.9;      // cosine
  std::vector<Vector3d> z, x(waypoints.size());
  for (const Waypoint& waypoint : waypoints)
    z.push_back((waypoint.orientation * Vector3d::UnitZ()).normalized());
  std::size_t first = 0;
  x[0] = across(std::abs(z[0].x()) > kAlongX ? Vector3d::UnitY() : Vector3d::UnitX(), z[0]);
  for (std::size_t k = 0; k + 1 < waypoints.size(); ++k) {
    const Vector3d way = waypoints[k + 1].position - waypoints[k].position;
    const double length = way.norm();
    if (length <= kSamePlace || way.cross(z[k]).norm() < kAcross * length) continue;
    x[first = k] = across(way, z[k]);
    break;
  }
  for (std::size_t k = first; k-- > 0;) x[k] = carried_x(x[k + 1], z[k + 1], z[k]);
  for (std::size_t k = first + 1; k < x.size(); ++k) x[k] = carried_x(x[k - 1], z[k - 1], z[k]);
  for (std::size_t k = 0; k < x.size(); ++k) {
    Matrix3d frame;
    frame << x[k], z[k].cross(x[k]), z[k];
    waypoints[k].orientation = Quaterniond(frame).normalized();
  }
}

}  // namespace swivel
