// SPDX-License-Identifier: BSD-3-Clause
#include "exact/nearest_points.hpp"

#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <queue>
#include <tuple>

#include "exact/pair_test.hpp"

namespace swivel::detail {

namespace {

constexpr double kPointTolerance = 1e-4;  // m

/// The geometry that FCL is called with: the centre or the axis of a round body, for the reasons
/// given at PairTest::core_distance(), or any other body itself.
struct Core {
  explicit Core(const PlacedShapeRef& body) : pose(*body.pose) {
    if (const auto* sphere = std::get_if<Sphere>(&body.shape->shape)) {
      own = std::make_unique<fcl::Sphered>(0);
      radius = sphere->radius;
    } else if (const auto* capsule = std::get_if<Capsule>(&body.shape->shape)) {
      own = std::make_unique<fcl::Capsuled>(0, capsule->length);
      radius = capsule->radius;
    }
    geometry = own ? own.get() : &body.shape->distance_geometry();
  }
  Pose pose;
  std::unique_ptr<fcl::CollisionGeometryd> own;
  const fcl::CollisionGeometryd* geometry = nullptr;
  double radius = 0;
};

fcl::DistanceResultd distance(const fcl::CollisionGeometryd& a, const Pose& X_a,
                              const fcl::CollisionGeometryd& b, const Pose& X_b) {
  const fcl::DistanceRequestd request(true, false, 0.0, 0.0, kGjkTolerance, fcl::GST_LIBCCD);
  fcl::DistanceResultd result;
  try {
    fcl::distance<double>(&a, X_a, &b, X_b, request, result);
  } catch (const std::exception&) {
    result.min_distance = std::numeric_limits<double>::infinity();
  }
  return result;
}

/// Returns true if the point is inside the body or at most the tolerance outside it. Points inside
/// need not be excluded: two points that belong to their bodies can be as near as the bodies only
/// if both lie on the surfaces.
bool belongs(const Vector3d& point, const Core& core) {
  const Pose at(Eigen::Translation3d{point});
  return distance(fcl::Sphered(0), at, *core.geometry, core.pose).min_distance <=
         core.radius + kPointTolerance;
}

}  // namespace

std::optional<std::array<Vector3d, 2>> nearest_points(const PlacedShapeRef& a,
                                                      const PlacedShapeRef& b, double clearance) {
  if (!(clearance > 0)) return std::nullopt;
  // FCL leaves the points of a sphere before a mesh unset, not those of a mesh before a sphere.
  if (b.shape->mesh && !a.shape->mesh) {
    const auto swapped = nearest_points(b, a, clearance);
    return swapped ? std::optional(std::array{(*swapped)[1], (*swapped)[0]}) : std::nullopt;
  }
  const Core core_a(a), core_b(b);
  // FCL gives the points in the base frame for most kinds of pairs, in the frames of their bodies
  // for others. Either reading has to pass the test before it is used.
  const fcl::DistanceResultd found =
      distance(*core_a.geometry, core_a.pose, *core_b.geometry, core_b.pose);
  const Vector3d p = found.nearest_points[0], q = found.nearest_points[1];
  const std::array<std::array<Vector3d, 2>, 2> readings{
      {{p, q}, {core_a.pose * p, core_b.pose * q}}};
  for (const auto& [from, to] : readings) {
    const double cores_apart = (to - from).norm();
    if (!(std::abs(cores_apart - core_a.radius - core_b.radius - clearance) <= kPointTolerance))
      continue;
    const Vector3d along = (to - from) / cores_apart;
    const Vector3d on_a = from + core_a.radius * along, on_b = to - core_b.radius * along;
    if (belongs(on_a, core_a) && belongs(on_b, core_b)) return std::array{on_a, on_b};
  }
  return std::nullopt;
}

std::optional<Vector3d> common_point(const PlacedShapeRef& a, const PlacedShapeRef& b) {
  PairTest test(PairTest::Meshes::kNear);
  MeshStore none;
  const FclShape dot = make_fcl_shape(Sphere{kPointTolerance / 2}, none);
  // Distance of a point from the further one of the two bodies, m.
  const auto apart = [&](const Vector3d& point) {
    const Pose at(Eigen::Translation3d{point});
    return std::max(test.clearance({&dot, &at}, a), test.clearance({&dot, &at}, b));
  };
  // Cubes in which a common point may lie; the cube whose middle is nearest to both bodies comes
  // first.
  struct Cube {
    double apart;
    int order;
    Vector3d middle;
    double half;
  };
  const auto later = [](const Cube& x, const Cube& y) {
    return std::tie(x.apart, x.order) > std::tie(y.apart, y.order);
  };
  std::priority_queue<Cube, std::vector<Cube>, decltype(later)> cubes(later);
  const PlacedShapeRef& smaller = a.shape->bound.reach < b.shape->bound.reach ? a : b;
  const Vector3d middle = *smaller.pose * smaller.shape->bound.center;
  cubes.push({apart(middle), 0, middle, smaller.shape->bound.reach});
  constexpr int kMost = 4000;
  for (int asked = 1; !cubes.empty() && asked < kMost;) {
    const Cube cube = cubes.top();
    if (cube.apart <= kPointTolerance / 2) return cube.middle;
    cubes.pop();
    const double half = cube.half / 2;
    for (int corner = 0; corner < 8; ++corner, ++asked) {
      const Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      const Vector3d point = cube.middle + half * sign;
      const double far = apart(point);
      if (far <= std::sqrt(3.0) * half) cubes.push({far, asked, point, half});
    }
  }
  return std::nullopt;
}

}  // namespace swivel::detail
