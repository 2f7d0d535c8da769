// SPDX-License-Identifier: BSD-3-Clause
// Meshes with fewer triangles for drawing, against the meshes that they stand for.
#include "page/thinned.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "seed.hpp"

namespace swivel::detail {
namespace {

using namespace test;

/// Returns a wavy sheet of 2 n^2 triangles in random pose and size, with vertices of their own or
/// shared ones.
MeshPtr sheet(Random& random, int n) {
  const auto mesh = std::make_shared<TriangleMesh>();
  const Vector3d size(random.uniform(0.01, 2), random.uniform(0.01, 2), random.uniform(0, 0.5)),
      at(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3));
  const bool shared = random.coin();
  const auto corner = [&](int i, int j) -> Vector3d {
    return at + Vector3d(size.x() * i / n, size.y() * j / n, size.z() * std::sin(7.0 * i * j / n));
  };
  const auto index = [&](int i, int j) {
    if (!shared || mesh->vertices.empty())
      for (int a = 0; shared && a <= n; ++a)
        for (int b = 0; b <= n; ++b) mesh->vertices.push_back(corner(a, b));
    if (shared) return i * (n + 1) + j;
    mesh->vertices.push_back(corner(i, j));
    return static_cast<int>(mesh->vertices.size()) - 1;
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      mesh->triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      mesh->triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  return mesh;
}

TEST(Thinned, StaysNearTheMesh) {
  Random random(seed("Thinned.StaysNearTheMesh"));
  int fewer = 0, same = 0;
  std::size_t kept = 0, asked = 0;
  const int kTrials = trials(60);
  for (int trial = 0; trial < kTrials; ++trial) {
    const MeshPtr mesh = sheet(random, 2 + random.below(40));
    const auto most = static_cast<std::size_t>(10 + random.below(3000));
    const MeshPtr thin = thinned(mesh, most);
    ASSERT_LE(thin->triangles.size(), most);
    if (mesh->triangles.size() <= most) {
      ASSERT_EQ(thin, mesh);
      ++same;
      continue;
    }
    ++fewer;
    kept += thin->triangles.size();
    asked += most;
    std::set<std::array<int, 3>> seen;
    for (const std::array<int, 3>& triangle : thin->triangles) {
      const auto [a, b, c] = triangle;
      ASSERT_TRUE(a != b && b != c && c != a);
      ASSERT_TRUE(seen.insert(triangle).second);
      for (const int k : triangle) ASSERT_LT(static_cast<std::size_t>(k), thin->vertices.size());
    }
    // Within the box of the mesh, and each corner of the mesh near one of the fewer.
    Vector3d low = mesh->vertices[0], high = low;
    for (const Vector3d& v : mesh->vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
    for (const Vector3d& v : thin->vertices)
      ASSERT_TRUE((v.array() >= low.array() - 1e-9).all() &&
                  (v.array() <= high.array() + 1e-9).all());
    const double cell = (high - low).maxCoeff() / (0.5 * std::sqrt(static_cast<double>(most)) - 1);
    for (std::size_t k = 0; most > 100 && k < mesh->vertices.size(); k += 7) {
      double nearest = 1e9;
      for (const Vector3d& v : thin->vertices)
        nearest = std::min(nearest, (v - mesh->vertices[k]).norm());
      ASSERT_LE(nearest, 4 * cell);
    }
  }
  EXPECT_GE(fewer, at_least(20));
  EXPECT_GE(same, at_least(10));
  EXPECT_GT(kept, asked / 4);
}

}  // namespace
}  // namespace swivel::detail
