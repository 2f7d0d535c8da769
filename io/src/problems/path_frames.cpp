// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "files/bad_input.hpp"
#include "files/files.hpp"
#include "problems/path_file.hpp"
#include "swivel/core/problem/axis_frames.hpp"
#include "swivel/io/problems/problem.hpp"

namespace swivel::io {

namespace {

constexpr double kNoDirection = 1e-6;  // length of an axis or a tangent that has no direction
constexpr double kAlong = 1e-3;        // rad between a tangent and the axis that it lies along
constexpr double kOpposite = 1e-6;     // rad from 180 deg at which two axes are opposite

/// Returns the direction of a vector. Throws InputError if it has none.
Vector3d direction(const Vector3d& vector, const std::string& where, const char* what) {
  const double length = vector.norm();
  if (!(length > kNoDirection))
    bad_input(where, std::string(what) + " has length " + format_double(length),
              "a direction, of any length above 1e-6");
  return vector / length;
}

/// Returns the part of a vector perpendicular to the unit vector z, with length 1; none if the
/// vector lies along z.
std::optional<Vector3d> across(const Vector3d& vector, const Vector3d& z) {
  const Vector3d part = vector - vector.dot(z) * z;
  const double length = part.norm();
  if (!(length > kAlong * vector.norm())) return std::nullopt;
  return (part / length).eval();
}

/// Returns a unit vector perpendicular to the unit vector z at point 0 of a path: along the way to
/// the next place, else along the axis of the frame that is least along z.
Vector3d first_x(const std::vector<AxisPoint>& points, const Vector3d& z) {
  for (const AxisPoint& point : points) {
    const Vector3d way = point.position - points.front().position;
    if (way.norm() <= 1e-9) continue;
    if (const auto x = across(way, z)) return *x;
    break;
  }
  Eigen::Index axis = 0;
  z.cwiseAbs().minCoeff(&axis);
  return *across(Vector3d::Unit(axis), z);
}

}  // namespace

std::vector<Quaterniond> tool_frames(const std::vector<AxisPoint>& points, bool either_side,
                                     const std::function<std::string(std::size_t)>& where) {
  std::vector<Quaterniond> frames;
  frames.reserve(points.size());
  Vector3d x = Vector3d::Zero(), z = Vector3d::Zero();  // of the tool at the point before
  for (std::size_t k = 0; k < points.size(); ++k) {
    const AxisPoint& point = points[k];
    const Vector3d axis = -direction(point.outward, where(k), "normal");
    std::optional<Vector3d> along;
    if (point.tangent) {
      along = across(direction(*point.tangent, where(k), "tangent"), axis);
      if (!along)
        bad_input(where(k), "tangent lies along the normal",
                  "a tangent at an angle to it, of which the part across the normal counts");
    }
    // sqrt(2 (1 + cos)) is the angle from 180 deg, for small ones
    if (k > 0 && (z + axis).norm() <= kOpposite)
      bad_input(where(k),
                "normal is opposite to the one before: which way the tool turns is undefined",
                "less than 180 deg from row to row");
    const Vector3d expected =
        k == 0 ? (along ? *along : first_x(points, axis)) : carried_x(x, z, axis);
    x = along ? *along : expected;
    if (along && either_side && x.dot(expected) < 0) x = -x;
    z = axis;
    Matrix3d frame;
    frame << x, z.cross(x), z;
    frames.emplace_back(frame);
    frames.back().normalize();
  }
  return frames;
}

void choose_sides(std::vector<Waypoint>& waypoints) {
  constexpr double kHalf = 1e-9;    // rad from 180 deg at which a turn has no way (tool_path.cpp)
  constexpr double kAboutZ = 1e-6;  // sine of the angle between the turn's axis and the tool's
  const Quaterniond half(0, 0, 0, 1);
  bool turned = false;
  for (std::size_t k = 1; k < waypoints.size(); ++k) {
    const Quaterniond given = waypoints[k].orientation.normalized();
    Quaterniond to = given;
    if (turned) to = to * half;
    const Quaterniond turn = waypoints[k - 1].orientation.normalized().conjugate() * to;
    const double sine = turn.vec().norm();
    const bool no_way = 2 * std::atan2(sine, std::abs(turn.w())) > kPi - kHalf;
    // About z the turn has a way, and where the axes are opposite no turn about z gives one.
    const double z = std::abs(turn.z());
    if (no_way && turn.vec().head<2>().norm() > kAboutZ && z > kAboutZ) {
      turned = !turned;
      to = turned ? given * half : given;
    }
    if (turned) waypoints[k].orientation = to;
  }
}

}  // namespace swivel::io
