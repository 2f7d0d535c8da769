// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/problem/shape.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace swivel {

std::vector<int> vertex_numbers(const TriangleMesh& mesh) {
  // An open-addressing hash table, at most half full: a place taken by another vertex leads to the
  // next place.
  const std::size_t places = std::bit_ceil(2 * mesh.vertices.size() + 1);
  std::vector<int> first(places, -1);  // vertex at the place; -1: none
  const auto place_of = [places](const Vector3d& p) {
    std::uint64_t hash = 0;
    for (const double x : p) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9e3779b97f4a7c15;
      hash ^= hash >> 32;
    }
    return hash & (places - 1);
  };
  std::vector<int> numbers;
  numbers.reserve(mesh.vertices.size());
  int known = 0;
  for (const Vector3d& p : mesh.vertices) {
    std::size_t place = place_of(p);
    while (first[place] >= 0 && mesh.vertices[static_cast<std::size_t>(first[place])] != p)
      place = (place + 1) & (places - 1);
    if (first[place] < 0) {
      first[place] = static_cast<int>(numbers.size());
      numbers.push_back(known++);
    } else {
      numbers.push_back(numbers[static_cast<std::size_t>(first[place])]);
    }
  }
  return numbers;
}

bool is_closed(const TriangleMesh& mesh) {
  const std::vector<int> number = vertex_numbers(mesh);
  std::vector<std::uint64_t> edges;  // ends, the lesser first, and whether it is walked from there
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    std::array<std::uint64_t, 3> v{};
    for (std::size_t k = 0; k < 3; ++k)
      v[k] = static_cast<std::uint64_t>(number[static_cast<std::size_t>(triangle[k])]);
    // a sliver has no area and bounds nothing
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t from = v[k], to = v[(k + 1) % 3];
      edges.push_back(std::min(from, to) << 33 | std::max(from, to) << 1 |
                      static_cast<std::uint64_t>(from < to));
    }
  }
  // A closed surface walks each edge once from either end.
  std::sort(edges.begin(), edges.end());
  bool closed = !edges.empty() && edges.size() % 2 == 0;
  for (std::size_t k = 0; closed && k < edges.size(); k += 2)
    closed = edges[k] % 2 == 0 && edges[k + 1] == edges[k] + 1;
  return closed;
}

std::vector<Ball> bounding_balls(const Shape& shape) {
  struct Visitor {
    std::vector<Ball> operator()(const Sphere& s) const { return {{Vector3d::Zero(), s.radius}}; }
    std::vector<Ball> operator()(const Capsule& c) const {
      return {{Vector3d(0, 0, -c.length / 2), c.radius}, {Vector3d(0, 0, c.length / 2), c.radius}};
    }
    std::vector<Ball> operator()(const Cylinder& c) const {
      return (*this)(Capsule{c.radius, c.length});
    }
    std::vector<Ball> operator()(const Box& b) const {
      std::vector<Ball> balls;
      for (int corner = 0; corner < 8; ++corner)
        balls.push_back({Vector3d(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1)
                             .cwiseProduct(b.size / 2),
                         0.0});
      return balls;
    }
    std::vector<Ball> operator()(const MeshPtr& mesh) const {
      std::vector<Ball> balls;
      balls.reserve(mesh->vertices.size());
      for (const Vector3d& v : mesh->vertices) balls.push_back({v, 0.0});
      return balls;
    }
  };
  return std::visit(Visitor{}, shape);
}

}  // namespace swivel
