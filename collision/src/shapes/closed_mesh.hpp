// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <vector>

#include "swivel/core/problem/shape.hpp"

namespace swivel::detail {

/// The inside of a closed mesh, for points that are not on its surface: a ray from the point leaves the solid as often as it
/// enters it, plus once if the point is inside.
/// The ray runs along the mesh's thinnest side; a grid over the other two lists the triangles it may cross. Triangles that share an
/// edge compute the same crossing of that edge, bit for bit, so that no ray slips between them and no tolerance is needed.
class ClosedMesh {
 public:
  explicit ClosedMesh(const TriangleMesh& mesh);
  /// Point in the mesh's own frame.
  [[nodiscard]] bool contains(const Vector3d& point) const;

 private:
  using Corners = std::array<Vector3d, 3>;  ///< coordinates (u, v, w), w along the ray; in lexicographic order
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

/// One vertex of each connected part of the surface, vertices at equal positions being one.
[[nodiscard]] std::vector<Vector3d> one_point_per_part(const TriangleMesh& mesh);

}  // namespace swivel::detail
