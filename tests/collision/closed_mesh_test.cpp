// SPDX-License-Identifier: BSD-3-Clause
// Points in closed meshes: parity on the grid against solid angles.
#include "shapes/closed_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "reference.hpp"
#include "seed.hpp"
#include "support.hpp"
#include "swivel/core/problem/shape.hpp"

namespace swivel {
namespace {

using namespace detail;
using namespace swivel::testing;

std::vector<TriangleMesh> closed_meshes() {
  TriangleMesh far_box = box_mesh(Vector3d(0.1, 0.2, 0.05), 1);
  Pose away = Pose::Identity();
  away.translation() = Vector3d(0.4, 0.1, 0);
  move(far_box, away);
  return {box_mesh(Vector3d(0.3, 0.2, 0.1), 1),
          box_mesh(Vector3d(0.3, 0.3, 0.3), 4),
          sphere_mesh(0.2, 8),
          torus_mesh(0.2, 0.07, 12),
          panel_mesh(0.5, 0.4, 0.04, 6),
          joined(sphere_mesh(0.2, 6), far_box)};
}

TEST(ClosedMesh, AgreesWithTheWindingNumber) {
  Random random(11);
  int inside = 0, outside = 0;
  for (TriangleMesh mesh : closed_meshes())
    for (int turn = 0; turn < 6; ++turn) {
      if (turn > 0) move(mesh, random.pose(0.1));
      ASSERT_TRUE(is_closed(mesh));
      const ClosedMesh solid(mesh);
      Eigen::AlignedBox3d box;
      for (const Vector3d& v : mesh.vertices) box.extend(v);
      for (int k = 0; k < test::trials(400); ++k) {
        const Vector3d p = box.min() + box.sizes().cwiseProduct(random.vector(-0.05, 1.05));
        const double winding = winding_number(mesh, p);
        ASSERT_NEAR(winding, std::round(winding), 1e-3);
        ASSERT_EQ(solid.contains(p), winding > 0.5) << p.transpose();
        ++(winding > 0.5 ? inside : outside);
      }
    }
  EXPECT_GE(inside, test::at_least(2001));
  EXPECT_GE(outside, test::at_least(2001));
}

TEST(ClosedMesh, RaysThroughCornersAndEdgesCountOnce) {
  // Grid points of an unturned box mesh: every ray along an axis meets vertices, edges or
  // diagonals.
  const TriangleMesh mesh = box_mesh(Vector3d(0.4, 0.4, 0.2), 4);
  const ClosedMesh solid(mesh);
  int checks = 0;
  for (int x = -3; x <= 3; ++x)
    for (int y = -3; y <= 3; ++y)
      for (const double z : {-0.15, -0.09, 0.0, 0.03, 0.09, 0.15}) {
        const Vector3d p(0.1 * x, 0.1 * y, z);
        if (std::abs(x) == 2 || std::abs(y) == 2) continue;  // on the surface: undefined
        EXPECT_EQ(solid.contains(p), std::abs(x) < 2 && std::abs(y) < 2 && std::abs(z) < 0.1)
            << p.transpose();
        ++checks;
      }
  EXPECT_EQ(checks, 150);
}

TEST(ClosedMesh, EdgesAndPositionsAreCountedAsByHand) {
  Random random(12);
  int closed = 0, open = 0;
  for (int trial = 0; trial < test::trials(4000); ++trial) {
    // A closed surface of few corners, every corner stored anew, as STL does; often a triangle is
    // missing, doubled or turned.
    TriangleMesh mesh = box_mesh(Vector3d(1, 1, 1), 1 + random.index(2));
    TriangleMesh soup;
    for (const auto& t : mesh.triangles) {
      const int at = static_cast<int>(soup.vertices.size());
      for (const int v : t) {
        soup.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
        for (double& x : soup.vertices.back())
          if (x == 0 && random.index(2) == 0) x = -0.0;
      }
      soup.triangles.push_back({at, at + 1, at + 2});
    }
    for (int change = random.index(3); change > 0; --change) {
      const auto which =
          static_cast<std::size_t>(random.index(static_cast<int>(soup.triangles.size())));
      auto& t = soup.triangles[which];
      switch (random.index(3)) {
        case 0:
          soup.triangles.erase(soup.triangles.begin() + static_cast<std::ptrdiff_t>(which));
          break;
        case 1:
          soup.triangles.push_back(t);
          break;
        default:
          std::swap(t[0], t[1]);
      }
    }
    const std::vector<int> number = vertex_numbers(soup);
    int known = 0;
    for (std::size_t k = 0; k < number.size(); ++k) {
      const auto same = std::find(soup.vertices.begin(), soup.vertices.end(), soup.vertices[k]) -
                        soup.vertices.begin();
      ASSERT_EQ(number[k], static_cast<std::size_t>(same) < k
                               ? number[static_cast<std::size_t>(same)]
                               : known++)
          << trial;
    }
    std::map<std::pair<int, int>, int> walked;
    for (const auto& t : soup.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        ++walked[{number[static_cast<std::size_t>(t[k])],
                  number[static_cast<std::size_t>(t[(k + 1) % 3])]}];
    const bool by_hand =
        !walked.empty() && std::all_of(walked.begin(), walked.end(), [&](const auto& edge) {
          const auto back = walked.find({edge.first.second, edge.first.first});
          return edge.second == 1 && back != walked.end() && back->second == 1;
        });
    ASSERT_EQ(is_closed(soup), by_hand) << trial;
    ++(by_hand ? closed : open);
  }
  EXPECT_GE(closed, test::at_least(1001));
  EXPECT_GE(open, test::at_least(1001));
}

TEST(ClosedMesh, OnePointPerPart) {
  EXPECT_EQ(one_point_per_part(sphere_mesh(0.1, 6)).size(), 1u);
  TriangleMesh away = box_mesh(Vector3d(0.1, 0.1, 0.1), 2);
  Pose X = Pose::Identity();
  X.translation().x() = 1;
  move(away, X);
  const auto points = one_point_per_part(joined(sphere_mesh(0.1, 6), away));
  ASSERT_EQ(points.size(), 2u);
  EXPECT_GT(std::abs(points[0].x() - points[1].x()), 0.8);
}

}  // namespace
}  // namespace swivel
