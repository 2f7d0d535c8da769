// SPDX-License-Identifier: BSD-3-Clause
#include "page/scene_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <variant>

#include "page/packed.hpp"
#include "page/thinned.hpp"

namespace swivel::detail {

Json vector_json(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json pose_json(const Pose& pose) {
  Json json = Json::array();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) json.push_back(pose.matrix()(r, c));
  return json;
}

Json chain_json(const Chain& chain) {
  Json joints = Json::array();
  for (std::size_t j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[j];
    joints.push_back({{"name", chain.joint_names[j]},
                      {"axis", vector_json(chain.axis[j])},
                      {"point", vector_json(chain.point[j])},
                      {"lower", limit.continuous ? Json(nullptr) : Json(limit.lower)},
                      {"upper", limit.continuous ? Json(nullptr) : Json(limit.upper)}});
    if (limit.slides) joints.back()["slides"] = true;
  }
  Json followers = Json::array();
  for (const Chain::Follower& follower : chain.followers)
    followers.push_back({{"parent", follower.parent},
                         {"leader", follower.leader},
                         {"multiplier", follower.multiplier},
                         {"slides", follower.slides},
                         {"axis", vector_json(follower.axis)},
                         {"point", vector_json(follower.point)}});
  return {{"joints", std::move(joints)},
          {"followers", std::move(followers)},
          {"home", pose_json(chain.home)}};
}

Json ground_json(const RobotModel& robot, const ArmModel& arm) {
  const LinkPlacement& root = arm.links[static_cast<std::size_t>(robot.root_link)];
  if (root.group == 0) return nullptr;
  return {{"group", root.group}, {"pose", pose_json(root.pose)}};
}

Bodies::Bodies(const World& world, const std::vector<SceneObject>& scene) {
  for (const RobotBody& body : world.bodies()) add(body, body.group);
  add_scene(scene);
}

void Bodies::add_arm(const World& world, const std::string& name, const std::vector<int>& groups,
                     bool standing) {
  for (const RobotBody& body : world.bodies()) {
    if (body.group == 0 && !body.attached && !standing) continue;
    add(body, groups[static_cast<std::size_t>(body.group)]);
    if (body.group != 0 || body.attached) bodies.back()["arm"] = name;
  }
}

void Bodies::add_scene(const std::vector<SceneObject>& scene) {
  for (const SceneObject& object : scene) add(object.name, "scene", 0, object.shape, object.pose);
}

void Bodies::add(const RobotBody& body, int group) {
  add(body.name, body.attached ? "tool" : "robot", group, body.shape, body.pose);
}

void Bodies::add_visual(const RobotModel& shapes, const RobotModel& robot,
                        const std::vector<DrawnArm>& arms) {
  constexpr std::size_t kMost = 200'000;  // triangles
  std::map<const TriangleMesh*, MeshPtr> used;
  std::size_t all = 0;
  for (const Link& link : shapes.links)
    for (const PlacedShape& placed : link.collision)
      if (const auto* mesh = std::get_if<MeshPtr>(&placed.shape))
        if (used.emplace(mesh->get(), *mesh).second) all += (*mesh)->triangles.size();
  if (all > kMost)
    for (const auto& [key, mesh] : used)
      thinned_[key] = thinned(mesh, mesh->triangles.size() * kMost / all);
  for (const Link& link : shapes.links) {
    const int index = robot.find_link(link.name);
    if (index < 0) continue;
    const auto place = [&](const DrawnArm& drawn) -> const LinkPlacement& {
      return drawn.arm.links[static_cast<std::size_t>(index)];
    };
    auto mover = std::find_if(arms.begin(), arms.end(),
                              [&](const DrawnArm& drawn) { return place(drawn).group != 0; });
    const bool stands = mover == arms.end();
    if (stands) mover = arms.begin();
    const LinkPlacement& at = place(*mover);
    const int group =
        mover->groups.empty() ? at.group : mover->groups[static_cast<std::size_t>(at.group)];
    for (const PlacedShape& placed : link.collision) {
      const auto* mesh = std::get_if<MeshPtr>(&placed.shape);
      const auto fewer = mesh == nullptr ? thinned_.end() : thinned_.find(mesh->get());
      visual.push_back(body(link.name, "robot", group,
                            fewer == thinned_.end() ? placed.shape : Shape(fewer->second),
                            at.pose * placed.pose));
      if (!stands && !mover->name.empty()) visual.back()["arm"] = mover->name;
    }
  }
}

void Bodies::add(const std::string& name, const char* kind, int group, const Shape& shape,
                 const Pose& pose) {
  bodies.push_back(body(name, kind, group, shape, pose));
}

Json Bodies::body(const std::string& name, const char* kind, int group, const Shape& shape,
                  const Pose& pose) {
  Json body = {{"name", name}, {"kind", kind}, {"group", group}, {"pose", pose_json(pose)}};
  if (const auto* sphere = std::get_if<Sphere>(&shape)) body["sphere"] = sphere->radius;
  if (const auto* box = std::get_if<Box>(&shape)) body["box"] = vector_json(box->size);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape))
    body["cylinder"] = {cylinder->radius, cylinder->length};
  if (const auto* capsule = std::get_if<Capsule>(&shape))
    body["capsule"] = {capsule->radius, capsule->length};
  if (const auto* mesh = std::get_if<MeshPtr>(&shape)) body["mesh"] = index_of(**mesh);
  return body;
}

namespace {

/// Writes a mesh for drawing. Corners are rounded to 10 um; they are numbered in the order in which
/// triangles use them, equal ones alike. `points`: of each the differences from the one before, x,
/// y, z, with their signs in the lowest bits. `corners`: of each corner of the triangles how far
/// its number is below the next that is not used yet. Both are varints.
Json mesh_json(const TriangleMesh& mesh) {
  constexpr double kGrain = 1e-5;  // m
  Bytes points, corners;
  std::map<std::array<std::int64_t, 3>, std::uint64_t> numbers;
  std::array<std::int64_t, 3> before{};
  for (const auto& triangle : mesh.triangles)
    for (const int corner : triangle) {
      const Vector3d& v = mesh.vertices[static_cast<std::size_t>(corner)];
      std::array<std::int64_t, 3> at{};
      for (int k = 0; k < 3; ++k) at[static_cast<std::size_t>(k)] = std::llround(v[k] / kGrain);
      const std::uint64_t next = numbers.size();
      const auto [known, is_new] = numbers.emplace(at, next);
      append_varint(corners, next - known->second);
      if (!is_new) continue;
      for (std::size_t k = 0; k < 3; ++k) append_signed(points, at[k] - before[k]);
      before = at;
    }
  return {{"grain", kGrain}, {"points", Json::binary(points)}, {"corners", Json::binary(corners)}};
}

}  // namespace

std::size_t Bodies::index_of(const TriangleMesh& mesh) {
  const auto [at, fresh] = index_.emplace(&mesh, index_.size());
  if (fresh) meshes.push_back(mesh_json(mesh));
  return at->second;
}

}  // namespace swivel::detail
