// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// Collision shapes; lengths in metres, each centred on its own frame, axes of revolution along z.
struct Sphere {
  double radius = 0;
  bool operator==(const Sphere&) const = default;
};
struct Box {
  Vector3d size = Vector3d::Zero();  ///< full edge lengths
  bool operator==(const Box&) const = default;
};
struct Cylinder {
  double radius = 0;
  double length = 0;
  bool operator==(const Cylinder&) const = default;
};
struct Capsule {
  double radius = 0;
  double length = 0;  ///< of the cylindrical part, without the caps
  bool operator==(const Capsule&) const = default;
};

/// A triangle soup with shared vertices, metres, scale and mirror already applied (a mirror flips the winding back).
struct TriangleMesh {
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  std::string source;   ///< file it came from, for messages
  bool closed = false;  ///< every edge is shared by exactly two oppositely directed triangles: a solid
};
using MeshPtr = std::shared_ptr<const TriangleMesh>;  // shared: one file serves many links and every episode

using Shape = std::variant<Sphere, Box, Cylinder, Capsule, MeshPtr>;

struct PlacedShape {
  Shape shape;
  Pose pose = Pose::Identity();  ///< of the shape in the frame of what carries it
};

/// True when welding equal vertices leaves every edge used once in each direction (a closed, oriented surface).
[[nodiscard]] bool is_closed(const TriangleMesh& mesh);

/// A point and a radius; the convex hull of a shape's balls contains the shape (exact for spheres, capsules, boxes, meshes;
/// a cylinder is enclosed in its capsule). Frame: the shape's own.
struct Ball {
  Vector3d center;
  double radius = 0;
};
[[nodiscard]] std::vector<Ball> bounding_balls(const Shape& shape);

}  // namespace swivel
