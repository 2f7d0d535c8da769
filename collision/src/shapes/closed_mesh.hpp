// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "swivel/core/problem/shape.hpp"

namespace swivel::detail {

/// Tells whether points lie inside a closed mesh. A ray from a point inside crosses the surface an
/// odd number of times, a ray from outside an even number. Points on the surface may be classified
/// either way.
/// The ray runs along the mesh's thinnest side; a grid over the other two axes lists the triangles
/// it may cross. Triangles that share an edge compute bit-identical crossings of that edge, so that
/// no ray slips between them and no tolerance is needed.
class ClosedMesh {
 public:
  explicit ClosedMesh(const TriangleMesh& mesh);
  /// Returns true if the point, in the mesh's own frame, lies inside the mesh.
  [[nodiscard]] bool contains(const Vector3d& point) const;

 private:
  /// coordinates (u, v, w), w along the ray; in lexicographic order
  using Corners = std::array<Vector3d, 3>;
  [[nodiscard]] Vector3d turned(const Vector3d& point) const;
  [[nodiscard]] int column(double u) const;
  [[nodiscard]] int row(double v) const;

  int ray_axis_ = 2;
  Eigen::AlignedBox3d box_;  ///< in (u, v, w)
  int columns_ = 1, rows_ = 1;
  double columns_per_u_ = 0, rows_per_v_ = 0;
  std::vector<int> first_;    ///< of each cell, in members_; one more at the end
  std::vector<int> members_;  ///< indices into corners_
  std::vector<Corners> corners_;
};

/// Returns one vertex of each connected part of the surface, in the mesh's frame. Vertices at equal
/// positions count as one.
[[nodiscard]] std::vector<Vector3d> one_point_per_part(const TriangleMesh& mesh);

}  // namespace swivel::detail
