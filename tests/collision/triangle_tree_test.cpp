// SPDX-License-Identifier: BSD-3-Clause
// Distances of trees of triangles against all pairs of triangles, one by one.
#include "shapes/triangle_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "seed.hpp"
#include "support.hpp"

namespace swivel {
namespace {

using namespace detail;
using namespace swivel::testing;

std::vector<Triangle> triangles_of(const TriangleMesh& mesh) {
  std::vector<Triangle> triangles;
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t k) {
      return mesh.vertices[static_cast<std::size_t>(t[k])];
    };
    if ((corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() > 1e-12)
      triangles.emplace_back(corner(0), corner(1), corner(2));
  }
  return triangles;
}

/// Every edge of each against the other.
double plain_distance(const Triangle& s, const Triangle& t) {
  constexpr double kFar = std::numeric_limits<double>::max();
  double least = kFar;
  for (int k = 0; k < 3; ++k)
    least = std::min(
        {least, squared_distance(s.edge(k), t, kFar), squared_distance(t.edge(k), s, kFar)});
  return std::sqrt(least);
}

/// Two surfaces, the second in the frame of the first: shells a little apart, as links are, or
/// bodies anywhere.
struct Pair {
  TriangleMesh a, b;
  Pose b_in_a = Pose::Identity();
};
Pair random_pair(Random& random) {
  Pair pair;
  const double gap = random.uniform(1e-4, 5e-3);
  switch (random.index(4)) {
    case 0:
      pair = {tube_mesh(0.05, 0.1, 12), tube_mesh(0.05 + gap, 0.1, 12), Pose::Identity()};
      break;
    case 1:
      pair = {sphere_mesh(0.08, 9), sphere_mesh(0.08 + gap, 10), Pose::Identity()};
      break;
    case 2:
      pair = {panel_mesh(0.2, 0.15, 0.01, 5), panel_mesh(0.2, 0.15, 0.01, 4), Pose::Identity()};
      pair.b_in_a.translation().z() = 0.01 + gap;
      break;
    default:
      pair = {torus_mesh(0.08, 0.02, 8), box_mesh(Vector3d(0.1, 0.05, 0.02), 1 + random.index(2)),
              random.pose(0.15)};
  }
  // Each somewhere in its frame, sometimes far from its origin, which costs digits.
  const double away = random.index(3) == 0 ? 20 : 0.2;
  const Pose at_a = random.pose(away), at_b = random.pose(away);
  pair.b_in_a = at_a * (pair.b_in_a * at_b.inverse());
  move(pair.a, at_a);
  move(pair.b, at_b);
  return pair;
}

TEST(TriangleTree, DistancesAreThoseOfAllPairs) {
  Random random(83);
  int exact = 0, beyond = 0, enough = 0, pairs_near = 0;
  for (int trial = 0; trial < test::trials(120); ++trial) {
    const Pair pair = random_pair(random);
    const std::vector<Triangle> a = triangles_of(pair.a), b = triangles_of(pair.b);
    const TriangleTree tree(a), other(b);
    double least = std::numeric_limits<double>::infinity();
    std::vector<double> nearest_a(a.size(), least), nearest_b(b.size(), least);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Triangle moved = b[j].moved(pair.b_in_a);
      for (std::size_t k = 0; k < a.size(); ++k) {
        const double d = plain_distance(a[k], moved);
        least = std::min(least, d);
        nearest_a[k] = std::min(nearest_a[k], d);
        nearest_b[j] = std::min(nearest_b[j], d);
      }
    }
    constexpr double kRounding = 1e-9;
    TrianglePair first{random.index(static_cast<int>(a.size())),
                       random.index(static_cast<int>(b.size()))};
    for (const double limit : {1e6, least + 0.002, least + 1e-6, 0.9 * least}) {
      ASSERT_GE(tree.distance_at(other, pair.b_in_a, first), least - kRounding) << trial;
      const double found = tree.distance(other, pair.b_in_a, 0, limit, first);
      ASSERT_NEAR(found, std::min(least, limit), kRounding) << trial << " limit " << limit;
      ++(found < limit ? exact : beyond);
    }
    ASSERT_NEAR(tree.distance_at(other, pair.b_in_a, first), least, kRounding) << trial;
    const double soon = least + random.uniform(1e-6, 0.01);
    const double found = tree.distance(other, pair.b_in_a, soon, 1, first);
    ASSERT_GE(found, least - kRounding) << trial;
    ASSERT_LE(found, soon) << trial;
    ++enough;

    const double limit = least + random.uniform(0, 0.004);
    const auto near = tree.nearer(other, pair.b_in_a, limit);
    const auto check = [&](const std::vector<int>& listed, const std::vector<double>& distances) {
      const std::set<int> in(listed.begin(), listed.end());
      for (std::size_t k = 0; k < distances.size(); ++k)
        if (std::abs(distances[k] - limit) > kRounding) {
          ASSERT_EQ(in.count(static_cast<int>(k)) > 0, distances[k] < limit)
              << trial << " triangle " << k;
        }
      pairs_near += static_cast<int>(in.size());
    };
    check(near[0], nearest_a);
    check(near[1], nearest_b);
  }
  std::printf("%d distances, %d beyond their limit, %d that are near enough, %d triangles near\n",
              exact, beyond, enough, pairs_near);
  EXPECT_GE(exact, test::at_least(301));
  EXPECT_GE(beyond, test::at_least(101));
  EXPECT_GE(pairs_near, test::at_least(5001));
}

}  // namespace
}  // namespace swivel
