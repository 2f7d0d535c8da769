// SPDX-License-Identifier: BSD-3-Clause
#include "exact/pair_test.hpp"

#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "proofs/distance_proof.hpp"
#include "swivel/core/base/timeline.hpp"

namespace swivel::detail {

namespace {

/// Below this distance of two surfaces, m, FCL is called with all triangles, because there it
/// matters which body is inside which.
constexpr double kTouching = 2 * kVerdictBand;

bool is_round(const PlacedShapeRef& body) {
  return body.shape->kind == FclShape::Kind::kRound;
}

}  // namespace

bool PairTest::below(const PlacedShapeRef& a, const PlacedShapeRef& b, double d) {
  bool near = false;
  if (is_round(a)) {
    near = inflated_meets(a, b, true, d);
  } else if (is_round(b)) {
    near = inflated_meets(b, a, false, d);
  } else {
    // FCL skips subtrees that cannot beat the result it is given. A result that starts just above d
    // gives the verdict of a fresh one, without a search for the minimum, which is not needed.
    constexpr double kAbove = 1e-5;
    if (meshes_ == Meshes::kNear && are_triangles(a, b)) {
      TrianglePair anywhere;
      const double own = triangle_distance(a, b, d - kTriangleBand, d + kTriangleBand, anywhere);
      if (std::abs(own - d) >= kTriangleBand) return own < d;
    }
    const bool some = meshes_ == Meshes::kNear && d > kTouching &&
                      (a.shape->mesh || b.shape->mesh) && !one_inside_solid(a, b);
    const double found =
        some ? near_distance(a, b, d + kVerdictBand, d + kAbove) : whole_distance(a, b, d + kAbove);
    near = found < d || found <= 0;
  }
  return near || one_inside_other(a, b);
}

double PairTest::clearance(const PlacedShapeRef& a, const PlacedShapeRef& b,
                           TrianglePair* warm_start) {
  constexpr double kUnbounded = std::numeric_limits<double>::max();
  double found = 0;
  if (is_round(a)) {
    found = inflated_meets(a, b, true, 0) ? 0 : core_distance(a, b, true);
  } else if (is_round(b)) {
    found = inflated_meets(b, a, false, 0) ? 0 : core_distance(b, a, false);
  } else {
    const bool some =
        meshes_ == Meshes::kNear && (a.shape->mesh || b.shape->mesh) && !one_inside_solid(a, b);
    constexpr double kFarAway = 1e6;  // m
    TrianglePair anywhere;
    const double surfaces =
        some ? surface_distance(a, b, 0, kFarAway, warm_start ? *warm_start : anywhere) : 0;
    found = surfaces > kTouching ? near_distance(a, b, surfaces + kVerdictBand, kUnbounded)
                                 : whole_distance(a, b, kUnbounded);
  }
  return found <= 0 || one_inside_other(a, b) ? 0 : found;
}

bool PairTest::inflated_meets(const PlacedShapeRef& round, const PlacedShapeRef& other,
                              bool round_first, double d) {
  const fcl::CollisionGeometryd* tree =
      other.shape->mesh ? &other.shape->mesh->boolean_tree() : nullptr;
  const fcl::CollisionGeometryd& still = tree ? *tree : *other.shape->geometry;
  const auto ask = [&](const fcl::CollisionGeometryd& grown) {
    return round_first ? meets(grown, *round.pose, still, *other.pose)
                       : meets(still, *other.pose, grown, *round.pose);
  };
  if (const auto* sphere = std::get_if<Sphere>(&round.shape->shape))
    return ask(fcl::Sphered(sphere->radius + d));
  const auto& capsule = std::get<Capsule>(round.shape->shape);
  return ask(fcl::Capsuled(capsule.radius + d, capsule.length));
}

bool PairTest::meets(const fcl::CollisionGeometryd& a, const Pose& X_a,
                     const fcl::CollisionGeometryd& b, const Pose& X_b) {
  const fcl::CollisionRequestd request(1, false);
  fcl::CollisionResultd result;
  ++counters_.fcl_calls;
  const TraceSpan span("fcl::collide");
  try {
    return fcl::collide<double>(&a, X_a, &b, X_b, request, result) > 0;
  } catch (const std::exception&) {
    ++counters_.fcl_failures;
    return true;
  }
}

/// Returns the distance from the centre or the axis of a round body, less its radius, m. The body
/// itself is not used: GJK stops as soon as a step gains less than its tolerance, and round shapes
/// gain slowly, so that it returned 0.15 mm too much for a whole capsule; and FCL leaves the
/// distance of a sphere and a triangle that intersect unset.
double PairTest::core_distance(const PlacedShapeRef& round, const PlacedShapeRef& other,
                               bool round_first) {
  constexpr double kUnbounded = std::numeric_limits<double>::max();
  const auto ask = [&](const fcl::CollisionGeometryd& core) {
    const fcl::CollisionGeometryd& still = other.shape->distance_geometry();
    return round_first ? distance(core, *round.pose, still, *other.pose, kUnbounded)
                       : distance(still, *other.pose, core, *round.pose, kUnbounded);
  };
  if (const auto* sphere = std::get_if<Sphere>(&round.shape->shape))
    return ask(fcl::Sphered(0)) - sphere->radius;
  const auto& capsule = std::get<Capsule>(round.shape->shape);
  return ask(fcl::Capsuled(0, capsule.length)) - capsule.radius;
}

double PairTest::whole_distance(const PlacedShapeRef& a, const PlacedShapeRef& b, double bound) {
  return distance(a.shape->distance_geometry(), *a.pose, b.shape->distance_geometry(), *b.pose,
                  bound);
}

/// Returns FCL's distance, m, of only those triangles of the bodies that are within `limit`, m, of
/// each other, or `bound` if there are none. `limit` must exceed the distance sought by more than
/// FCL may err.
double PairTest::near_distance(const PlacedShapeRef& a, const PlacedShapeRef& b, double limit,
                               double bound) {
  const Pose b_in_a = a.pose->inverse(Eigen::Isometry) * *b.pose;
  const double beyond = a.shape->beyond_triangles + b.shape->beyond_triangles;
  const auto near = a.shape->triangles().nearer(b.shape->triangles(), b_in_a, limit + beyond);
  if (near[0].empty()) return bound;
  const auto part_a = a.shape->mesh ? a.shape->mesh->distance_tree_of(near[0]) : nullptr;
  const auto part_b = b.shape->mesh ? b.shape->mesh->distance_tree_of(near[1]) : nullptr;
  const fcl::CollisionGeometryd &near_a = part_a ? *part_a : *a.shape->geometry,
                                &near_b = part_b ? *part_b : *b.shape->geometry;
  return distance(near_a, *a.pose, near_b, *b.pose, bound);
}

/// Returns FCL's distance, m, or `bound` if it is not below that; zero or less if the surfaces meet
/// or FCL fails.
double PairTest::distance(const fcl::CollisionGeometryd& a, const Pose& X_a,
                          const fcl::CollisionGeometryd& b, const Pose& X_b, double bound) {
  const fcl::DistanceRequestd request(false, false, 0.0, 0.0, kGjkTolerance, fcl::GST_LIBCCD);
  fcl::DistanceResultd result(bound);
  ++counters_.fcl_calls;
  const TraceSpan span("fcl::distance");
  try {
    fcl::distance<double>(&a, X_a, &b, X_b, request, result);
    return result.min_distance;
  } catch (const std::exception&) {
    ++counters_.fcl_failures;
    return 0;
  }
}

}  // namespace swivel::detail
