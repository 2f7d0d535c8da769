// SPDX-License-Identifier: BSD-3-Clause
// The verdict on one pair, every pair of shape kinds, against references that share nothing with
// FCL.
#include "exact/pair_test.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "proofs/distance_proof.hpp"
#include "reference.hpp"
#include "seed.hpp"
#include "shapes/bound.hpp"
#include "support.hpp"

namespace swivel {
namespace {

using namespace detail;
using namespace swivel::testing;

constexpr double kTau = 5e-5;  // docs/model.md: the band in which FCL alone decides

/// A point that the shape holds: its centre or, of a mesh, which may be hollow, the middle of a
/// triangle or of an edge.
Vector3d held_point(const Shape& shape, bool of_triangle) {
  const auto* mesh = std::get_if<MeshPtr>(&shape);
  if (!mesh) return Vector3d::Zero();
  const auto& v = (*mesh)->vertices;
  const auto& t = (*mesh)->triangles[(*mesh)->triangles.size() / 2];
  const Vector3d edge = v[t[0]] + v[t[1]];
  return of_triangle ? Vector3d((edge + v[t[2]]) / 3) : Vector3d(edge / 2);
}

struct Tally {
  int apart = 0, touching = 0;
};

/// Counts verdicts on pairs, and those that a distance proof gave.
struct VerdictCounts {
  int verdicts = 0, proved = 0;
};

/// Compares verdicts and distance proofs about d (m) with the clearance `truth` (m) of two placed
/// shapes, for increasing d up to beyond that clearance.
void check_verdicts(PairTest& test, const PlacedShapeRef& a, const PlacedShapeRef& b, double truth,
                    const std::string& what, VerdictCounts& counts) {
  std::vector<double> thresholds{0.0, 0.001, 0.005, 0.02, 0.1};
  for (const double offset : {-2 * kTau, -1.1 * kTau, 1.1 * kTau, 2 * kTau})
    if (truth + offset >= 0) thresholds.push_back(truth + offset);
  std::sort(thresholds.begin(), thresholds.end());
  const Bound &bound_a = a.shape->bound, &bound_b = b.shape->bound;
  bool was_below = false;
  for (const double d : thresholds) {
    const bool below = test.below(a, b, d);
    ASSERT_TRUE(below || !was_below) << what << ": not monotone at " << d;
    was_below = below;
    if (truth == 0 || std::abs(truth - d) > kTau) {
      ASSERT_EQ(below, truth == 0 || truth < d) << what << ", d " << d;
    }
    const bool apart =
        proved_apart(bound_a, place(bound_a, *a.pose), bound_b, place(bound_b, *b.pose), d + 1e-6);
    ASSERT_FALSE(apart && below) << what;
    const DistanceProof certificate = prove_distance(a, b, d);
    ASSERT_FALSE(certificate == DistanceProof::kFree && (truth < d || truth == 0))
        << what << ", d " << d;
    ASSERT_FALSE(certificate == DistanceProof::kColliding && truth >= d && truth > 0)
        << what << ", d " << d;
    counts.proved += certificate != DistanceProof::kNone;
    ++counts.verdicts;
  }
}

TEST(PairTest, EveryPairOfKindsAgreesWithTheReference) {
  Random random(21);
  PairTest test;
  MeshStore store;
  std::map<std::pair<int, int>, Tally> tally;
  VerdictCounts counts;
  double worst = 0;
  for (int ka = 0; ka < 7; ++ka)
    for (int kb = 0; kb < 7; ++kb)
      for (int k = 0; k < test::trials(16); ++k) {
        const Shape a = random_shape(ka, random), b = random_shape(kb, random);
        const Pose X_a = random.pose(0.05);
        Pose X_b = random.pose(k % 4 == 0 ? 0.1 : 0.3);
        if (k % 8 == 0)
          X_b.translation() = X_a * held_point(a, true) -
                              X_b.linear() * held_point(b, false);  // an edge through a side
        const double truth = reference_clearance(a, X_a, b, X_b);
        const FclShape fa = make_fcl_shape(a, store), fb = make_fcl_shape(b, store);
        const PlacedShapeRef pa{&fa, &X_a}, pb{&fb, &X_b};
        const std::string what = kKinds[ka] + " / " + kKinds[kb] + ", reference " +
                                 std::to_string(truth) + ", case " + std::to_string(k);

        const double found = test.clearance(pa, pb);
        ASSERT_NEAR(found, truth, kTau) << what;
        worst = std::max(worst, std::abs(found - truth));
        ASSERT_LE(distance_bound(fa.bound, place(fa.bound, X_a), fb.bound, place(fb.bound, X_b)),
                  truth + 1e-5)
            << what;
        check_verdicts(test, pa, pb, truth, what, counts);
        if (HasFatalFailure()) return;
        ++(truth > 0 ? tally[{ka, kb}].apart : tally[{ka, kb}].touching);
      }
  EXPECT_EQ(test.counters().fcl_failures, 0);
  EXPECT_GT(counts.verdicts, test::at_least(5500));
  EXPECT_GT(counts.proved, counts.verdicts * 3 / 4);
  for (const auto& [kinds, t] : tally) {
    const std::string what = kKinds[kinds.first] + " / " + kKinds[kinds.second];
    EXPECT_GE(t.apart, test::at_least(1)) << what;
    EXPECT_GE(t.touching, test::at_least(1)) << what;
  }
  RecordProperty("worst_clearance_error_um", static_cast<int>(worst * 1e6));
}

/// What is proved below a distance is, by the plain verdict; what is proved below less than nothing
/// touches still where one of the bodies has moved by as much.
TEST(PairTest, ProofsBelowHoldHoweverBodiesMove) {
  Random random(23);
  PairTest test;
  MeshStore store;
  int deep = 0, near = 0, missed = 0;
  std::map<std::pair<int, int>, int> proved;
  for (int k = 0; k < test::trials(20000); ++k) {
    const int ka = random.index(7), kb = random.index(7);
    const Shape a = random_shape(ka, random), b = random_shape(kb, random);
    const Pose X_a = random.pose(0.05);
    const Pose X_b = random.pose(k % 2 == 0 ? 0.1 : 0.3);
    const FclShape fa = make_fcl_shape(a, store), fb = make_fcl_shape(b, store);
    const double d = k % 3 == 0 ? random.uniform(0, 0.05) : -random.uniform(0, 0.06);
    TrianglePair warm_start;
    if (!proves_below({&fa, &X_a}, {&fb, &X_b}, d, warm_start)) {
      missed += d >= 0 && test.below({&fa, &X_a}, {&fb, &X_b}, d);
      continue;
    }
    ++(d < 0 ? deep : near);
    ++proved[std::minmax(ka, kb)];
    for (int move = 0; move < (d < 0 ? 4 : 1); ++move) {
      const Vector3d way =
          Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1))
              .normalized();
      Pose moved = X_b;
      moved.translation() += std::max(0.0, -d) * way;
      ASSERT_TRUE(test.below({&fa, &X_a}, {&fb, &moved}, std::max(0.0, d)))
          << kKinds[ka] << " / " << kKinds[kb] << ", case " << k << ", d " << d;
    }
  }
  std::printf(
      "%d proved deeper than asked, %d nearer, %d of those nearer not proved, %zu pairs of kinds\n",
      deep, near, missed, proved.size());
  EXPECT_GT(deep, test::at_least(1000));
  EXPECT_GT(near, test::at_least(2000));
  EXPECT_GT(proved.size(), static_cast<std::size_t>(test::at_least(20)));
}

