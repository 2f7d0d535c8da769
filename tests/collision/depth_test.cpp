// SPDX-License-Identifier: BSD-3-Clause
// How deep bodies are in each other: between what plain samples find and what a translation that
// takes them apart needs.
#include "exact/depth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

TEST(Depth, IsNotKnownWhereAMeshIsOpenAndNotBoundedBetweenMeshes) {
  const Body open{as_mesh(testing::tube_mesh(0.05, 0.1, 12), "tube.stl"), Pose::Identity()};
  const Body closed{as_mesh(box_mesh({0.1, 0.1, 0.1}, 2), "box.stl"), Pose::Identity()};
  Body beside = closed;
  beside.pose.translation().x() = 0.09;
  beside.pose.linear() = Eigen::AngleAxisd(0.1, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Depth unknown = depth_of({Sphere{0.06}, Pose::Identity()}, open),
              meshes = depth_of(closed, beside);
  EXPECT_EQ(unknown.at_most, std::numeric_limits<double>::infinity());
  EXPECT_EQ(unknown.at_least, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(meshes.at_most, std::numeric_limits<double>::infinity());
  EXPECT_GT(meshes.at_least, 0.005);
}

}  // namespace
}  // namespace swivel::detail
