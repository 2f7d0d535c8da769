// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/shape.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "swivel/core/vertex_numbers.hpp"

namespace swivel {

std::vector<int> vertex_numbers(const TriangleMesh& mesh) {
  struct Corner {
    double x, y, z;
    int vertex;
  };
  std::vector<Corner> corners;
  corners.reserve(mesh.vertices.size());
  for (const Vector3d& p : mesh.vertices) corners.push_back({p.x(), p.y(), p.z(), static_cast<int>(corners.size())});
  const auto position = [](const Corner& c) { return std::tie(c.x, c.y, c.z); };
  std::sort(corners.begin(), corners.end(), [&](const Corner& s, const Corner& t) { return position(s) < position(t); });
  std::vector<int> numbers(corners.size());
  int number = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    number += k > 0 && position(corners[k - 1]) != position(corners[k]);
    numbers[static_cast<std::size_t>(corners[k].vertex)] = number;
  }
  return numbers;
}

bool is_closed(const TriangleMesh& mesh) {
  const std::vector<int> number = vertex_numbers(mesh);
  struct Edge {
    std::pair<int, int> ends;  // the lesser one first
    bool reversed;
    bool operator<(const Edge& other) const { return std::tie(ends, reversed) < std::tie(other.ends, other.reversed); }
  };
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    std::array<int, 3> v{};
    for (std::size_t k = 0; k < 3; ++k) v[k] = number[static_cast<std::size_t>(triangle[k])];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;  // a sliver has no area and bounds nothing
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = v[k], to = v[(k + 1) % 3];
      edges.push_back({std::minmax(from, to), from > to});
    }
  }
  if (edges.empty() || edges.size() % 2 != 0) return false;
  std::sort(edges.begin(), edges.end());
  for (std::size_t k = 0; k < edges.size(); k += 2) {  // each once in each direction
    if (edges[k].ends != edges[k + 1].ends || edges[k].reversed || !edges[k + 1].reversed) return false;
    if (k > 0 && edges[k - 1].ends == edges[k].ends) return false;
  }
  return true;
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
