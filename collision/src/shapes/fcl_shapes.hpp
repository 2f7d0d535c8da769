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

/// The search structures of one mesh. Each is built when it is first used, because distance proofs
/// leave FCL few questions and boxes about a link often suffice. Const calls are safe from many
/// threads.
class MeshModel {
 public:
  /// Throws InputError for a mesh without a triangle that has an area.
  explicit MeshModel(MeshPtr mesh);
  /// Returns our own tree of the triangles, which distance proofs use.
  [[nodiscard]] const TriangleTree& triangles() const;
  /// Returns true if triangles() has been built.
  [[nodiscard]] bool is_ready() const { return triangles_.is_made(); }
  /// Returns FCL's tree for boolean collision queries: the kind that needs no copy per query and
  /// has the cheapest overlap test.
  [[nodiscard]] const fcl::BVHModel<fcl::OBBd>& boolean_tree() const;
  /// Returns FCL's tree for distance queries, which oriented bounding boxes cannot bound.
  [[nodiscard]] const fcl::BVHModel<fcl::RSSd>& distance_tree() const;
  /// Returns FCL's tree for distance queries, made only of the triangles at `places` in the list
  /// that triangles() was made of. `places` must not be empty.
  [[nodiscard]] std::unique_ptr<fcl::BVHModel<fcl::RSSd>> distance_tree_of(
      const std::vector<int>& places) const;
  /// Returns true if the mesh is a closed surface.
  [[nodiscard]] bool is_closed() const;
  /// Returns the point-in-solid test. The mesh must be closed.
  [[nodiscard]] const ClosedMesh& solid() const;
  /// Returns one point of every connected part, in the mesh's frame.
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

/// The models of meshes. Each is built once, so that links that use one file share it, and later
/// worlds reuse its trees.
class MeshStore {
 public:
  /// Returns the model of a mesh, which is created when first asked for. Throws InputError for a
  /// mesh without a triangle that has an area.
  std::shared_ptr<const MeshModel> model(const MeshPtr& mesh);

 private:
  // a model keeps its mesh alive
  std::map<const TriangleMesh*, std::shared_ptr<const MeshModel>> models_;
};

/// A shape with the geometry that FCL, distance proofs and bounding volumes need.
struct FclShape {
  enum class Kind { kRound, kSolid, kMesh };  ///< sphere or capsule; box or cylinder; mesh
  Kind kind = Kind::kSolid;
  Shape shape;
  // shared: worlds of one robot; null for a mesh
  std::shared_ptr<const fcl::CollisionGeometryd> geometry;
  // shared through the store; null unless a mesh
  std::shared_ptr<const MeshModel> mesh;
  // shared: the same; of a box, of a prism in a cylinder; null for others
  std::shared_ptr<const TriangleTree> surface;
  // no point of the cylinder is further from its prism, m
  double beyond_triangles = 0;
  Bound bound;
  [[nodiscard]] bool has_triangles() const { return mesh || surface; }
  /// Returns the triangles of a mesh or box, or of the prism in a cylinder. The shape must have
  /// triangles.
  [[nodiscard]] const TriangleTree& triangles() const {
    return mesh ? mesh->triangles() : *surface;
  }
  /// Returns the geometry that FCL's distance queries use.
  [[nodiscard]] const fcl::CollisionGeometryd& distance_geometry() const {
    return mesh ? mesh->distance_tree() : *geometry;
  }
};
/// Returns the geometry of a shape; takes the model of a mesh from `store`. Throws InputError for a
/// mesh without a triangle that has an area.
[[nodiscard]] FclShape make_fcl_shape(const Shape& shape, MeshStore& store);

}  // namespace swivel::detail
