// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/shape.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <unordered_map>

#include "swivel/core/vertex_numbers.hpp"

namespace swivel {

std::vector<int> vertex_numbers(const TriangleMesh& mesh) {
  using Position = std::array<double, 3>;
  struct Hash {
    std::size_t operator()(const Position& p) const {
      const std::hash<double> hash;  // one of 0 and -0, which are equal
      return 31 * (31 * hash(p[0]) + hash(p[1])) + hash(p[2]);
    }
  };
  std::unordered_map<Position, int, Hash> known;
  known.reserve(mesh.vertices.size());
  std::vector<int> numbers;
  numbers.reserve(mesh.vertices.size());
  for (const Vector3d& p : mesh.vertices)
    numbers.push_back(known.try_emplace({p.x(), p.y(), p.z()}, static_cast<int>(known.size())).first->second);
  return numbers;
}

bool is_closed(const TriangleMesh& mesh) {
  const std::vector<int> number = vertex_numbers(mesh);
  struct Uses {
    int forth = 0, back = 0;
  };
  std::unordered_map<std::uint64_t, Uses> edges;  // by both ends, the lesser one first
  edges.reserve(3 * mesh.triangles.size() / 2);
  for (const auto& triangle : mesh.triangles) {
    std::array<int, 3> v{};
    for (std::size_t k = 0; k < 3; ++k) v[k] = number[static_cast<std::size_t>(triangle[k])];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;  // a sliver has no area and bounds nothing
    for (std::size_t k = 0; k < 3; ++k) {
      const auto from = static_cast<std::uint32_t>(v[k]), to = static_cast<std::uint32_t>(v[(k + 1) % 3]);
      Uses& uses = edges[std::uint64_t{std::min(from, to)} << 32 | std::max(from, to)];
      ++(from < to ? uses.forth : uses.back);
    }
  }
  return !edges.empty() &&
         std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second.forth == 1 && edge.second.back == 1; });
}

std::vector<Ball> bounding_balls(const Shape& shape) {
  struct Visitor {
    std::vector<Ball> operator()(const Sphere& s) const { return {{Vector3d::Zero(), s.radius}}; }
    std::vector<Ball> operator()(const Capsule& c) const {
      return {{Vector3d(0, 0, -c.length / 2), c.radius}, {Vector3d(0, 0, c.length / 2), c.radius}};
    }
    std::vector<Ball> operator()(const Cylinder& c) const { return (*this)(Capsule{c.radius, c.length}); }
    std::vector<Ball> operator()(const Box& b) const {
      std::vector<Ball> balls;
      for (int corner = 0; corner < 8; ++corner)
        balls.push_back({Vector3d(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1).cwiseProduct(b.size / 2), 0.0});
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
