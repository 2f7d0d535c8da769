// SPDX-License-Identifier: BSD-3-Clause
#include "shapes/fcl_shapes.hpp"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>

#include <utility>

#include "swivel/core/messages/input_error.hpp"

namespace swivel::detail {

namespace {

template <class Tree>
std::unique_ptr<Tree> fcl_tree(const TriangleMesh& mesh,
                               const std::vector<std::array<int, 3>>& with_area) {
  std::vector<fcl::Triangle> triangles;
  for (const auto& t : with_area) triangles.emplace_back(t[0], t[1], t[2]);
  auto tree = std::make_unique<Tree>();
  tree->beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size()));
  tree->addSubModel(mesh.vertices, triangles);
  tree->endModel();
  return tree;
}

std::shared_ptr<const TriangleTree> tree_of_all(const TriangleMesh& mesh) {
  return tree_of(mesh, triangles_with_area(mesh));
}

struct PrimitiveVisitor {
  using Geometry = std::shared_ptr<const fcl::CollisionGeometryd>;
  Geometry operator()(const Sphere& s) const { return std::make_shared<fcl::Sphered>(s.radius); }
  Geometry operator()(const Box& b) const { return std::make_shared<fcl::Boxd>(b.size); }
  Geometry operator()(const Cylinder& c) const {
    return std::make_shared<fcl::Cylinderd>(c.radius, c.length);
  }
  Geometry operator()(const Capsule& c) const {
    return std::make_shared<fcl::Capsuled>(c.radius, c.length);
  }
  Geometry operator()(const MeshPtr&) const { return nullptr; }
};

}  // namespace

MeshModel::MeshModel(MeshPtr mesh)
    : mesh_(std::move(mesh)), with_area_(triangles_with_area(*mesh_)) {
  if (with_area_.empty())
    throw InputError(mesh_->source, "mesh: no triangle with an area: allowed is at least one");
}

const TriangleTree& MeshModel::triangles() const {
  return triangles_.get([this] { return tree_of(*mesh_, with_area_); });
}

const fcl::BVHModel<fcl::OBBd>& MeshModel::boolean_tree() const {
  return boolean_tree_.get(
      [this] { return fcl_tree<fcl::BVHModel<fcl::OBBd>>(*mesh_, with_area_); });
}

const fcl::BVHModel<fcl::RSSd>& MeshModel::distance_tree() const {
  return distance_tree_.get(
      [this] { return fcl_tree<fcl::BVHModel<fcl::RSSd>>(*mesh_, with_area_); });
}

bool MeshModel::is_closed() const {
  return mesh_->closed;
}

const ClosedMesh& MeshModel::solid() const {
  return solid_.get([this] { return std::make_unique<ClosedMesh>(*mesh_); });
}

const std::vector<Vector3d>& MeshModel::part_points() const {
  return part_points_.get(
      [this] { return std::make_unique<std::vector<Vector3d>>(one_point_per_part(*mesh_)); });
}

std::unique_ptr<fcl::BVHModel<fcl::RSSd>> MeshModel::distance_tree_of(
    const std::vector<int>& places) const {
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
  } else {
    const bool round =
        std::holds_alternative<Sphere>(shape) || std::holds_alternative<Capsule>(shape);
    result.kind = round ? FclShape::Kind::kRound : FclShape::Kind::kSolid;
    result.geometry = std::visit(PrimitiveVisitor{}, shape);
    if (const auto* box = std::get_if<Box>(&shape)) result.surface = tree_of_all(surface_of(*box));
    if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
      result.surface = tree_of_all(surface_of(*cylinder));
      result.beyond_triangles = beyond_prism(*cylinder);
    }
  }
  return result;
}

}  // namespace swivel::detail
