// SPDX-License-Identifier: BSD-3-Clause
#include "scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

#include "swivel/core/messages/bounds.hpp"

namespace swivel::ros {

namespace {

/// Frames in messages may begin with a slash, as those of ROS 1 did.
std::string without_slash(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

/// Returns a closed mesh about a cone: its base has 32 corners, so that it contains the round one.
MeshPtr cone_mesh(double height, double radius) {
  constexpr int kCorners = 32;
  auto mesh = std::make_shared<TriangleMesh>();
  const double outer = radius / std::cos(kPi / kCorners);
  for (int k = 0; k < kCorners; ++k) {
    const double angle = kTwoPi * k / kCorners;
    mesh->vertices.emplace_back(outer * std::cos(angle), outer * std::sin(angle), -height / 2);
  }
  mesh->vertices.emplace_back(0, 0, height / 2);
  for (int k = 0; k < kCorners; ++k) {
    const int next = (k + 1) % kCorners;
    mesh->triangles.push_back({k, next, kCorners});
    if (k >= 1 && k + 1 < kCorners) mesh->triangles.push_back({0, k + 1, k});
  }
  mesh->source = "cone";
  mesh->closed = is_closed(*mesh);
  return mesh;
}

std::optional<Shape> mesh_of(const Solid& solid, const std::string& id) {
  auto mesh = std::make_shared<TriangleMesh>();
  if (solid.vertices.empty() || solid.vertices.size() % 3 != 0 || solid.triangles.empty() ||
      solid.triangles.size() % 3 != 0)
    return std::nullopt;
  for (std::size_t k = 0; k < solid.vertices.size(); k += 3)
    mesh->vertices.emplace_back(solid.vertices[k], solid.vertices[k + 1], solid.vertices[k + 2]);
  for (const double one : solid.vertices)
    if (!(std::abs(one) <= kMostMetres)) return std::nullopt;
  for (std::size_t k = 0; k < solid.triangles.size(); k += 3) {
    std::array<int, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) {
      if (solid.triangles[k + i] >= mesh->vertices.size()) return std::nullopt;
      corners[i] = static_cast<int>(solid.triangles[k + i]);
    }
    mesh->triangles.push_back(corners);
  }
  mesh->source = "mesh of " + id;
  mesh->closed = is_closed(*mesh);
  return mesh;
}

/// Returns the shape of a solid, none for one that makes no sense.
std::optional<Shape> shape_of(const Solid& solid, const std::string& id) {
  const auto& size = solid.dimensions;
  if (solid.kind == Solid::kMesh) return mesh_of(solid, id);
  const std::size_t needed = solid.kind == Solid::kBox ? 3 : solid.kind == Solid::kSphere ? 1 : 2;
  if (solid.kind < Solid::kBox || solid.kind > Solid::kCone || size.size() < needed ||
      !std::all_of(size.begin(), size.begin() + static_cast<std::ptrdiff_t>(needed),
                   [](double one) { return one > 0 && one <= kMostMetres; }))
    return std::nullopt;
  if (solid.kind == Solid::kBox) return Box{{size[0], size[1], size[2]}};
  if (solid.kind == Solid::kSphere) return Sphere{size[0]};
  if (solid.kind == Solid::kCylinder) return Cylinder{size[1], size[0]};
  return cone_mesh(size[0], size[1]);
}

/// Calls visit(name, shape, pose in the frame of the body's own frame) for each solid of a body.
/// The first has the body's name.
template <class Visit>
void for_each_solid(const Body& body, const Visit& visit) {
  for (std::size_t k = 0; k < body.solids.size(); ++k)
    visit(k == 0 ? body.id : body.id + "#" + std::to_string(k + 1),
          *shape_of(body.solids[k], body.id), to_pose(body.pose) * to_pose(body.solids[k].pose));
}

auto find_body(std::vector<Body>& bodies, const std::string& id) {
  return std::find_if(bodies.begin(), bodies.end(), [&](const Body& one) { return one.id == id; });
}

/// Adds a body to those there, or changes the one of its name.
void put(std::vector<Body>& bodies, const Body& body) {
  const auto found = find_body(bodies, body.id);
  if (found == bodies.end()) {
    bodies.push_back(body);
  } else if (body.operation == Body::kMove) {
    found->pose = body.pose;
  } else if (body.operation == Body::kAppend) {
    const Pose shift = to_pose(found->pose).inverse() * to_pose(body.pose);
    for (Solid solid : body.solids) {
      solid.pose = to_pose7(shift * to_pose(solid.pose));
      found->solids.push_back(std::move(solid));
    }
  } else {
    *found = body;
  }
}

template <class Number>
void append(std::string& bytes, const std::vector<Number>& numbers) {
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
  bytes += '\n';
}
void append(std::string& bytes, const Pose7& pose) {
  append(bytes, std::vector<double>{pose.x, pose.y, pose.z, pose.qw, pose.qx, pose.qy, pose.qz});
}

}  // namespace

bool to_model_frame(const std::string& frame, Pose7& pose, const RobotModel& model,
                    const RobotState& state, const PathService::Transform& transform) {
  const std::string name = without_slash(frame);
  if (name.empty()) return true;
  if (const int link = model.find_link(name); link >= 0) {
    if (link == model.root_link) return true;
    // The quaternion keeps its length, which tells a pose that makes no sense.
    const Pose at = state.link(link);
    const Quaterniond turn =
        Quaterniond(at.linear()) * Quaterniond(pose.qw, pose.qx, pose.qy, pose.qz);
    const Vector3d p = at * Vector3d(pose.x, pose.y, pose.z);
    pose = {p.x(), p.y(), p.z(), turn.w(), turn.x(), turn.y(), turn.z()};
    return true;
  }
  return transform && transform(name, pose);
}

std::string Scene::apply(const Body& body, const RobotModel& model, const RobotState& state,
                         const PathService::Transform& transform) {
  const std::string what = "object '" + body.id + "': ";
  std::vector<Body>& bodies = body.link.empty() ? world_ : attached_;
  if (body.operation == Body::kRemove) {
    for (Body gone : std::exchange(bodies, {})) {
      if (!body.id.empty() && gone.id != body.id) {
        bodies.push_back(std::move(gone));
      } else if (!body.link.empty()) {  // what a link lets go of stays where it is
        gone.pose = to_pose7(state.link(model.find_link(gone.link)) * to_pose(gone.pose));
        gone.link.clear();
        put(world_, gone);
      }
    }
    return "";
  }
  if (!body.unsupported.empty()) return what + body.unsupported;
  if (!is_valid_name(body.id) || model.find_link(body.id) >= 0)
    return "object '" + printable(body.id) + "': has no name of its own";
  Body placed = body;
  if (!body.link.empty() && model.find_link(body.link) < 0)
    return what + "is attached to the unknown link '" + body.link + "'";
  for (const Solid& solid : body.solids)
    if (!shape_of(solid, body.id)) return what + "has a shape that makes no sense";
  const auto in_world = find_body(world_, body.id);
  if (!body.link.empty() && body.solids.empty() && in_world != world_.end()) {
    placed.solids = in_world->solids;  // a link takes up what stood in the world
    placed.pose = in_world->pose;
  } else if (body.link.empty() || !without_slash(body.frame).empty()) {
    if (!to_model_frame(body.frame, placed.pose, model, state, transform))
      return what + "is in the unknown frame '" + body.frame + "'";
  } else {
    placed.pose = to_pose7(state.link(model.find_link(body.link)) * to_pose(body.pose));
  }
  placed.frame.clear();
  if (!body.link.empty()) {
    placed.pose = to_pose7(state.link(model.find_link(body.link)).inverse() * to_pose(placed.pose));
    if (in_world != world_.end()) world_.erase(in_world);
  }
  if (placed.operation == Body::kMove && find_body(bodies, body.id) == bodies.end())
    return what + "is moved, but is not there";
  put(bodies, placed);
  return "";
}

bool Scene::allows(const std::string& a, const std::string& b) const {
  const auto among = [&](const auto& pairs) {
    return std::any_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
      return (pair.first == a && pair.second == b) || (pair.first == b && pair.second == a);
    });
  };
  const auto& all = allowed_.with_all;
  return among(allowed_.pairs) || ((std::find(all.begin(), all.end(), a) != all.end() ||
                                    std::find(all.begin(), all.end(), b) != all.end()) &&
                                   !among(allowed_.apart));
}

