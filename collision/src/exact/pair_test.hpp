// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "shapes/placed_shape.hpp"
#include "swivel/collision/proofs/verdict.hpp"

namespace swivel::detail {

/// GJK stops at the first step that gains less than this. At the default, 1e-6, it returned up to
/// 13 mm too much between a box and a cylinder; at 1e-10 no more than 0.05 um, for the same time.
inline constexpr double kGjkTolerance = 1e-10;

/// Asks FCL about pairs of bodies, and counts the calls, so that an instance belongs to one thread.
/// Every verdict depends on its arguments alone: FCL gets a fresh result object, a before b, no
/// cached guess, and is never asked for a penetration depth (which can throw and abort).
class PairTest {
 public:
  /// How FCL is called about a mesh and a box, cylinder or mesh. kWhole: with all triangles. kNear:
  /// only with the triangles that are near enough to decide, which our own trees find; the answers
  /// are the same. With kNear, FCL's trees, which take a third of a second for a hundred thousand
  /// triangles, are hardly ever built.
  enum class Meshes { kWhole, kNear };
  explicit PairTest(Meshes meshes = Meshes::kWhole) : meshes_(meshes) {}
  /// Returns true if the clearance of a and b is less than d >= 0, m, or if FCL fails, which is
  /// counted.
  bool below(const PlacedShapeRef& a, const PlacedShapeRef& b, double d);
  /// Returns the clearance of a and b, m; 0 if they touch, if one is inside the other, or if FCL
  /// fails. `warm_start` is a warm start for the search for near triangles: on entry the triangles
  /// at which it begins, on return those at which it ended. The answer does not depend on it.
  double clearance(const PlacedShapeRef& a, const PlacedShapeRef& b,
                   TrianglePair* warm_start = nullptr);
  [[nodiscard]] const CollisionCounters& counters() const { return counters_; }

 private:
  bool inflated_meets(const PlacedShapeRef& round, const PlacedShapeRef& other, bool round_first,
                      double d);
  bool meets(const fcl::CollisionGeometryd& a, const Pose& X_a, const fcl::CollisionGeometryd& b,
             const Pose& X_b);
  double core_distance(const PlacedShapeRef& round, const PlacedShapeRef& other, bool round_first);
  double distance(const fcl::CollisionGeometryd& a, const Pose& X_a,
                  const fcl::CollisionGeometryd& b, const Pose& X_b, double bound);

  double whole_distance(const PlacedShapeRef& a, const PlacedShapeRef& b, double bound);
  double near_distance(const PlacedShapeRef& a, const PlacedShapeRef& b, double limit,
                       double bound);

  Meshes meshes_;
  CollisionCounters counters_;
};

}  // namespace swivel::detail
