// SPDX-License-Identifier: BSD-3-Clause
// How deep bodies are in each other: between what plain samples find and what a translation that
// takes them apart needs.
#include "exact/depth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "exact/pair_test.hpp"
#include "seed.hpp"
#include "support.hpp"

namespace swivel::detail {
namespace {

using testing::as_mesh;
using testing::box_mesh;
using testing::Random;

struct Body {
  Shape shape;
  Pose pose;
};
struct Placed {
  Placed(const Body& body, MeshStore& store)
      : shape(make_fcl_shape(body.shape, store)), pose(body.pose) {}
  [[nodiscard]] PlacedShapeRef ref() const { return {&shape, &pose}; }
  FclShape shape;
  Pose pose;
};
Depth depth_of(const Body& a, const Body& b) {
  MeshStore store;
  const Placed at_a(a, store), at_b(b, store);
  return depth(at_a.ref(), at_b.ref());
}

Body random_body(int kind, Random& random, double range) {
  const double r = random.uniform(0.01, 0.05), length = random.uniform(0.01, 0.15);
  const Vector3d size(random.uniform(0.01, 0.2), random.uniform(0.01, 0.2),
                      random.uniform(0.01, 0.2));
  const Pose pose = random.pose(range);
  if (kind == 0) return {Sphere{r}, pose};
  if (kind == 1) return {Capsule{r, length}, pose};
  if (kind == 2) return {Box{size}, pose};
  if (kind == 3) return {Cylinder{r, length}, pose};
  return {as_mesh(box_mesh(size, 3), "box.stl"), pose};
}

/// Returns by the definition how deep beneath the surface a point of the base frame lies, less than
/// 0 outside. A mesh counts as its box.
double beneath(const Body& body, const Vector3d& point) {
  const Vector3d p = body.pose.inverse() * point;
  const double r = std::hypot(p.x(), p.y());
  if (const auto* s = std::get_if<Sphere>(&body.shape)) return s->radius - p.norm();
  if (const auto* c = std::get_if<Capsule>(&body.shape))
    return c->radius - std::hypot(r, std::max(0.0, std::abs(p.z()) - c->length / 2));
  const auto convex = [](std::initializer_list<double> out) {
    double outside = 0;
    for (const double x : out) outside = std::hypot(outside, std::max(0.0, x));
    return outside > 0 ? -outside : -std::max(out);
  };
  if (const auto* c = std::get_if<Cylinder>(&body.shape))
    return convex({r - c->radius, std::abs(p.z()) - c->length / 2});
  Vector3d half = Vector3d::Zero();
  if (const auto* mesh = std::get_if<MeshPtr>(&body.shape))
    for (const Vector3d& v : (*mesh)->vertices) half = half.cwiseMax(v);
  else
    half = std::get<Box>(body.shape).size / 2;
  return convex(
      {std::abs(p.x()) - half.x(), std::abs(p.y()) - half.y(), std::abs(p.z()) - half.z()});
}

/// Returns how far the body reaches along a direction of the base frame.
double reach(const Body& body, const Vector3d& way) {
  const Vector3d to = body.pose.linear().transpose() * way;
  const double at = way.dot(body.pose.translation()), aside = std::hypot(to.x(), to.y());
  if (const auto* s = std::get_if<Sphere>(&body.shape)) return at + s->radius;
  if (const auto* c = std::get_if<Capsule>(&body.shape))
    return at + c->radius + std::abs(to.z()) * c->length / 2;
  if (const auto* c = std::get_if<Cylinder>(&body.shape))
    return at + c->radius * aside + std::abs(to.z()) * c->length / 2;
  if (const auto* b = std::get_if<Box>(&body.shape)) return at + to.cwiseAbs().dot(b->size) / 2;
  double most = -1e9;
  for (const Vector3d& v : std::get<MeshPtr>(body.shape)->vertices)
    most = std::max(most, v.dot(to));
  return at + most;
}

TEST(Depth, LiesBetweenASampledPointAndATranslationThatTakesTheBodiesApart) {
  Random random(41);
  int deep = 0, apart = 0, tight = 0;
  for (int trial = 0; trial < test::trials(400); ++trial) {
    int kind_a = random.index(5), kind_b = random.index(5);
    if (kind_a == 4 && kind_b == 4) kind_b = 3;
    const Body a = random_body(kind_a, random, 0.04), b = random_body(kind_b, random, 0.04);
    const Depth found = depth_of(a, b);
    SCOPED_TRACE(trial);
    double sampled = -1e9;  // of points about both bodies, then about the best of them
    Vector3d best = Vector3d::Zero();
    for (int k = 0; k < 4000; ++k) {
      const Vector3d p =
          k < 2000 ? random.vector(-0.1, 0.1)
                   : Vector3d(best + random.vector(-1, 1) * 0.05 * std::pow(0.998, k - 2000));
      if (const double sum = beneath(a, p) + beneath(b, p); sum > sampled) sampled = sum, best = p;
    }
    double least = 1e9;  // to move b along some way until a plane parts them
    for (int k = 0; k < 2000; ++k) {
      Vector3d way = random.vector(-1, 1).normalized();
      if (k < 6) way = a.pose.linear().col(k % 3) * (k < 3 ? 1 : -1);
      if (k >= 6 && k < 12) way = b.pose.linear().col(k % 3) * (k < 9 ? 1 : -1);
      least = std::min(least, reach(a, way) + reach(b, -way));
    }
    const double radius = 0.05 * 0.005;  // of a cylinder, by which its circles may be polygons
    EXPECT_LE(sampled, found.at_most + 1e-9);
    EXPECT_LE(found.at_least, least + 1e-9);
    EXPECT_LE(found.at_most - found.at_least,
              0.02e-3 + 2 * (kind_a == 3 || kind_b == 3 ? radius : 0));
    EXPECT_LE(found.at_least, found.at_most);
    deep += found.at_least > 0.001;
    apart += found.at_most < -0.001;
    tight += found.at_most - sampled < 0.5e-3;
  }
  EXPECT_GE(deep, test::at_least(100));
  EXPECT_GE(apart, test::at_least(20));
  EXPECT_GE(tight, test::at_least(200));
}

TEST(Depth, OfBodiesThatAreApartIsMinusTheirClearance) {
  Random random(42);
  int compared = 0;
  for (int trial = 0; trial < test::trials(200); ++trial) {
    const Body a = random_body(random.index(4), random, 0.15),
               b = random_body(random.index(5), random, 0.15);
    MeshStore store;
    const Placed at_a(a, store), at_b(b, store);
    const double clearance = PairTest().clearance(at_a.ref(), at_b.ref());
    const Depth found = depth(at_a.ref(), at_b.ref());
    if (clearance > 0) {
      EXPECT_NEAR(-found.at_most, clearance, 0.5e-3) << trial;
      ++compared;
    } else {
      EXPECT_GE(found.at_most, -1e-9) << trial;
    }
  }
  EXPECT_GE(compared, test::at_least(50));
}

TEST(Depth, ChangesByNoMoreThanTheBodiesMove) {
  Random random(43);
  for (int trial = 0; trial < test::trials(200); ++trial) {
    const int kind_a = random.index(5), kind_b = kind_a == 4 ? random.index(4) : random.index(5);
    const Body a = random_body(kind_a, random, 0.04), b = random_body(kind_b, random, 0.04);
    Body moved = b;
    const Vector3d by = random.vector(-0.002, 0.002);
    moved.pose.translation() += by;
    const Depth before = depth_of(a, b), after = depth_of(a, moved);
    EXPECT_LE(after.at_least, before.at_most + by.norm() + 1e-9) << trial;
    EXPECT_GE(after.at_most, before.at_least - by.norm() - 1e-9) << trial;
    // The body as a whole contains what it is shrunk to.
    if (const auto* box = std::get_if<Box>(&a.shape)) {
      const Depth smaller = depth_of({Box{0.9 * box->size}, a.pose}, b);
      EXPECT_LE(smaller.at_least, before.at_most + 1e-9) << trial;
    }
  }
}

TEST(Depth, OfATipInAPanelIsHowFarItIsBeneathTheSurface) {
  const Body panel{Box{{0.4, 0.4, 0.06}}, Pose::Identity()};
  const Body panel_mesh{as_mesh(box_mesh({0.4, 0.4, 0.06}, 8), "panel.stl"), Pose::Identity()};
  Pose above = Pose::Identity();
  for (const double deep : {0.001, 0.003, 0.01, 0.02}) {
    for (const Body& into : {panel, panel_mesh}) {
      const auto expect = [&](const Shape& shape, double tip) {
        above.translation().z() = 0.03 + tip - deep;
        const Depth found = depth_of({shape, above}, into);
        EXPECT_NEAR(found.at_least, deep, 0.03e-3);
        EXPECT_NEAR(found.at_most, deep, 0.03e-3);
      };
      expect(Sphere{0.02}, 0.02);
      expect(Capsule{0.004, 0.1}, 0.054);
      expect(Cylinder{0.004, 0.1}, 0.05);
      expect(Box{{0.01, 0.008, 0.1}}, 0.05);
    }
  }
}

/// Returns a closed block, 0.2 m wide and 0.1 m high below z = 0, whose upper side is a grid of
/// bumps and hollows of up to `rough`, m.
TriangleMesh bumpy_block(Random& random, double rough) {
  constexpr int kCells = 8;
  TriangleMesh mesh;
  const auto at = [](int i, int j, int side) { return 2 * (i * (kCells + 1) + j) + side; };
  for (int i = 0; i <= kCells; ++i)
    for (int j = 0; j <= kCells; ++j) {
      const double x = 0.2 * i / kCells - 0.1, y = 0.2 * j / kCells - 0.1;
      mesh.vertices.emplace_back(x, y, random.uniform(-rough, rough));
      mesh.vertices.emplace_back(x, y, -0.1);
    }
  const auto quad = [&](int a, int b, int c, int d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      quad(at(i, j, 0), at(i + 1, j, 0), at(i + 1, j + 1, 0), at(i, j + 1, 0));
      quad(at(i, j, 1), at(i, j + 1, 1), at(i + 1, j + 1, 1), at(i + 1, j, 1));
    }
  for (int i = 0; i < kCells; ++i) {
    quad(at(i, 0, 1), at(i + 1, 0, 1), at(i + 1, 0, 0), at(i, 0, 0));
    quad(at(i, kCells, 0), at(i + 1, kCells, 0), at(i + 1, kCells, 1), at(i, kCells, 1));
    quad(at(0, i, 0), at(0, i + 1, 0), at(0, i + 1, 1), at(0, i, 1));
    quad(at(kCells, i, 1), at(kCells, i + 1, 1), at(kCells, i + 1, 0), at(kCells, i, 0));
  }
  return mesh;
}

/// Returns a pad that lies flat or tilted on a block, up to 8 mm deep.
Body pad_on(const Body& block, Random& random) {
  Body pad = random_body(1 + random.index(3), random, 0);
  pad.pose = Pose::Identity();
  if (random.index(2))
    pad.pose.linear() = Eigen::AngleAxisd(random.uniform(0, 0.2), random.vector(-1, 1).normalized())
                            .toRotationMatrix();
  const double lowest = reach(pad, -Vector3d::UnitZ());
  pad.pose.translation() += Vector3d(random.uniform(-0.08, 0.08), random.uniform(-0.08, 0.08),
                                     lowest - random.uniform(-0.002, 0.008));
  pad.pose = block.pose * pad.pose;
  return pad;
}

/// Returns the greatest sum of depths found at points of the block's upper side and at points about
/// the best of them, m. How deep a point lies in the block is told by its tree of triangles.
double deepest_sample(const Body& pad, const PlacedShapeRef& block, Random& random) {
  const MeshModel& mesh = *block.shape->mesh;
  const Pose back = block.pose->inverse();
  const auto in_block = [&](const Vector3d& point) {
    const Vector3d p = back * point;
    int first = 0;
    const double far = mesh.triangles().distance({p, Vector3d::Zero()}, 0, 1e3, first);
    return mesh.solid().contains(p) ? far : -far;
  };
  double sampled = -1e9;
  Vector3d best = Vector3d::Zero();
  for (int k = 0; k < 6000; ++k) {
    const Vector3d p =
        k < 3000
            ? Vector3d(*block.pose * Vector3d(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1),
                                              random.uniform(-0.01, 0.01)))
            : Vector3d(best + random.vector(-1, 1) * 0.02 * std::pow(0.997, k - 3000));
    if (const double sum = beneath(pad, p) + in_block(p); sum > sampled) sampled = sum, best = p;
  }
  return sampled;
}

/// The depth of pads in blocks with bumps and hollows is that of the deepest of many points; a
/// question about one depth has the answer that the bounds give; a pad that is a mesh of a box has
/// the box's bounds.
TEST(Depth, OfAPadOnARoughSurfaceIsThatOfTheDeepestPoint) {
  Random random(44);
  int deep = 0, tight = 0, kept = 0, meshes = 0;
  for (int trial = 0; trial < test::trials(120); ++trial) {
    SCOPED_TRACE(trial);
    const Body block{as_mesh(bumpy_block(random, random.uniform(0, 0.004)), "block.stl"),
                     random.pose(0.5)};
    const Body pad = pad_on(block, random);
    MeshStore store;
    const Placed at_pad(pad, store), at_block(block, store);
    const Depth found = depth(at_pad.ref(), at_block.ref());
    const double sampled = deepest_sample(pad, at_block.ref(), random);
    const auto* cylinder = std::get_if<Cylinder>(&pad.shape);
    EXPECT_LE(sampled, found.at_most + 1e-9);
    EXPECT_LE(found.at_most - found.at_least, 0.02e-3 + (cylinder ? 0.005 * cylinder->radius : 0));
    deep += sampled > 0.001;
    tight += sampled > found.at_least - 0.2e-3;

    const double asked = found.at_most + random.uniform(-0.004, 0.004);
    const Depth answer = depth(at_pad.ref(), at_block.ref(), asked, asked + 0.1e-3);
    EXPECT_GE(answer.at_most, found.at_least - 1e-9);
    EXPECT_LE(answer.at_least, found.at_most + 1e-9);
    if (found.at_most <= asked) {
      EXPECT_LE(answer.at_most, asked + 1e-12);
      ++kept;
    } else if (found.at_least > asked + 0.2e-3) {
      EXPECT_GT(answer.at_least, asked);
    }
    if (const auto* box = std::get_if<Box>(&pad.shape); box && box->size.norm() < 0.29) {
      const Placed as_triangles({as_mesh(box_mesh(box->size, 3), "box.stl"), pad.pose}, store);
      const Depth of_meshes = depth(as_triangles.ref(), at_block.ref());
      EXPECT_NEAR(of_meshes.at_most, found.at_most, 0.03e-3);
      EXPECT_LE(of_meshes.at_least, found.at_most + 1e-9);
      ++meshes;
    }
  }
  std::printf("%d deep, %d tight, %d no deeper than asked, %d of meshes\n", deep, tight, kept,
              meshes);
  EXPECT_GE(deep, test::at_least(40));
  EXPECT_GE(tight, test::at_least(60));
  EXPECT_GE(kept, test::at_least(30));
  EXPECT_GE(meshes, test::at_least(15));
}

TEST(Depth, IsNotKnownWhereAMeshIsOpenAndBoundedBetweenClosedMeshes) {
  const Body open{as_mesh(testing::tube_mesh(0.05, 0.1, 12), "tube.stl"), Pose::Identity()};
  const Body closed{as_mesh(box_mesh({0.1, 0.1, 0.1}, 2), "box.stl"), Pose::Identity()};
  Body beside = closed;
  beside.pose.translation().x() = 0.09;
  beside.pose.linear() = Eigen::AngleAxisd(0.1, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Depth unknown = depth_of({Sphere{0.06}, Pose::Identity()}, open),
              meshes = depth_of(closed, beside);
  EXPECT_EQ(unknown.at_most, std::numeric_limits<double>::infinity());
  EXPECT_EQ(unknown.at_least, -std::numeric_limits<double>::infinity());
  EXPECT_GT(meshes.at_least, 0.005);
  EXPECT_GE(meshes.at_most, meshes.at_least);
  EXPECT_LE(meshes.at_most, 0.02);
}

}  // namespace
}  // namespace swivel::detail
