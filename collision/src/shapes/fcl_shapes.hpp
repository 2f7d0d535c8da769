// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/collision_geometry.h>
#include <fcl/math/bv/OBB.h>
#include <fcl/math/bv/RSS.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "shapes/bound.hpp"
#include "shapes/closed_mesh.hpp"
#include "shapes/polyhedron.hpp"
#include "swivel/core/base/lazy.hpp"
#include "swivel/core/problem/shape.hpp"

namespace swivel::detail {

/// What collision needs of one mesh. Each part is computed when it is first asked for: certificates leave FCL few questions, and
/// boxes about a link are often all that is asked of it. Const calls are safe from many threads.
class MeshModel {
 public:
  /// Throws InputError for a mesh without a triangle that has an area.
  explicit MeshModel(MeshPtr mesh);
  /// For certificates.
  [[nodiscard]] const TriangleTree& triangles() const;
  [[nodiscard]] bool is_ready() const { return triangles_.is_made(); }
  /// For booleans: of FCL's trees the one that needs no copy per question and has the cheapest overlap test.
  [[nodiscard]] const fcl::BVHModel<fcl::OBBd>& boolean_tree() const;
  /// For distances, which an OBB cannot bound.
  [[nodiscard]] const fcl::BVHModel<fcl::RSSd>& distance_tree() const;
  /// The same of some of the triangles that triangles() was made of, by their places there; at least one.
  [[nodiscard]] std::unique_ptr<fcl::BVHModel<fcl::RSSd>> distance_tree_of(const std::vector<int>& places) const;
  [[nodiscard]] bool is_closed() const;
  /// Of a mesh that is closed.
  [[nodiscard]] const ClosedMesh& solid() const;
  /// A point of every connected part.
  [[nodiscard]] const std::vector<Vector3d>& part_points() const;

 private:
  MeshPtr mesh_;
  std::vector<std::array<int, 3>> with_area_;
  Lazy<TriangleTree> triangles_;
  Lazy<ClosedMesh> solid_;
  Lazy<std::vector<Vector3d>> part_points_;
  Lazy<fcl::BVHModel<fcl::OBBd>> boolean_tree_;
  Lazy<fcl::BVHModel<fcl::RSSd>> distance_tree_;
};

/// Models by mesh, so that one file serves many links, and one world's trees the next world.
class MeshStore {
 public:
  std::shared_ptr<const MeshModel> model(const MeshPtr& mesh);

 private:
  std::map<const TriangleMesh*, std::shared_ptr<const MeshModel>> models_;  // a model keeps its mesh alive
};

/// One shape as FCL and the tests around it see it.
struct FclShape {
  enum class Kind { kRound, kSolid, kMesh };  ///< sphere or capsule; box or cylinder; mesh
  Kind kind = Kind::kSolid;
  Shape shape;
  std::shared_ptr<const fcl::CollisionGeometryd> geometry;  // shared: worlds of one robot; null for a mesh
  std::shared_ptr<const MeshModel> mesh;                    // shared through the store; null unless a mesh
  std::shared_ptr<const TriangleTree> surface;              // shared: the same; of a box, of a prism in a cylinder; null for others
  double beyond_triangles = 0;                              // no point of the cylinder is further from its prism, m
  Bound bound;
  [[nodiscard]] bool has_triangles() const { return mesh || surface; }
  /// The surface of a mesh or box, or of a prism in a cylinder.
  [[nodiscard]] const TriangleTree& triangles() const { return mesh ? mesh->triangles() : *surface; }
  /// What FCL is asked for distances about.
  [[nodiscard]] const fcl::CollisionGeometryd& distance_geometry() const { return mesh ? mesh->distance_tree() : *geometry; }
};
[[nodiscard]] FclShape make_fcl_shape(const Shape& shape, MeshStore& store);

}  // namespace swivel::detail
