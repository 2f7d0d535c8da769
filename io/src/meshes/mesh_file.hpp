// SPDX-License-Identifier: BSD-3-Clause
// Readers of mesh files. They are our own because files come from anywhere, and assimp aborts,
// hangs or takes gigabytes on broken ones.
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

/// of one mesh file, all its parts together
inline constexpr std::size_t kMostTriangles = 2'000'000;

/// A mesh file in memory.
struct MeshFile {
  std::string name, text;
  /// Throws InputError with file, line, what is wrong and what is allowed; line < 1 if it is
  /// unknown.
  [[noreturn]] void fail(int line, const std::string& what, const std::string& allowed) const;
};

/// Returns a word in quotes for messages, at most its first 400 bytes.
inline std::string quoted(std::string_view word) {
  return "'" + std::string(word.substr(0, 400)) + "'";
}

/// Points and triangles between them. Coordinates are rounded to single precision, which most mesh
/// files hold: corners in text files that differ by less become one, so that a solid stays closed.
class Surface {
 public:
  explicit Surface(const MeshFile& file) : file_(file) {}

  /// Adds a point, m. `line` is for messages. Throws InputError if it is not finite or there are
  /// too many.
  void add_point(double x, double y, double z, int line);
  /// Adds a polygon as triangles. `corners` are indices of points; fewer than three are ignored.
  /// `line` is for messages. Throws InputError for an unknown point and for too many triangles.
  void add_polygon(std::span<const std::int64_t> corners, int line);

  [[nodiscard]] const std::vector<Vector3d>& points() const { return points_; }
  [[nodiscard]] const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }

 private:
  void add_triangle(int a, int b, int c, int line);
  /// Cuts a polygon into triangles by cutting off ears (Meisters 1975).
  void cut(std::vector<int> corners, const Vector3d& normal, int line);

  const MeshFile& file_;
  std::vector<Vector3d> points_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<int> corners_;
  std::size_t work_ = 0;
};

/// A function that is called for each surface of a file, with its pose in the file's frame.
using PlaceSurface = std::function<void(const Surface&, const Eigen::Affine3d&)>;

/// Reads an STL file, binary or text. Throws InputError.
void read_stl(const MeshFile& file, const PlaceSurface& place);
/// Reads the points and faces of an OBJ file. Throws InputError.
void read_obj(const MeshFile& file, const PlaceSurface& place);
/// Reads the points and faces of a PLY file, binary or text. Throws InputError.
void read_ply(const MeshFile& file, const PlaceSurface& place);
/// Reads the triangles and polygons that the scene of a COLLADA file shows. Vertices stay as
/// stored, whichever axis the file calls "up": ROS tools read them so, and URDFs are written for
/// it. Throws InputError.
void read_dae(const MeshFile& file, const PlaceSurface& place);

}  // namespace swivel::io
