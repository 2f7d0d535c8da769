// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "swivel/core/problem/shape.hpp"

namespace swivel::detail {

/// A point, a segment or a triangle (1, 2 or 3 `corners`) of a body's medial set. `depth` is how
/// deep each corner lies beneath the body's surface, m, and is linear in between.
struct Patch {
  int corners = 0;
  std::array<Vector3d, 3> at{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  std::array<double, 3> depth{};

  void add(const Vector3d& corner, double beneath) {
    at[static_cast<std::size_t>(corners)] = corner;
    depth[static_cast<std::size_t>(corners++)] = beneath;
  }
  [[nodiscard]] double least_depth() const {
    return *std::min_element(depth.begin(), depth.begin() + corners);
  }
  /// Returns the two halves of the patch, which is divided across the edge along which the sum of
  /// its depth and of a function with this gradient changes most, or across the longest one where
  /// it changes little along all.
  [[nodiscard]] std::pair<Patch, Patch> halves(const Vector3d& slope) const {
    constexpr double kFlat = 0.03;
    const auto edge = [&](std::size_t k) {
      const std::size_t next = (k + 1) % 3;
      const Vector3d way = at[next] - at[k];
      return std::abs(depth[next] - depth[k] + slope.dot(way)) + kFlat * way.norm();
    };
    std::size_t from = 0;
    if (corners == 3)
      for (std::size_t k = 1; k < 3; ++k)
        if (edge(k) > edge(from)) from = k;
    const std::size_t to = corners == 3 ? (from + 1) % 3 : 1;
    std::pair<Patch, Patch> halves{*this, *this};
    halves.first.at[to] = halves.second.at[from] = (at[from] + at[to]) / 2;
    halves.first.depth[to] = halves.second.depth[from] = (depth[from] + depth[to]) / 2;
    return halves;
  }
};

/// The medial set of a body, in its own frame: the points that are locally deepest beneath its
/// surface. For every point in the body there is a point of this set at which the sum of the depths
/// in both bodies is at least as large.
struct Medial {
  std::vector<Patch> patches;
  double off = 0;  ///< no point of the set is further from the patches than this, m
};

/// Returns a triangular patch of these corners and their depths, m.
[[nodiscard]] Patch triangle(const Vector3d& a, double of_a, const Vector3d& b, double of_b,
                             const Vector3d& c, double of_c);

/// Returns the medial set of a body, in the body's frame: the centre of a sphere, the axis of a
/// capsule, the medial surface of a box or cylinder, whose circles are replaced by polygons that
/// are off by at most `tolerance` / 4, or have 64 sides. The set of a mesh is not known: the result
/// has no patches.
[[nodiscard]] Medial medial_of(const Shape& shape, double tolerance);

}  // namespace swivel::detail
