// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_shapes.hpp"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>

#include <algorithm>
#include <array>
#include <utility>

#include "swivel/core/input_error.hpp"

namespace swivel {

namespace {

/// Triangles less than a nanometre high are left out: their neighbours' edges cover them, and FCL returns an unset distance for a
/// triangle without area.
std::vector<fcl::Triangle> triangles_with_area(const TriangleMesh& mesh) {
  constexpr double kLeastHeight = 1e-9;
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const std::array<std::size_t, 3> k{static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                                       static_cast<std::size_t>(t[2])};
    const Vector3d ab = mesh.vertices[k[1]] - mesh.vertices[k[0]], ac = mesh.vertices[k[2]] - mesh.vertices[k[0]];
    const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    if (ab.cross(ac).norm() > kLeastHeight * longest) triangles.emplace_back(k[0], k[1], k[2]);
  }
  return triangles;
}

template <class Tree>
void build(Tree& tree, const TriangleMesh& mesh) {
  const std::vector<fcl::Triangle> triangles = triangles_with_area(mesh);
  if (triangles.empty()) throw InputError(mesh.source + ": mesh: no triangle with an area: at least one is needed");
  tree.beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size()));
  tree.addSubModel(mesh.vertices, triangles);
  tree.endModel();
}

struct PrimitiveVisitor {
  using Geometry = std::shared_ptr<const fcl::CollisionGeometryd>;
  Geometry operator()(const Sphere& s) const { return std::make_shared<fcl::Sphered>(s.radius); }
  Geometry operator()(const Box& b) const { return std::make_shared<fcl::Boxd>(b.size); }
  Geometry operator()(const Cylinder& c) const { return std::make_shared<fcl::Cylinderd>(c.radius, c.length); }
  Geometry operator()(const Capsule& c) const { return std::make_shared<fcl::Capsuled>(c.radius, c.length); }
  Geometry operator()(const MeshPtr&) const { return nullptr; }
};

}  // namespace

MeshModel::MeshModel(MeshPtr mesh) : mesh_(std::move(mesh)) {
  build(boolean_tree_, *mesh_);
  if (mesh_->closed) solid_.emplace(*mesh_);
  part_points_ = one_point_per_part(*mesh_);
}

const fcl::BVHModel<fcl::RSSd>& MeshModel::distance_tree() const {
  std::call_once(distance_tree_once_, [this] { build(distance_tree_, *mesh_); });
  return distance_tree_;
}

std::shared_ptr<const MeshModel> MeshStore::model(const MeshPtr& mesh) {
  const std::lock_guard lock(mutex_);
  auto& model = models_[mesh.get()];
  if (!model) model = std::make_shared<const MeshModel>(mesh);
  return model;
}

FclShape make_fcl_shape(const Shape& shape, MeshStore& store) {
  FclShape result;
  result.shape = shape;
  result.bound = bound_of(shape);
  if (const auto* mesh = std::get_if<MeshPtr>(&shape)) {
    result.kind = FclShape::Kind::kMesh;
    result.mesh = store.model(*mesh);
  } else {
    const bool round = std::holds_alternative<Sphere>(shape) || std::holds_alternative<Capsule>(shape);
    result.kind = round ? FclShape::Kind::kRound : FclShape::Kind::kSolid;
    result.geometry = std::visit(PrimitiveVisitor{}, shape);
  }
  return result;
}

}  // namespace swivel
