// SPDX-License-Identifier: BSD-3-Clause
#include "pads.hpp"

#include <cmath>
#include <memory>
#include <utility>

#include "swivel/core/base/types.hpp"

namespace swivel::bench {

namespace {

constexpr double kRadius = 0.04, kThickness = 0.02;  // of pads, m

MeshPtr finished(TriangleMesh mesh, const char* source) {
  mesh.source = source;
  mesh.closed = is_closed(mesh);
  return std::make_shared<const TriangleMesh>(std::move(mesh));
}

/// Returns a solid of revolution about z with `sides` sides, whose outline is `rings`, pairs of a
/// radius and a height, from its upper pole to its lower one, both at a radius of 0.
MeshPtr turned(const std::vector<Eigen::Vector2d>& rings, int sides, const char* source) {
  TriangleMesh mesh;
  mesh.vertices = {Vector3d(0, 0, rings.front().y()), Vector3d(0, 0, rings.back().y())};
  const int inner = static_cast<int>(rings.size()) - 2;
  for (int ring = 1; ring <= inner; ++ring)
    for (int side = 0; side < sides; ++side) {
      const double angle = kTwoPi * side / sides;
      const auto& [r, z] = std::pair(rings[static_cast<std::size_t>(ring)].x(),
                                     rings[static_cast<std::size_t>(ring)].y());
      mesh.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  const auto at = [&](int ring, int side) { return 2 + ring * sides + side % sides; };
  for (int side = 0; side < sides; ++side) {
    mesh.triangles.push_back({0, at(0, side), at(0, side + 1)});
    mesh.triangles.push_back({1, at(inner - 1, side + 1), at(inner - 1, side)});
    for (int ring = 0; ring + 1 < inner; ++ring) {
      mesh.triangles.push_back({at(ring, side), at(ring + 1, side), at(ring + 1, side + 1)});
      mesh.triangles.push_back({at(ring, side), at(ring + 1, side + 1), at(ring, side + 1)});
    }
  }
  return finished(std::move(mesh), source);
}

/// Returns a part of a sphere, 500 mm wide and 80 mm high.
MeshPtr dome(int triangles) {
  constexpr double kWide = 0.25, kHigh = 0.08,
                   kSphere = (kWide * kWide + kHigh * kHigh) / (2 * kHigh);
  const int rings = static_cast<int>(std::sqrt(triangles / 8.0));
  std::vector<Eigen::Vector2d> outline;
  for (int ring = 0; ring <= rings; ++ring) {
    const double r = kWide * ring / rings;
    outline.emplace_back(r, std::sqrt(kSphere * kSphere - r * r) - kSphere + kHigh);
  }
  outline.emplace_back(0, 0);
  return turned(outline, 4 * rings, "dome");
}

Shape shape_of(const std::string& pad) {
  if (pad == "sphere") return Sphere{kRadius};
  if (pad == "capsule") return Capsule{kThickness / 2, 2 * kRadius};
  if (pad == "box") return Box{{2 * kRadius, 2 * kRadius, kThickness}};
  if (pad == "cylinder") return Cylinder{kRadius, kThickness};
  const double half = kThickness / 2;
  return turned({{0, half}, {kRadius, half}, {kRadius, -half}, {0, -half}}, 250, "pad");
}

/// Returns how far the pad reaches along z from its middle, m.
double reach_of(const std::string& pad) {
  if (pad == "sphere") return kRadius;
  return pad == "capsule" ? kRadius + kThickness / 2 : kThickness / 2;
}

}  // namespace

PathProblem pad_on_dome(PathProblem problem, const std::string& pad, int triangles, double depth) {
  constexpr double kAhead = 0.12, kDeep = 0.001;
  problem.tool = Pose::Identity();
  problem.tool.translation().z() = kAhead;
  AttachedBody body;
  body.name = "pad";
  body.link = problem.tip_link;
  body.shape = shape_of(pad);
  body.pose.translation().z() = kAhead - reach_of(pad);
  problem.attached = {body};
  SceneObject object;
  object.name = "dome";
  object.shape = dome(triangles);
  object.pose.translation() = Vector3d(0.6, 0, 0.2);
  object.allow = {depth > 0 ? Allowed("pad", depth) : Allowed("pad")};
  problem.scene = {object};
  problem.vary.clear();
  problem.path_frame = problem.base_link;
  problem.waypoints.clear();
  for (const double x : {-0.05, 0.05}) {
    Waypoint& waypoint = problem.waypoints.emplace_back();
    waypoint.position = Vector3d(0.6 + x, 0, 0.2 + 0.08 - kDeep);
    waypoint.orientation = Quaterniond(0, 0, 1, 0);
  }
  problem.resolution = {};
  problem.limits.tool_path_error.reset();
  return problem;
}

}  // namespace swivel::bench