TEST(PairTest, BoundedDistanceIsTheFreshVerdict) {
  Random random(22);
  PairTest test;
  MeshStore store;
  int near = 0, far = 0, band = 0;
  for (int k = 0; k < test::trials(1500); ++k) {
    const Shape a = random_shape(2 + random.index(5), random),
                b = random_shape(2 + random.index(5), random);
    const Pose X_a = random.pose(0.05), X_b = random.pose(0.25);
    const FclShape fa = make_fcl_shape(a, store), fb = make_fcl_shape(b, store);
    const double fresh = test.clearance({&fa, &X_a}, {&fb, &X_b});
    for (const double d : {0.0025, std::max(0.0, fresh - 2e-6), fresh + 2e-6}) {
      if (std::abs(fresh - d) < 1e-6) {
        ++band;
        continue;
      }
      const bool below = test.below({&fa, &X_a}, {&fb, &X_b}, d);
      ASSERT_EQ(below, fresh <= 0 || fresh < d) << fresh << " " << d << " case " << k;
      ++(below ? near : far);
    }
  }
  EXPECT_GE(near, test::at_least(801));
  EXPECT_GE(far, test::at_least(801));
  EXPECT_LT(band, 1500);
}

/// A shape in the middle of a panel 40 mm thick.
bool meets_panel(const Shape& shape, bool closed) {
  TriangleMesh panel = panel_mesh(0.8, 0.6, 0.04, 12);
  if (!closed) panel.triangles.pop_back();
  MeshStore store;
  PairTest test;
  const FclShape fa = make_fcl_shape(shape, store),
                 fb = make_fcl_shape(as_mesh(panel, "panel"), store);
  Pose X = Pose::Identity();
  X.translation().z() = 0.15;  // the middle of the curved panel there
  const Pose still = Pose::Identity();
  const bool below = test.below({&fa, &X}, {&fb, &still}, 0.001);
  EXPECT_EQ(test.below({&fb, &still}, {&fa, &X}, 0.001), below);
  EXPECT_EQ(test.clearance({&fa, &X}, {&fb, &still}) == 0, below);
  return below;
}

