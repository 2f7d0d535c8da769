// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "segment.hpp"

namespace swivel::detail {

/// Triangles in a binary tree of boxes, for exact distances up to a limit. Const calls are safe from many threads.
class TriangleTree {
 public:
  /// At least one triangle.
  explicit TriangleTree(std::vector<Triangle> triangles);
  /// The distance from the nearest triangle, m, where it lies in [enough, limit]; below that, the first distance found that is
  /// below `enough`; beyond it, `limit`. The segment is in the triangles' frame.
  [[nodiscard]] double distance(const Segment& segment, double enough, double limit) const;
  /// The same from the triangles of another tree, whose frame lies at `pose` in this one's.
  [[nodiscard]] double distance(const TriangleTree& other, const Pose& pose, double enough, double limit) const;

 private:
  struct Node {
    Vector3d center, half;   ///< of the box
    int begin = 0, end = 0;  ///< its triangles
    int right = 0;           ///< second child; the first is the next node; 0: a leaf
  };
  struct Item {
    Vector3d center;
    int triangle;
  };
  Eigen::AlignedBox3d build(std::vector<Item>& items, int begin, int end);

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace swivel::detail
