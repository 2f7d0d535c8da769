// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "shapes/placed_shape.hpp"
#include "swivel/collision/proofs/verdict.hpp"

namespace swivel::detail {

/// GJK stops at the first step that gains less than this. At the default, 1e-6, it returned up to 13 mm too much between a box and
/// a cylinder; at 1e-10 no more than 0.05 um, for the same time.
inline constexpr double kGjkTolerance = 1e-10;

/// FCL's verdicts on one pair of bodies, and a count of what they took; so it belongs to one thread.
/// Every verdict is a function of its arguments alone: fresh results, a before b, no cached guess, no penetration depth (which can
/// throw and abort).
class PairTest {
 public:
  /// What FCL is asked about a mesh before a box, cylinder or mesh. kNear: of the triangles only those that are near enough to
  /// decide, which our own trees find; the answers are the same. FCL's trees, a third of a second for a hundred thousand triangles,
  /// are then hardly ever built.
  enum class Meshes { kWhole, kNear };
  explicit PairTest(Meshes meshes = Meshes::kWhole) : meshes_(meshes) {}
  /// clearance(a, b) < d; d >= 0. True also where FCL fails, which is counted.
  bool below(const PlacedShapeRef& a, const PlacedShapeRef& b, double d);
  /// Clearance, m; 0 when touching, inside each other, or where FCL fails. `witness`: triangles at which the search for the near
  /// ones begins, and where it ended; the answer does not depend on it.
  double clearance(const PlacedShapeRef& a, const PlacedShapeRef& b, TrianglePair* witness = nullptr);
  [[nodiscard]] const CollisionCounters& counters() const { return counters_; }

 private:
  bool inflated_meets(const PlacedShapeRef& round, const PlacedShapeRef& other, bool round_first, double d);
  bool meets(const fcl::CollisionGeometryd& a, const Pose& X_a, const fcl::CollisionGeometryd& b, const Pose& X_b);
  double core_distance(const PlacedShapeRef& round, const PlacedShapeRef& other, bool round_first);
  double distance(const fcl::CollisionGeometryd& a, const Pose& X_a, const fcl::CollisionGeometryd& b, const Pose& X_b,
                  double bound);

  double whole_distance(const PlacedShapeRef& a, const PlacedShapeRef& b, double bound);
  double near_distance(const PlacedShapeRef& a, const PlacedShapeRef& b, double limit, double bound);

  Meshes meshes_;
  CollisionCounters counters_;
};

}  // namespace swivel::detail