Robot Scene::robot_with_bodies(Robot robot) const {
  if (attached_.empty() && !allowed_.given) return robot;
  auto model = std::make_shared<RobotModel>(*robot.model);
  std::vector<std::pair<std::string, std::string>> bodies;  // names of bodies, and of their objects
  for (const Link& link : model->links) bodies.emplace_back(link.name, link.name);
  if (allowed_.given) {
    model->disabled_pairs.clear();
    model->has_srdf = true;
  }
  for (const Body& body : attached_)
    for_each_solid(body, [&](const std::string& name, const Shape& shape, const Pose& pose) {
      robot.attached.push_back({name, shape, pose, body.link});
      for (const std::string& link : body.touch_links)
        model->disabled_pairs.emplace_back(name, link);
      bodies.emplace_back(name, body.id);
    });
  if (allowed_.given)
    for (std::size_t i = 0; i < bodies.size(); ++i)
      for (std::size_t j = i + 1; j < bodies.size(); ++j)
        if (allows(bodies[i].second, bodies[j].second))
          model->disabled_pairs.emplace_back(bodies[i].first, bodies[j].first);
  robot.model = std::move(model);
  return robot;
}

std::vector<SceneObject> Scene::objects(const Robot& robot) const {
  std::vector<SceneObject> objects;
  for (const Body& body : world_)
    for_each_solid(body, [&](const std::string& name, const Shape& shape, const Pose& pose) {
      SceneObject object{name, shape, pose, {}};
      if (allowed_.given) {
        for (const Link& link : robot.model->links)
          if (allows(body.id, link.name)) object.allow.emplace_back(link.name);
        for (const Body& held : attached_)
          if (allows(body.id, held.id))
            for_each_solid(held, [&](const std::string& part, const Shape&, const Pose&) {
              object.allow.emplace_back(part);
            });
      }
      objects.push_back(std::move(object));
    });
  return objects;
}

std::string Scene::key() const {
  std::string bytes;
  for (const Body& body : attached_) {
    bytes += body.id + '\n' + body.link + '\n';
    for (const std::string& link : body.touch_links) bytes += link + '\n';
    append(bytes, body.pose);
    for (const Solid& solid : body.solids) {
      bytes += std::to_string(solid.kind) + '\n';
      append(bytes, solid.pose);
      append(bytes, solid.dimensions);
      append(bytes, solid.vertices);
      append(bytes, solid.triangles);
    }
  }
  if (!allowed_.given) return bytes;
  bytes += "allowed\n";
  for (const auto& [a, b] : allowed_.pairs) bytes += a + '\n' + b + '\n';
  bytes += "with all\n";
  for (const std::string& one : allowed_.with_all) bytes += one + '\n';
  for (const auto& [a, b] : allowed_.apart) bytes += a + '\n' + b + '\n';
  return bytes;
}

}  // namespace swivel::ros
