// SPDX-License-Identifier: BSD-3-Clause
#include "page/thinned.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <unordered_map>

namespace swivel::detail {

namespace {

/// Returns the mesh with one corner for all that lie in one cell of a grid of `cell` m.
MeshPtr on_grid(const TriangleMesh& mesh, const Vector3d& low, double cell) {
  const auto result = std::make_shared<TriangleMesh>();
  result->source = mesh.source;
  std::unordered_map<std::uint64_t, int> cells;  // number of a cell: its corner
  std::vector<int> corner_of, count;
  for (const Vector3d& vertex : mesh.vertices) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k)
      key = key << 21 | static_cast<std::uint64_t>((vertex[k] - low[k]) / cell);
    const auto [place, is_new] = cells.emplace(key, static_cast<int>(count.size()));
    if (is_new) {
      result->vertices.emplace_back(Vector3d::Zero());
      count.push_back(0);
    }
    result->vertices[static_cast<std::size_t>(place->second)] += vertex;
    ++count[static_cast<std::size_t>(place->second)];
    corner_of.push_back(place->second);
  }
  for (std::size_t k = 0; k < count.size(); ++k) result->vertices[k] /= count[k];
  std::set<std::array<int, 3>> known;
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    std::array<int, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = corner_of[static_cast<std::size_t>(triangle[k])];
    const auto [a, b, c] = corners;
    if (a == b || b == c || c == a) continue;
    std::ranges::rotate(corners, std::ranges::min_element(corners));
    if (known.insert(corners).second) result->triangles.push_back(corners);
  }
  return result;
}

}  // namespace

MeshPtr thinned(const MeshPtr& mesh, std::size_t most) {
  if (mesh->triangles.size() <= most) return mesh;
  Vector3d low = mesh->vertices.front(), high = low;
  for (const Vector3d& vertex : mesh->vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  const double edge = (high - low).maxCoeff();
  // A grid of n cells along the longest edge leaves some n^2 triangles.
  for (double n = 2 * std::sqrt(static_cast<double>(most)); n >= 2; n *= 0.8) {
    MeshPtr fewer = on_grid(*mesh, low, edge / n);
    if (fewer->triangles.size() <= most) return fewer;
  }
  return std::make_shared<const TriangleMesh>();
}

}  // namespace swivel::detail
