// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "swivel/core/base/types.hpp"

namespace swivel {

/// A sphere about the origin of its frame.
struct Sphere {
  double radius = 0;
  bool operator==(const Sphere&) const = default;
};
/// A box centred on its frame, edges along the axes.
struct Box {
  Vector3d size = Vector3d::Zero();  ///< full edge lengths, m
  bool operator==(const Box&) const = default;
};
/// A cylinder centred on its frame, its axis along z.
struct Cylinder {
  double radius = 0;
  double length = 0;
  bool operator==(const Cylinder&) const = default;
};
/// A capsule centred on its frame, its axis along z: all points within `radius` of a segment.
struct Capsule {
  double radius = 0;
  double length = 0;  ///< of the segment: the cylindrical part without the caps, m
  bool operator==(const Capsule&) const = default;
};

/// Triangles over shared vertices, m, with the file's scale and mirroring applied. The windings of
/// a mirrored mesh are turned back, so that normals keep their side.
struct TriangleMesh {
  std::vector<Vector3d> vertices;
  /// Indices into `vertices`.
  std::vector<std::array<int, 3>> triangles;
  std::string source;  ///< file that it came from, for messages
  /// true: it bounds a solid, see is_closed().
  bool closed = false;
  Vector3d scale = Vector3d::Ones();  ///< factors by which the vertices of the file were multiplied
};
// shared: one file serves several links and all episodes
using MeshPtr = std::shared_ptr<const TriangleMesh>;

/// Any collision shape; lengths in m.
using Shape = std::variant<Sphere, Box, Cylinder, Capsule, MeshPtr>;

/// A shape and where it stands.
struct PlacedShape {
  Shape shape;
  Pose pose = Pose::Identity();  ///< shape in the frame of the link or mesh that has it
};

/// Returns true if the mesh is a closed, oriented surface: once equal vertices are welded and
/// triangles with two equal corners left out, every edge is used equally often, and at most once,
/// in each direction.
[[nodiscard]] bool is_closed(const TriangleMesh& mesh);

/// A ball, in a shape's own frame. The convex hull of a shape's bounding balls contains the shape.
struct Ball {
  Vector3d center;
  double radius = 0;
};
/// Returns balls in the shape's frame whose convex hull contains it. The hull is exact for spheres,
/// capsules and boxes, is the convex hull of a mesh, and encloses a cylinder in the capsule around
/// it.
[[nodiscard]] std::vector<Ball> bounding_balls(const Shape& shape);

/// Returns a number for each vertex, from 0 on in order of first appearance, equal for vertices at
/// equal positions. STL files store every corner of every triangle anew.
[[nodiscard]] std::vector<int> vertex_numbers(const TriangleMesh& mesh);

}  // namespace swivel
