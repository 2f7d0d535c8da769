// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/shape.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace swivel {

bool is_closed(const TriangleMesh& mesh) {
  // STL stores every corner anew, so equal positions are one vertex.
  std::map<std::tuple<double, double, double>, int> ids;
  const auto id = [&](int v) {
    const Vector3d& p = mesh.vertices[static_cast<std::size_t>(v)];
    return ids.try_emplace({p.x(), p.y(), p.z()}, static_cast<int>(ids.size())).first->second;
  };
  std::map<std::pair<int, int>, int> balance;  // +1 for a directed edge, -1 for its reverse
  std::map<std::pair<int, int>, int> uses;
  for (const auto& triangle : mesh.triangles) {
    const std::array<int, 3> v{id(triangle[0]), id(triangle[1]), id(triangle[2])};
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;  // a sliver has no area and bounds nothing
    for (int k = 0; k < 3; ++k) {
      const int from = v[static_cast<std::size_t>(k)], to = v[static_cast<std::size_t>((k + 1) % 3)];
      const auto key = std::minmax(from, to);
      balance[key] += from < to ? 1 : -1;
      uses[key] += 1;
    }
  }
  if (uses.empty()) return false;
  return std::all_of(uses.begin(), uses.end(), [&](const auto& use) { return use.second == 2 && balance[use.first] == 0; });
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
