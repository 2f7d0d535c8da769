// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/fit/capsule_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "seed.hpp"
#include "support.hpp"

namespace swivel {
namespace {

using namespace testing;

/// m from the surface of a sphere or capsule; below 0 inside.
double outside(const PlacedShape& placed, const Vector3d& p) {
  const Vector3d local = placed.pose.inverse(Eigen::Isometry) * p;
  if (const auto* sphere = std::get_if<Sphere>(&placed.shape)) return local.norm() - sphere->radius;
  const auto& capsule = std::get<Capsule>(placed.shape);
  const double beyond = std::max(0.0, std::abs(local.z()) - capsule.length / 2);
  return std::hypot(local.x(), local.y(), beyond) - capsule.radius;
}

double outside(const CapsuleFit& fit, const Vector3d& p) {
  double least = 1e9;
  for (const PlacedShape& shape : fit.capsules) least = std::min(least, outside(shape, p));
  return least;
}

/// A closed mesh and points inside it.
struct Solid {
  const char* name;
  TriangleMesh mesh;
  std::function<Vector3d(Random&)> inside;
};

std::vector<Solid> solids() {
  const auto in_box = [](const Vector3d& size) {
    return [size](Random& random) {
      return Vector3d(size.x() * random.uniform(-0.5, 0.5), size.y() * random.uniform(-0.5, 0.5),
                      size.z() * random.uniform(-0.5, 0.5));
    };
  };
  const Vector3d shaft(0.1, 0.1, 0.6), foot(0.5, 0.12, 0.1), plate(0.4, 0.3, 0.02);
  const Vector3d to_foot(0.2, 0, -0.3);  // an L
  TriangleMesh elbow = box_mesh(foot, 4);
  for (Vector3d& vertex : elbow.vertices) vertex += to_foot;
  return {{"box", box_mesh(shaft, 5), in_box(shaft)},
          {"plate", box_mesh(plate, 3), in_box(plate)},
          {"L", joined(box_mesh(shaft, 3), elbow),
           [=](Random& random) {
             return random.index(2) == 0 ? in_box(shaft)(random)
                                         : Vector3d(in_box(foot)(random) + to_foot);
           }},
          {"ring", torus_mesh(0.2, 0.03, 24),
           [](Random& random) {
             // A little less than the tube, whose mesh is a polygon within it.
             const double around = random.uniform(-kPi, kPi), turn = random.uniform(-kPi, kPi),
                          off = 0.028 * random.uniform(0, 1);
             const double ring = 0.2 * std::cos(kPi / 24) + off * std::cos(turn);
             return Vector3d(ring * std::cos(around), ring * std::sin(around),
                             off * std::sin(turn));
           }},
          {"ball", sphere_mesh(0.1, 12), [](Random& random) {
             Vector3d u;
             do u = random.vector(-1, 1);
             while (u.norm() > 0.95);
             return Vector3d(0.095 * u);
           }}};
}

TEST(CapsuleFit, ContainsSurfaceAndInsideOfWhatItReplaces) {
  Random random(83);
  int points = 0;
  for (const Solid& solid : solids()) {
    double before = 1e9;
    for (const int most : {1, 2, 4, 8}) {
      // Anywhere in space.
      const Pose pose = random.pose(1);
      TriangleMesh mesh = solid.mesh;
      move(mesh, pose);
      const CapsuleFit fit = fit_capsules(mesh, most), again = fit_capsules(mesh, most);
      ASSERT_GE(fit.capsules.size(), 1u);
      ASSERT_LE(fit.capsules.size(), static_cast<std::size_t>(most));
      ASSERT_EQ(fit.capsules.size(), again.capsules.size());
      for (std::size_t k = 0; k < fit.capsules.size(); ++k) {
        EXPECT_EQ(fit.capsules[k].pose.matrix(), again.capsules[k].pose.matrix());
        // Ends and radius are numbers of six digits after the point.
        const auto* capsule = std::get_if<Capsule>(&fit.capsules[k].shape);
        const double radius =
            capsule ? capsule->radius : std::get<Sphere>(fit.capsules[k].shape).radius;
        EXPECT_NEAR(1e6 * radius, std::round(1e6 * radius), 1e-6);
        const Vector3d end =
            fit.capsules[k].pose * Vector3d(0, 0, capsule ? capsule->length / 2 : 0);
        for (const double value : end) EXPECT_NEAR(1e6 * value, std::round(1e6 * value), 1e-6);
      }
      double worst = -1e9;
      for (const auto& triangle : mesh.triangles)
        for (int k = 0; k < 4; ++k) {
          const double u = random.uniform(0, 1), v = random.uniform(0, 1 - u);
          const auto corner = [&](std::size_t n) {
            return mesh.vertices[static_cast<std::size_t>(triangle[n])];
          };
          worst = std::max(worst, outside(fit, corner(0) + u * (corner(1) - corner(0)) +
                                                   v * (corner(2) - corner(0))));
          ++points;
        }
      for (const Vector3d& vertex : mesh.vertices) worst = std::max(worst, outside(fit, vertex));
      for (int k = 0; k < test::trials(2000); ++k, ++points)
        worst = std::max(worst, outside(fit, pose * solid.inside(random)));
      EXPECT_LE(worst, 1e-12) << solid.name << ", at most " << most;
      EXPECT_LE(fit.volume, 1.1 * before)
          << solid.name;  // cuts are sought in few directions, so a pose counts for something
      before = fit.volume;
      std::printf("  %s: %zu of %d, %.3f l, up to %.1f mm further\n", solid.name,
                  fit.capsules.size(), most, 1e3 * fit.volume, 1e3 * fit.excess);
    }
  }
  std::printf("  %d points\n", points);
  EXPECT_GE(points, test::at_least(40000));
}

/// Shapes of which the best is known.
TEST(CapsuleFit, FindsTheLeastWhereItIsKnown) {
  const CapsuleFit ball = fit_capsules(sphere_mesh(0.1, 24), 3);
  ASSERT_EQ(ball.capsules.size(), 1u);
  EXPECT_LE(ball.volume, 1.02 * 4 / 3 * kPi * 1e-3);
  EXPECT_LE(ball.excess, 2e-3);
  // A capsule: half a ball at either end of a tube.
  TriangleMesh mesh = sphere_mesh(0.05, 32);
  for (Vector3d& vertex : mesh.vertices)
    vertex.z() += vertex.z() > 1e-9 ? 0.15 : vertex.z() < -1e-9 ? -0.15 : 0;
  const Eigen::AngleAxisd turn(1.1, Vector3d(1, 2, 3).normalized());
  for (Vector3d& vertex : mesh.vertices) vertex = turn * vertex;
  const CapsuleFit fit = fit_capsules(mesh, 1);
  const auto& capsule = std::get<Capsule>(fit.capsules.at(0).shape);
  EXPECT_NEAR(capsule.radius, 0.05, 1e-3);
  EXPECT_NEAR(capsule.length, 0.3, 0.01);
  EXPECT_LE(fit.volume, 1.01 * kPi * 0.05 * 0.05 * (0.3 + 4.0 / 3 * 0.05));
  EXPECT_GT(std::abs((fit.capsules[0].pose.linear().col(2)).dot(turn * Vector3d::UnitZ())), 0.9999);
  // An L needs two.
  EXPECT_EQ(fit_capsules(solids()[2].mesh, 2).capsules.size(), 2u);
  EXPECT_LE(fit_capsules(solids()[2].mesh, 2).volume,
            0.5 * fit_capsules(solids()[2].mesh, 1).volume);
}

}  // namespace
}  // namespace swivel
