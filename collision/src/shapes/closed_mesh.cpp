// SPDX-License-Identifier: BSD-3-Clause
#include "shapes/closed_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "swivel/core/problem/shape.hpp"

namespace swivel::detail {

namespace {

bool before(const Vector3d& a, const Vector3d& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// Returns the (v, w) at which the edge from a to b (a before b, a.u <= u < b.u) crosses the plane
/// of this u.
Eigen::Vector2d crossing(const Vector3d& a, const Vector3d& b, double u) {
  const double t = (u - a.x()) / (b.x() - a.x());
  return a.tail<2>() + t * (b.tail<2>() - a.tail<2>());
}

/// Returns true if the ray from p towards +w crosses the triangle. The test is half open in u and
/// v, so that a ray through an edge or a corner counts as if p were moved by an infinitesimal step.
bool ray_crosses(const std::array<Vector3d, 3>& c, const Vector3d& p) {
  const double u = p.x();
  if (u < c[0].x() || u >= c[2].x()) return false;
  const Eigen::Vector2d far_side = crossing(c[0], c[2], u);
  const Eigen::Vector2d near_side =
      u < c[1].x() ? crossing(c[0], c[1], u) : crossing(c[1], c[2], u);
  if ((far_side.x() > p.y()) == (near_side.x() > p.y())) return false;
  const double t = (p.y() - far_side.x()) / (near_side.x() - far_side.x());
  return far_side.y() + t * (near_side.y() - far_side.y()) > p.z();
}

}  // namespace

ClosedMesh::ClosedMesh(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& v : mesh.vertices) box.extend(v);
  box.sizes().minCoeff(&ray_axis_);

  corners_.reserve(mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = turned(mesh.vertices[triangle[k]]);
    std::sort(corners.begin(), corners.end(), before);
    for (const Vector3d& corner : corners) box_.extend(corner);
    corners_.push_back(corners);
  }

  const Vector3d size = box_.sizes().cwiseMax(1e-12);
  // About one triangle of each of the two sides of the body lies in a cell.
  const double cells = static_cast<double>(corners_.size());
  columns_ = static_cast<int>(std::clamp(std::sqrt(cells * size.x() / size.y()), 1.0, 4096.0));
  rows_ = std::clamp(static_cast<int>(cells / columns_), 1, 4096);
  columns_per_u_ = columns_ / size.x();
  rows_per_v_ = rows_ / size.y();

  const auto each_cell = [&](const Corners& c, const auto& visit) {
    const auto [low, high] = std::minmax({c[0].y(), c[1].y(), c[2].y()});
    for (int i = column(c[0].x()); i <= column(c[2].x()); ++i)
      for (int j = row(low); j <= row(high); ++j) visit(static_cast<std::size_t>(i) * rows_ + j);
  };
  first_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
  for (const Corners& c : corners_) each_cell(c, [&](std::size_t cell) { ++first_[cell + 1]; });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  members_.resize(first_.back());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (std::size_t k = 0; k < corners_.size(); ++k)
    each_cell(corners_[k], [&](std::size_t cell) { members_[next[cell]++] = static_cast<int>(k); });
}

Vector3d ClosedMesh::turned(const Vector3d& point) const {
  return {point[(ray_axis_ + 1) % 3], point[(ray_axis_ + 2) % 3], point[ray_axis_]};
}

int ClosedMesh::column(double u) const {
  return std::clamp(static_cast<int>((u - box_.min().x()) * columns_per_u_), 0, columns_ - 1);
}

int ClosedMesh::row(double v) const {
  return std::clamp(static_cast<int>((v - box_.min().y()) * rows_per_v_), 0, rows_ - 1);
}

bool ClosedMesh::contains(const Vector3d& point) const {
  const Vector3d p = turned(point);
  if (!box_.contains(p)) return false;
  const std::size_t cell = static_cast<std::size_t>(column(p.x())) * rows_ + row(p.y());
  bool inside = false;
  for (int k = first_[cell]; k < first_[cell + 1]; ++k)
    inside ^= ray_crosses(corners_[members_[k]], p);
  return inside;
}

std::vector<Vector3d> one_point_per_part(const TriangleMesh& mesh) {
  const std::vector<int> number = vertex_numbers(mesh);
  std::vector<int> leader(number.size());
  std::iota(leader.begin(), leader.end(), 0);
  const auto root = [&](int vertex) {
    int v = number[vertex];
    while (leader[v] != v) {
      int& up = leader[v];
      up = leader[up];
      v = up;
    }
    return v;
  };
  for (const auto& triangle : mesh.triangles)
    for (const std::size_t k : {1u, 2u}) leader[root(triangle[k])] = root(triangle[0]);

  std::vector<bool> seen(leader.size(), false);
  std::vector<Vector3d> points;
  for (const auto& triangle : mesh.triangles) {
    const int part = root(triangle[0]);
    if (!seen[part]) points.push_back(mesh.vertices[triangle[0]]);
    seen[part] = true;
  }
  return points;
}

}  // namespace swivel::detail
