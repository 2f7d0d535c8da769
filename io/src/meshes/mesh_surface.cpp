// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "files/bad_input.hpp"
#include "meshes/mesh_file.hpp"

namespace swivel::io {

void MeshFile::fail(int line, const std::string& what, const std::string& allowed) const {
  bad_input(at_line(name, line), what, allowed);
}

void Surface::add_point(double x, double y, double z, int line) {
  if (points_.size() >= 3 * kMostTriangles)
    file_.fail(line, "too many vertices", "at most " + std::to_string(3 * kMostTriangles));
  const Vector3d point =
      Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z))
          .cast<double>();
  if (!point.allFinite()) file_.fail(line, "a vertex is not finite", "finite coordinates");
  points_.push_back(point);
}

void Surface::add_triangle(int a, int b, int c, int line) {
  if (triangles_.size() >= kMostTriangles)
    file_.fail(line, "too many triangles", "at most " + std::to_string(kMostTriangles));
  triangles_.push_back({a, b, c});
}

void Surface::add_polygon(std::span<const std::int64_t> corners, int line) {
  const auto count = static_cast<std::int64_t>(points_.size());
  corners_.clear();
  for (const std::int64_t corner : corners) {
    if (corner < 0 || corner >= count)
      file_.fail(line,
                 "a face names vertex " + std::to_string(corner) + ", counted from 0, of " +
                     std::to_string(count),
                 "vertices that the file holds");
    corners_.push_back(static_cast<int>(corner));
  }
  if (corners_.size() < 3) return;
  if (corners_.size() == 3) return add_triangle(corners_[0], corners_[1], corners_[2], line);
  const std::size_t n = corners_.size();
  const auto point = [&](std::size_t k) -> const Vector3d& { return points_[corners_[k % n]]; };
  Vector3d normal = Vector3d::Zero();  // twice the area, whatever the polygon's form
  for (std::size_t k = 1; k + 1 < n; ++k)
    normal += (point(k) - point(0)).cross(point(k + 1) - point(0));
  bool convex = true;
  for (std::size_t k = 0; k < n && convex; ++k)
    convex = (point(k + 1) - point(k)).cross(point(k + 2) - point(k + 1)).dot(normal) >=
             -1e-9 * normal.squaredNorm();
  if (!convex) return cut(corners_, normal, line);
  for (std::size_t k = 1; k + 1 < n; ++k)
    add_triangle(corners_[0], corners_[k], corners_[k + 1], line);
}

void Surface::cut(std::vector<int> corners, const Vector3d& normal, int line) {
  constexpr std::size_t kMostWork = 50'000'000;
  const auto point = [&](int corner) -> const Vector3d& { return points_[corner]; };
  const auto left_of = [&](const Vector3d& a, const Vector3d& b, const Vector3d& p) {
    return (b - a).cross(p - a).dot(normal);
  };
  std::size_t k = 0, misses = 0;
  while (corners.size() > 3 && misses < corners.size()) {
    const std::size_t n = corners.size();
    if ((work_ += n) > kMostWork) file_.fail(line, "polygons with too many corners", "triangles");
    const std::size_t before = (k + n - 1) % n, after = (k + 1) % n;
    const Vector3d &a = point(corners[before]), &b = point(corners[k]), &c = point(corners[after]);
    const auto inside = [&](int corner) {
      const Vector3d& p = point(corner);
      return p != a && p != b && p != c && left_of(a, b, p) >= 0 && left_of(b, c, p) >= 0 &&
             left_of(c, a, p) >= 0;
    };
    if (left_of(a, b, c) > 0 && std::none_of(corners.begin(), corners.end(), inside)) {
      add_triangle(corners[before], corners[k], corners[after], line);
      corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(k));
      misses = 0;
    } else {
      ++misses;
    }
    k = (k + (misses > 0 ? 1 : 0)) % corners.size();
  }
  // A polygon without an ear is not simple; a fan covers it as well as anything.
  for (std::size_t j = 1; j + 1 < corners.size(); ++j)
    add_triangle(corners[0], corners[j], corners[j + 1], line);
}

}  // namespace swivel::io