TEST(PairTest, InsideAClosedPanelIsACollision) {
  const std::vector<Shape> small{Sphere{0.004},
                                 Capsule{0.003, 0.01},
                                 Box{Vector3d(0.01, 0.01, 0.005)},
                                 Cylinder{0.004, 0.005},
                                 as_mesh(box_mesh(Vector3d(0.01, 0.01, 0.005), 1), "box"),
                                 as_mesh(tube_mesh(0.004, 0.005, 8), "tube")};
  for (const Shape& shape : small) {
    EXPECT_TRUE(meets_panel(shape, true)) << shape.index();
    EXPECT_FALSE(meets_panel(shape, false)) << shape.index();
  }
}

TEST(PairTest, AMeshInsideAPrimitiveIsACollision) {
  MeshStore store;
  PairTest test;
  const FclShape mesh = make_fcl_shape(as_mesh(tube_mesh(0.01, 0.02, 8), "tube"), store);
  const Pose X = Pose::Identity();
  for (const Shape& shape : std::vector<Shape>{Sphere{0.1}, Capsule{0.1, 0.2},
                                               Box{Vector3d(0.2, 0.2, 0.2)}, Cylinder{0.1, 0.2}}) {
    const FclShape solid = make_fcl_shape(shape, store);
    EXPECT_TRUE(test.below({&mesh, &X}, {&solid, &X}, 0)) << shape.index();
    EXPECT_TRUE(test.below({&solid, &X}, {&mesh, &X}, 0.001)) << shape.index();
    EXPECT_EQ(test.clearance({&solid, &X}, {&mesh, &X}), 0) << shape.index();
  }
}

TEST(MeshStore, BuildsEachMeshOnceAndRefusesEmptyOnes) {
  MeshStore store;
  const MeshPtr mesh = as_mesh(sphere_mesh(0.1, 6), "ball");
  EXPECT_EQ(store.model(mesh), store.model(mesh));
  EXPECT_NE(store.model(mesh), store.model(as_mesh(sphere_mesh(0.1, 6), "ball")));
  EXPECT_THROW(store.model(as_mesh({}, "nothing")), std::runtime_error);
}

}  // namespace
}  // namespace swivel
