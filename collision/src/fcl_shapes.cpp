// SPDX-License-Identifier: BSD-3-Clause
#include "fcl_shapes.hpp"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>

#include <utility>

#include "swivel/core/input_error.hpp"

namespace swivel::detail {

namespace {

template <class Tree>
void build(Tree& tree, const TriangleMesh& mesh, const std::vector<std::array<int, 3>>& with_area) {
  std::vector<fcl::Triangle> triangles;
  for (const auto& t : with_area) triangles.emplace_back(t[0], t[1], t[2]);
  tree.beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size()));
  tree.addSubModel(mesh.vertices, triangles);
  tree.endModel();
}

std::shared_ptr<const TriangleTree> tree_of_all(const TriangleMesh& mesh) {
  return tree_of(mesh, triangles_with_area(mesh));
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

MeshModel::MeshModel(MeshPtr mesh)
    : mesh_(std::move(mesh)), with_area_(triangles_with_area(*mesh_)), triangles_(tree_of(*mesh_, with_area_)) {
  if (!triangles_) throw InputError(mesh_->source + ": mesh: no triangle with an area: allowed is at least one");
  if (mesh_->closed) solid_.emplace(*mesh_);
  part_points_ = one_point_per_part(*mesh_);
}

const fcl::BVHModel<fcl::OBBd>& MeshModel::boolean_tree() const {
  std::call_once(boolean_tree_once_, [this] { build(boolean_tree_, *mesh_, with_area_); });
  return boolean_tree_;
}

const fcl::BVHModel<fcl::RSSd>& MeshModel::distance_tree() const {
  std::call_once(distance_tree_once_, [this] { build(distance_tree_, *mesh_, with_area_); });
  return distance_tree_;
}

std::unique_ptr<fcl::BVHModel<fcl::RSSd>> MeshModel::distance_tree_of(const std::vector<int>& places) const {
  auto tree = std::make_unique<fcl::BVHModel<fcl::RSSd>>();
  tree->beginModel(static_cast<int>(places.size()), static_cast<int>(3 * places.size()));
  for (const int place : places) {
    const auto& t = with_area_[static_cast<std::size_t>(place)];
    tree->addTriangle(mesh_->vertices[t[0]], mesh_->vertices[t[1]], mesh_->vertices[t[2]]);
  }
  tree->endModel();
  return tree;
}

std::shared_ptr<const MeshModel> MeshStore::model(const MeshPtr& mesh) {
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
    result.triangles = result.mesh->triangles();
  } else {
    const bool round = std::holds_alternative<Sphere>(shape) || std::holds_alternative<Capsule>(shape);
    result.kind = round ? FclShape::Kind::kRound : FclShape::Kind::kSolid;
    result.geometry = std::visit(PrimitiveVisitor{}, shape);
    if (const auto* box = std::get_if<Box>(&shape)) result.triangles = tree_of_all(surface_of(*box));
    if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
      result.triangles = tree_of_all(surface_of(*cylinder));
      result.beyond_triangles = beyond_prism(*cylinder);
    }
  }
  return result;
}

}  // namespace swivel::detail
