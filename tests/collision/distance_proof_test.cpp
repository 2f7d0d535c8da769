// SPDX-License-Identifier: BSD-3-Clause
// Distance proofs against FCL: a verdict that a distance proof gives must be FCL's. docs/model.md
// "Clearance".
#include "proofs/distance_proof.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <tuple>

#include "exact/pair_test.hpp"
#include "robots.hpp"
#include "support.hpp"
#include "swivel/collision/world/world.hpp"

namespace swivel {
namespace {

using namespace detail;
using test::Random;

constexpr double kTau = kVerdictBand;

Pose random_pose(Random& random, double range) {
  Eigen::Vector4d turn;
  for (int k = 0; k < 4; ++k) turn[k] = random.uniform(-1, 1);
  Pose pose = Pose::Identity();
  pose.linear() = Quaterniond(turn.normalized()).toRotationMatrix();
  for (int k = 0; k < 3; ++k) pose.translation()[k] = random.uniform(-range, range);
  return pose;
}

Vector3d random_size(Random& random, double low, double high) {
  return {random.uniform(low, high), random.uniform(low, high), random.uniform(low, high)};
}

/// One sheet of triangles, without thickness.
TriangleMesh sheet_mesh(double width, double height, int n) {
  TriangleMesh mesh = testing::panel_mesh(width, height, 0.04, n);
  mesh.triangles.resize(4 * n * n);  // the upper side comes first
  return mesh;
}

/// Meshes with walls thin and thick, open and closed, with room for a body inside.
std::vector<MeshPtr> meshes() {
  return {testing::as_mesh(testing::panel_mesh(1.0, 0.6, 0.04, 6), "panel"),
          testing::as_mesh(testing::panel_mesh(0.6, 0.5, 0.001, 6), "thin panel"),
          testing::as_mesh(sheet_mesh(0.8, 0.6, 6), "sheet"),
          testing::as_mesh(testing::box_mesh(Vector3d(0.9, 0.8, 0.7), 2), "crate"),
          testing::as_mesh(testing::torus_mesh(0.2, 0.05, 8), "torus"),
          testing::as_mesh(testing::tube_mesh(0.08, 0.6, 12), "pipe"),
          testing::as_mesh(testing::sphere_mesh(0.1, 5), "ball"),
          testing::as_mesh(testing::joined(testing::box_mesh(Vector3d(0.5, 0.5, 0.5), 1),
                                           testing::sphere_mesh(0.04, 4)),
                           "two parts")};
}

std::vector<SceneObject> random_scene(Random& random, const std::vector<MeshPtr>& pool) {
  std::vector<SceneObject> scene;
  for (int k = 0; k < 3; ++k) {
    Shape shape;
    switch (random.below(7)) {
      case 0:
        shape = Sphere{random.uniform(0.005, 0.2)};
        break;
      case 1:
        shape = Capsule{random.uniform(0.005, 0.1), random.uniform(0.05, 0.8)};
        break;
      case 2:
        shape = Box{random_size(random, 0.05, 0.5)};
        break;
      case 3:
        shape = Box{Vector3d(random.uniform(0.2, 1), random.uniform(0.2, 1), 0.001)};
        break;
      case 4:
        shape = Cylinder{random.uniform(0.005, 0.15), random.uniform(0.02, 1)};
        break;
      default:
        shape = pool[random.below(static_cast<int>(pool.size()))];
    }
    Pose pose = random_pose(random, 0.9);
    pose.translation().z() += 0.6;
    scene.push_back({"object" + std::to_string(k), shape, pose, {}});
  }
  return scene;
}

/// Queries of one world that are compared: `asked` and `fast` with distance proofs, `off` by FCL
/// alone.
struct ComparedQueries {
  explicit ComparedQueries(const World& of)
      : world(of),
        asked(of, DistanceProofs::kOn),
        fast(of, DistanceProofs::kOn),
        off(of, DistanceProofs::kOff) {}
  const World& world;
  World::Query asked, fast, off;
};

/// Names the configuration of a scene in messages.
struct CaseName {
  std::uint64_t base;
  int scene, configuration;
  friend std::ostream& operator<<(std::ostream& out, const CaseName& name) {
    return out << "SWIVEL_TEST_SEED=" << name.base << " scene " << name.scene << " configuration "
               << name.configuration;
  }
};

/// Counts what queries with distance proofs and by FCL alone were asked.
struct LaneCounts {
  std::int64_t questions = 0, pairs = 0, at_threshold = 0, clearances = 0, touching = 0, bodies = 0;
};

/// Returns whether some pair of bodies is nearer than d (m) at q, and compares each pair up to the
/// first of them with FCL.
bool ask(ComparedQueries& queries, const Config& q, double d, const CaseName& name,
         LaneCounts& counts) {
  const auto found = queries.asked.find_violating_pair(q, d);
  for (const BodyPair& pair : queries.world.pairs()) {  // up to the first that FCL names
    const bool below = queries.off.pair_violates(q, pair, d);
    EXPECT_EQ(queries.asked.pair_violates(q, pair, d), below) << name << " d " << d;
    ++counts.pairs;
    if (below) {
      EXPECT_EQ(found, pair);
      break;
    }
  }
  ++counts.questions;
  return found.has_value();
}

/// Compares the clearance at q with that by FCL alone.
void check_clearance(ComparedQueries& queries, const Config& q, const CaseName& name,
                     LaneCounts& counts) {
  const auto plain = queries.off.clearance(q), sooner = queries.fast.clearance(q);
  ASSERT_EQ(plain.has_value(), sooner.has_value());
  if (plain) {
    EXPECT_EQ(std::tuple(sooner->distance, sooner->required, sooner->least),
              std::tuple(plain->distance, plain->required, plain->least));
    EXPECT_EQ(sooner->pair, plain->pair) << name;
    counts.touching += plain->distance == 0;
  }
  ++counts.clearances;
}

/// Compares how near each body is at q with what FCL alone says: the same numbers, the least of
/// them that of all pairs; where bodies are near, no pair of the body nearer and the named one no
/// further.
void check_body_clearances(ComparedQueries& queries, const Config& q, const CaseName& name,
                           LaneCounts& counts) {
  constexpr double kNear = 0.05;  // m, up to where pairs are asked about elsewhere
  const auto plain = queries.off.body_clearances(q), sooner = queries.fast.body_clearances(q);
  ASSERT_EQ(plain.size(), queries.world.body_names().size());
  ASSERT_EQ(sooner.size(), plain.size());
  double least = std::numeric_limits<double>::max();
  for (int body = 0; body < static_cast<int>(plain.size()); ++body) {
    const auto& found = sooner[static_cast<std::size_t>(body)];
    const auto& fcl = plain[static_cast<std::size_t>(body)];
    bool has_pair = false;
    for (const BodyPair& pair : queries.world.pairs()) {
      if (pair.a != body && pair.b != body) continue;
      has_pair = true;
      const double less = std::min(fcl ? fcl->distance : 0, kNear) - 1.1 * kTau;
      EXPECT_FALSE(less > 0 && queries.off.pair_violates(q, pair, less)) << name << ' ' << body;
    }
    ASSERT_EQ(fcl.has_value(), has_pair) << name << " body " << body;
    ASSERT_EQ(found.has_value(), has_pair) << name << " body " << body;
    if (!found) continue;
    EXPECT_EQ(found->distance, fcl->distance) << name << " body " << body;
    EXPECT_EQ(found->pair, fcl->pair) << name << " body " << body;
    EXPECT_TRUE(found->pair.a == body || found->pair.b == body);
    least = std::min(least, found->distance);
    if (found->distance < kNear) {
      EXPECT_TRUE(queries.off.pair_violates(q, found->pair, found->distance + 1.1 * kTau)) << name;
      ++counts.bodies;
    }
  }
  EXPECT_EQ(least, queries.off.clearance(q)->least) << name;
}

/// Asks about distances within three bands of verdicts of the clearance at q, where it is less than
/// 0.3 m and more than nothing.
void check_near_clearance(ComparedQueries& queries, const Config& q, const CaseName& name,
                          LaneCounts& counts) {
  World::Query& fast = queries.fast;
  double low = 0, high = 0.3;  // of the clearance
  if (fast.find_violating_pair(q, low) || !fast.find_violating_pair(q, high)) return;
  while (high - low > 1e-7) {
    const double middle = (low + high) / 2;
    (fast.find_violating_pair(q, middle) ? high : low) = middle;
  }
  for (const double offset :
       {-3 * kTau, -1.1 * kTau, -0.5 * kTau, 0.5 * kTau, 1.1 * kTau, 3 * kTau}) {
    if (low + offset < 0) continue;
    const bool below = ask(queries, q, low + offset, name, counts);
    if (std::abs(offset) > kTau) {
      EXPECT_EQ(below, offset > 0) << "clearance " << low << " offset " << offset;
    }
    ++counts.at_threshold;
  }
}

class Lanes : public ::testing::TestWithParam<int> {};

TEST_P(Lanes, CapsuleRobotsAsFclSeesThem) {
  const std::uint64_t base = test::seed("Certificates");
  Random random(base * 64 + static_cast<std::uint64_t>(GetParam()));
  const auto pool = meshes();
  const auto robots = test::all_robots();
  const test::TestRobot& robot = robots[GetParam() % robots.size()];
  const ArmModel arm = test::arm_of(robot);
  const World empty(*robot.model, arm, test::problem_for(robot));
  const int scenes = test::trials(125), configurations = 1000;
  CollisionCounters sum, by_fcl;
  LaneCounts counts;
  for (int s = 0; s < scenes; ++s) {
    const World world(empty, random_scene(random, pool));
    ComparedQueries queries(world);
    for (int k = 0; k < configurations; ++k) {
      const CaseName name{base, s, k};
      const Config q = test::random_config(arm.chain, random);
      if (k % 100 == 0) check_clearance(queries, q, name, counts);
      if (k % 50 == 0) check_body_clearances(queries, q, name, counts);
      if (HasFatalFailure()) return;
      ask(queries, q, k % 3 == 0 ? 0 : k % 3 == 1 ? 0.005 : random.uniform(0, 0.05), name, counts);
      if (k % 20 == 0) check_near_clearance(queries, q, name, counts);
    }
    sum += queries.asked.counters();
    by_fcl += queries.off.counters();
  }
  const auto [questions, pairs, at_threshold, clearances, touching, bodies] = counts;
  const std::int64_t undecided = questions - sum.proved_free - sum.proved_colliding;
  std::printf(
      "%s: %d configurations, %lld questions, %lld of them within 3 tau of the clearance: %lld "
      "certified free, %lld certified "
      "colliding, %lld undecided; %lld pairs asked of both, %lld FCL calls for %lld; %lld bodies "
      "near others\n",
      robot.name.c_str(), scenes * configurations, static_cast<long long>(questions),
      static_cast<long long>(at_threshold), static_cast<long long>(sum.proved_free),
      static_cast<long long>(sum.proved_colliding), static_cast<long long>(undecided),
      static_cast<long long>(pairs), static_cast<long long>(sum.fcl_calls),
      static_cast<long long>(by_fcl.fcl_calls), static_cast<long long>(bodies));
  EXPECT_GT(bodies, scenes);
  EXPECT_GT(clearances - touching, clearances / 10);
  EXPECT_EQ(sum.fcl_failures, 0);
  EXPECT_GT(at_threshold, scenes * 10);
  EXPECT_GT(sum.proved_free, questions / 50);
  EXPECT_GT(sum.proved_colliding, questions / 50);
  EXPECT_LT(undecided, questions / 50 + at_threshold);
}
INSTANTIATE_TEST_SUITE_P(Eight, Lanes, ::testing::Range(0, 8));

struct Verdicts {
  int free = 0, colliding = 0, none = 0;
  void add(DistanceProof c) {
    ++(c == DistanceProof::kFree ? free : c == DistanceProof::kColliding ? colliding : none);
  }
  [[nodiscard]] int all() const { return free + colliding + none; }
};

/// A mesh of the pool and a shape of kind 0 to 5 (sphere, capsule, capsule, box, cylinder, mesh of
/// the pool), placed near each other (m), in either order.
struct RandomPair {
  int kind = 0;
  FclShape mesh, other;
  Pose X_mesh, X_other;
  bool swapped = false;
  [[nodiscard]] PlacedShapeRef a() const {
    return swapped ? PlacedShapeRef{&other, &X_other} : PlacedShapeRef{&mesh, &X_mesh};
  }
  [[nodiscard]] PlacedShapeRef b() const {
    return swapped ? PlacedShapeRef{&mesh, &X_mesh} : PlacedShapeRef{&other, &X_other};
  }
};

/// Draws a pair of which one body is a mesh of the pool.
RandomPair random_pair(Random& random, const std::vector<MeshPtr>& pool, MeshStore& store) {
  RandomPair pair;
  const double small = random.coin(0.2) ? 0.005 : random.uniform(0.01, 0.15);
  pair.kind = random.below(6);
  Shape other;
  if (pair.kind == 0) other = Sphere{small};
  if (pair.kind == 1 || pair.kind == 2) other = Capsule{small, random.uniform(0.01, 0.5)};
  if (pair.kind == 3) other = Box{random_size(random, small / 4, 2 * small)};
  if (pair.kind == 4) other = Cylinder{small, random.uniform(0.005, 0.4)};
  if (pair.kind == 5) other = pool[random.below(static_cast<int>(pool.size()))];
  pair.mesh = make_fcl_shape(pool[random.below(static_cast<int>(pool.size()))], store);
  pair.other = make_fcl_shape(other, store);
  pair.X_mesh = random_pose(random, 0.1);
  pair.X_other =
      pair.X_mesh * random_pose(random, random.coin(0.3) ? 0.15 : 0.6);  // the nearer often inside
  pair.swapped = random.coin();
  return pair;
}

/// Compares the clearance (m) that a pair test of near parts gives with that of whole meshes.
void check_near_parts(PairTest& near_parts, const RandomPair& pair, double clearance,
                      const std::string& where) {
  const PlacedShapeRef a = pair.a(), b = pair.b();
  ASSERT_EQ(near_parts.clearance(a, b), clearance) << where << " kind " << pair.kind;
  if (clearance > 0 && pair.kind > 2) {
    ASSERT_TRUE(near_parts.below(a, b, std::nextafter(clearance, 1)))
        << where << " kind " << pair.kind;
    ASSERT_FALSE(near_parts.below(a, b, clearance)) << where << " kind " << pair.kind;
  }
}

/// Compares the distance of two bodies made of triangles with their clearance (m).
void check_triangle_distance(const RandomPair& pair, double clearance, Random& random,
                             const std::string& where) {
  const PlacedShapeRef a = pair.a(), b = pair.b();
  TrianglePair anywhere;
  const double own = triangle_distance(a, b, 0, 10, anywhere);
  ASSERT_NEAR(own, clearance, clearance > kTriangleBand ? kTriangleBand / 2 : 2 * kTriangleBand)
      << where << " kind " << pair.kind;
  if (const double d = clearance - random.uniform(-2, 4) * kTriangleBand; d > 0 && clearance > 0) {
    ASSERT_TRUE(!proves_beyond(a, b, d, anywhere) || clearance > d) << where;
  }
}

/// Compares what is proved about the distance d (m) with the clearance (m), and counts the verdict.
void check_proof(const RandomPair& pair, double clearance, double d, const std::string& where,
                 Verdicts& tally) {
  const PlacedShapeRef a = pair.a(), b = pair.b();
  const double beyond = pair.mesh.beyond_triangles + pair.other.beyond_triangles;
  const DistanceProof certificate = prove_distance(a, b, d);
  const std::string what = where + " kind " + std::to_string(pair.kind) + " clearance " +
                           std::to_string(clearance) + " d " + std::to_string(d);
  ASSERT_FALSE(certificate == DistanceProof::kFree && (clearance < d || clearance == 0)) << what;
  ASSERT_FALSE(certificate == DistanceProof::kColliding && clearance >= d && clearance > 0) << what;
  // And none is held back: by more than the band, what FCL errs, and what the prism lacks, all
  // is decided.
  if (clearance > d + 2.5 * kTau + beyond) {
    ASSERT_EQ(certificate, DistanceProof::kFree) << what;
  }
  if (clearance < d - 2.5 * kTau - beyond) {
    ASSERT_EQ(certificate, DistanceProof::kColliding) << what;
  }
  tally.add(certificate);
  TrianglePair nowhere;
  const Proof ahead = prove(a, b, d, 0.01, nowhere);
  ASSERT_EQ(ahead.proved, certificate) << what;
  ASSERT_LE(ahead.bound, clearance + kTau) << what;
}

class MeshLanes : public ::testing::TestWithParam<int> {};

TEST_P(MeshLanes, MeshesAgainstFclDistances) {
  const std::uint64_t base = test::seed("CertificatesOfMeshes");
  Random random(base * 64 + static_cast<std::uint64_t>(GetParam()));
  const auto pool = meshes();
  MeshStore store;
  PairTest fcl, near_parts(PairTest::Meshes::kNear);
  Verdicts round, solid, mesh, touching;
  int triangles = 0;
  const int count = test::trials(5000);
  for (int k = 0; k < count; ++k) {
    const RandomPair pair = random_pair(random, pool, store);
    const double clearance = fcl.clearance(pair.a(), pair.b());
    const std::string where =
        "SWIVEL_TEST_SEED=" + std::to_string(base) + " case " + std::to_string(k);
    check_near_parts(near_parts, pair, clearance, where);
    if (HasFatalFailure()) return;
    if (are_triangles(pair.a(), pair.b())) {
      check_triangle_distance(pair, clearance, random, where);
      if (HasFatalFailure()) return;
      ++triangles;
    }
    Verdicts& tally = clearance == 0   ? touching
                      : pair.kind <= 2 ? round
                      : pair.kind <= 4 ? solid
                                       : mesh;
    for (const double d :
         {0.0, 0.005, clearance - 3 * kTau, clearance - 1.1 * kTau, clearance + 1.1 * kTau,
          clearance + 3 * kTau, clearance + random.uniform(-0.02, 0.02)}) {
      if (d >= 0) check_proof(pair, clearance, d, where, tally);
      if (HasFatalFailure()) return;
    }
  }
  for (const auto& [name, tally] :
       {std::pair("apart: sphere or capsule", round), std::pair("apart: box or cylinder", solid),
        std::pair("apart: mesh", mesh), std::pair("touching or contained", touching)}) {
    std::printf("%s: %d certified free, %d certified colliding, %d undecided\n", name, tally.free,
                tally.colliding, tally.none);
    EXPECT_GT(tally.all(), count / 4) << name;
    EXPECT_GT(tally.colliding, tally.all() / 10) << name;
  }
  EXPECT_EQ(touching.free, 0);
  EXPECT_GT(triangles, count / 8);
  EXPECT_GT(round.free, round.all() / 4);
  EXPECT_EQ(fcl.counters().fcl_failures, 0);
  std::printf("%d pairs of bodies, %lld FCL calls\n", count,
              static_cast<long long>(fcl.counters().fcl_calls));
}
INSTANTIATE_TEST_SUITE_P(Four, MeshLanes, ::testing::Range(0, 4));

/// A proof begins where the last one of the same bodies ended. That must not change what it says.
TEST(DistanceProofs, DoNotDependOnWhereTheLastOneEnded) {
  const std::uint64_t base = test::seed("Witnesses");
  Random random(base);
  const auto pool = meshes();
  const int count = test::trials(400), steps = 25;
  Verdicts all;
  MeshStore store;
  for (int k = 0; k < count; ++k) {
    const FclShape mesh = make_fcl_shape(pool[random.below(static_cast<int>(pool.size()))], store);
    Shape other = pool[random.below(static_cast<int>(pool.size()))];
    if (const int kind = random.below(5); kind == 0)
      other = Capsule{0.03, 0.2};
    else if (kind <= 2)
      other = Box{random_size(random, 0.02, 0.3)};
    else if (kind == 3)
      other = Cylinder{random.uniform(0.01, 0.1), random.uniform(0.02, 0.3)};
    const FclShape moving = make_fcl_shape(other, store);
    const Pose at_rest = Pose::Identity();
    Pose pose = random_pose(random, 0.4);
    const bool swapped = random.coin();
    TrianglePair kept;
    for (int step = 0; step < steps; ++step) {
      const PlacedShapeRef a =
          swapped ? PlacedShapeRef{&moving, &pose} : PlacedShapeRef{&mesh, &at_rest};
      const PlacedShapeRef b =
          swapped ? PlacedShapeRef{&mesh, &at_rest} : PlacedShapeRef{&moving, &pose};
      const double d = random.coin(0.2) ? 0 : random.uniform(0, 0.03),
                   ahead = random.coin() ? 0 : 0.01;
      TrianglePair nowhere;
      const Proof fresh = prove(a, b, d, ahead, nowhere), proof = prove(a, b, d, ahead, kept);
      ASSERT_EQ(proof.proved, fresh.proved)
          << "SWIVEL_TEST_SEED=" << base << " case " << k << " step " << step << " d " << d;
      if (fresh.proved == DistanceProof::kFree) {
        ASSERT_NEAR(proof.bound, fresh.bound, 1e-12);
      }
      all.add(proof.proved);
      pose.translation() += 0.02 * random_size(random, -1, 1);
      pose.linear() = (Quaterniond(pose.linear()) *
                       Quaterniond(1, random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05), 0))
                          .normalized()
                          .toRotationMatrix();
    }
  }
  std::printf("%d questions: %d certified free, %d certified colliding, %d undecided\n", all.all(),
              all.free, all.colliding, all.none);
  EXPECT_GT(all.free, all.all() / 4);
  EXPECT_GT(all.colliding, all.all() / 4);
}

TEST(DistanceProofs, ABodyInsideAClosedMeshCollidesAtAnyDistance) {
  MeshStore store;
  const Pose origin = Pose::Identity();
  for (const bool closed : {true, false}) {
    TriangleMesh crate = testing::box_mesh(Vector3d(1, 1, 1), 1);
    if (!closed) crate.triangles.pop_back();
    const FclShape outer = make_fcl_shape(testing::as_mesh(crate, "crate"), store);
    for (const Shape& shape : std::vector<Shape>{
             Sphere{0.1}, Capsule{0.05, 0.2}, Box{Vector3d(0.1, 0.2, 0.1)}, Cylinder{0.1, 0.1},
             testing::as_mesh(testing::sphere_mesh(0.1, 4), "ball")}) {
      const FclShape inner = make_fcl_shape(shape, store);
      const DistanceProof expected = closed ? DistanceProof::kColliding : DistanceProof::kFree;
      EXPECT_EQ(prove_distance({&outer, &origin}, {&inner, &origin}, 0.005), expected)
          << shape.index();
      EXPECT_EQ(prove_distance({&inner, &origin}, {&outer, &origin}, 0), expected) << shape.index();
    }
  }
  const FclShape speck =
      make_fcl_shape(testing::as_mesh(testing::sphere_mesh(0.01, 4), "speck"), store);
  for (const Shape& shape : std::vector<Shape>{Sphere{0.1}, Capsule{0.05, 0.2},
                                               Box{Vector3d(0.1, 0.2, 0.1)}, Cylinder{0.1, 0.1}}) {
    const FclShape outer = make_fcl_shape(shape, store);
    EXPECT_EQ(prove_distance({&speck, &origin}, {&outer, &origin}, 0), DistanceProof::kColliding)
        << shape.index();
  }
}

TEST(Segments, DegenerateCasesAreExact) {
  const auto squared = [](Vector3d p, Vector3d u, Vector3d q, Vector3d v) {
    return squared_distance(Segment{p, u}, Segment{q, v});
  };
  const Vector3d o = Vector3d::Zero(), x = Vector3d::UnitX(), y = Vector3d::UnitY(),
                 z = Vector3d::UnitZ();
  EXPECT_EQ(squared(o, o, 3 * x, o), 9);           // points
  EXPECT_EQ(squared(o, o, y - x, 2 * x), 1);       // a point over a segment
  EXPECT_EQ(squared(y - x, 2 * x, o, o), 1);       // and below
  EXPECT_EQ(squared(o, x, y + 0.5 * x, x), 1);     // parallel, side by side
  EXPECT_EQ(squared(o, x, 3 * x, x), 4);           // in line
  EXPECT_EQ(squared(o, x, 3 * x, -x), 1);          // in line, towards
  EXPECT_EQ(squared(o, x, 0.5 * x, x), 0);         // in line, over each other
  EXPECT_EQ(squared(-x, 2 * x, z - y, 2 * y), 1);  // crossing
  const Triangle t(o, 2 * x, 2 * y);
  const auto to_triangle = [&](Vector3d p, Vector3d u) {
    return squared_distance(Segment{p, u}, t, 1e9);
  };
  EXPECT_EQ(to_triangle(0.5 * x + 0.5 * y + z, o), 1);      // a point above
  EXPECT_EQ(to_triangle(0.5 * x + 0.5 * y, o), 0);          // a point on it
  EXPECT_EQ(to_triangle(-x - y + z, 4 * x + 4 * y), 1);     // parallel above, ends outside
  EXPECT_EQ(to_triangle(0.2 * x + 0.2 * y, 0.1 * x), 0);    // within it
  EXPECT_EQ(to_triangle(-3 * x, x), 4);                     // in its plane, outside
  EXPECT_EQ(to_triangle(-x + y, 4 * x), 0);                 // in its plane, across
  EXPECT_EQ(to_triangle(0.5 * x + 0.5 * y - z, 2 * z), 0);  // through it
  EXPECT_EQ(to_triangle(-x - z, 2 * z), 1);                 // through its plane, beside it
}

}  // namespace
}  // namespace swivel
