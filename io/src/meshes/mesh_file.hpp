// SPDX-License-Identifier: BSD-3-Clause
// Readers of mesh files. They are our own since the files come from anywhere: assimp aborts, hangs or takes gigabytes on broken
// ones.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "swivel/core/base/types.hpp"

namespace swivel::io {

inline constexpr std::size_t kMostTriangles = 2'000'000;  ///< of one mesh file, all its parts together

/// A mesh file in memory.
struct MeshFile {
  std::string name, text;
  /// Throws InputError; line < 1 where it is unknown.
  [[noreturn]] void fail(int line, const std::string& what, const std::string& allowed) const;
};

/// A word for messages, in quotes. Of one of hundreds of megabytes the beginning is enough.
inline std::string quoted(std::string_view word) {
  return "'" + std::string(word.substr(0, 400)) + "'";
}

/// Points and triangles over them. Coordinates are rounded to single precision, which is what most mesh files hold: corners of text
/// files that differ by less are one, so that a solid stays closed.
class Surface {
 public:
  explicit Surface(const MeshFile& file) : file_(file) {}

  /// `line`: for messages, as below.
  void add_point(double x, double y, double z, int line);
  /// Cuts a polygon into triangles; fewer than three corners are a point or a line, and left out. `corners`: indices of points.
  void add_polygon(std::span<const std::int64_t> corners, int line);

  [[nodiscard]] const std::vector<Vector3d>& points() const { return points_; }
  [[nodiscard]] const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }

 private:
  void add_triangle(int a, int b, int c, int line);
  /// Cuts off ears (Meisters 1975).
  void cut(std::vector<int> corners, const Vector3d& normal, int line);

  const MeshFile& file_;
  std::vector<Vector3d> points_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<int> corners_;
  std::size_t work_ = 0;
};

/// Called for each surface of a file, with its pose in the file's frame.
using PlaceSurface = std::function<void(const Surface&, const Eigen::Affine3d&)>;

void read_stl(const MeshFile& file, const PlaceSurface& place);
void read_obj(const MeshFile& file, const PlaceSurface& place);
void read_ply(const MeshFile& file, const PlaceSurface& place);
/// Vertices as stored, whatever the file calls "up": that is how ROS tools read them, and URDFs are written for it.
void read_dae(const MeshFile& file, const PlaceSurface& place);

}  // namespace swivel::io
