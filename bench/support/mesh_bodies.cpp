// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_bodies.hpp"

#include <cmath>

#include "swivel/core/base/types.hpp"

namespace swivel::bench {

namespace {

/// Returns the rings of corners of a capsule, from pole to pole.
MeshPtr mesh_of(const Capsule& capsule) {
  constexpr int kSides = 20, kRingsOfCap = 10, kRings = 2 * kRingsOfCap;
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->source = "capsule as a mesh";
  const double half = capsule.length / 2;
  mesh->vertices = {Vector3d(0, 0, half + capsule.radius), Vector3d(0, 0, -half - capsule.radius)};
  for (int ring = 0; ring < kRings; ++ring) {
    const bool upper = ring < kRingsOfCap;
    const double a = kPi / 2 * (upper ? ring + 1 : ring) / kRingsOfCap;  // from the upper pole
    for (int side = 0; side < kSides; ++side) {
      const double b = kTwoPi * side / kSides, r = capsule.radius * std::sin(a);
      mesh->vertices.emplace_back(r * std::cos(b), r * std::sin(b),
                                  (upper ? half : -half) + capsule.radius * std::cos(a));
    }
  }
  const auto at = [](int ring, int side) { return 2 + ring * kSides + side % kSides; };
  for (int side = 0; side < kSides; ++side) {
    mesh->triangles.push_back({0, at(0, side), at(0, side + 1)});
    mesh->triangles.push_back({1, at(kRings - 1, side + 1), at(kRings - 1, side)});
    for (int ring = 0; ring + 1 < kRings; ++ring) {
      mesh->triangles.push_back({at(ring, side), at(ring + 1, side), at(ring + 1, side + 1)});
      mesh->triangles.push_back({at(ring, side), at(ring + 1, side + 1), at(ring, side + 1)});
    }
  }
  mesh->closed = is_closed(*mesh);
  return mesh;
}

}  // namespace

PathProblem with_mesh_bodies(PathProblem problem) {
  auto model = std::make_shared<RobotModel>(*problem.model);
  for (Link& link : model->links)
    for (PlacedShape& placed : link.collision)
      if (const auto* capsule = std::get_if<Capsule>(&placed.shape); capsule && capsule->length > 0)
        placed.shape = mesh_of(*capsule);
  problem.model = std::move(model);
  return problem;
}

}  // namespace swivel::bench
