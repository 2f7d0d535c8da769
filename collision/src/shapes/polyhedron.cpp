// SPDX-License-Identifier: BSD-3-Clause
#include "shapes/polyhedron.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace swivel::detail {

namespace {

constexpr int kSides = 32;

Vector3d at(const TriangleMesh& mesh, int vertex) {
  return mesh.vertices[vertex];
}

}  // namespace

std::vector<std::array<int, 3>> triangles_with_area(const TriangleMesh& mesh) {
  constexpr double kLeastHeight = 1e-9;
  std::vector<std::array<int, 3>> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Vector3d ab = at(mesh, t[1]) - at(mesh, t[0]), ac = at(mesh, t[2]) - at(mesh, t[0]);
    const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    if (ab.cross(ac).norm() > kLeastHeight * longest) triangles.push_back(t);
  }
  return triangles;
}

std::unique_ptr<const TriangleTree> tree_of(const TriangleMesh& mesh,
                                            const std::vector<std::array<int, 3>>& some) {
  std::vector<Triangle> triangles;
  triangles.reserve(some.size());
  for (const auto& t : some) triangles.emplace_back(at(mesh, t[0]), at(mesh, t[1]), at(mesh, t[2]));
  return triangles.empty() ? nullptr : std::make_unique<const TriangleTree>(std::move(triangles));
}

TriangleMesh surface_of(const Box& box) {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.vertices.push_back(
        Vector3d(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1).cwiseProduct(box.size / 2));
  constexpr std::array<std::array<int, 4>, 6> kFaces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& f : kFaces)
    mesh.triangles.insert(mesh.triangles.end(), {{f[0], f[1], f[2]}, {f[0], f[2], f[3]}});
  return mesh;
}

TriangleMesh surface_of(const Cylinder& cylinder) {
  TriangleMesh mesh;
  for (int k = 0; k < kSides; ++k) {
    const double angle = kTwoPi * k / kSides, x = cylinder.radius * std::cos(angle),
                 y = cylinder.radius * std::sin(angle);
    mesh.vertices.emplace_back(x, y, -cylinder.length / 2);
    mesh.vertices.emplace_back(x, y, cylinder.length / 2);
    const int low = 2 * k, next = 2 * ((k + 1) % kSides);
    mesh.triangles.insert(mesh.triangles.end(), {{low, next, next + 1}, {low, next + 1, low + 1}});
    if (k >= 2)
      mesh.triangles.insert(mesh.triangles.end(), {{0, low, low - 2}, {1, low - 1, low + 1}});
  }
  return mesh;
}

double beyond_prism(const Cylinder& cylinder) {
  return cylinder.radius * (1 - std::cos(kPi / kSides));
}

}  // namespace swivel::detail
