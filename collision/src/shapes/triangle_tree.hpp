// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <utility>
#include <vector>

#include "shapes/segment.hpp"

namespace swivel::detail {

/// A triangle of one tree and one of another.
struct TrianglePair {
  int a = 0, b = 0;
};

/// Triangles in a binary tree of boxes, for exact distances up to a limit. Const calls are safe from many threads.
class TriangleTree {
 public:
  /// At least one triangle.
  explicit TriangleTree(std::vector<Triangle> triangles);
  /// The distance from the nearest triangle, m, where it lies in [enough, limit]; below that, the first distance found that is
  /// below `enough`; beyond it, `limit`. The segment is in the triangles' frame. The search begins with the triangle `first`, and
  /// leaves there the nearest one that it has met: the next question about bodies that have moved little is answered sooner.
  [[nodiscard]] double distance(const Segment& segment, double enough, double limit, int& first) const;
  /// The same from the triangles of another tree, whose frame lies at `pose` in this one's.
  [[nodiscard]] double distance(const TriangleTree& other, const Pose& pose, double enough, double limit,
                                TrianglePair& first) const;
  /// The distance of a point from one of the triangles, m.
  [[nodiscard]] double distance_at(const Vector3d& point, int triangle) const;
  /// The nearest point of one of the triangles.
  [[nodiscard]] Vector3d nearest_on(const Vector3d& point, int triangle) const;
  /// Whether a triangle that is nearer than `radius` to the point reaches beyond the plane of points x with normal . x = offset.
  [[nodiscard]] bool reaches_beyond(const Vector3d& point, double radius, const Vector3d& normal, double offset) const;
  /// Of one triangle from one of the other tree, m.
  [[nodiscard]] double distance_at(const TriangleTree& other, const Pose& pose, const TrianglePair& pair) const;
  /// The triangles that are nearer than `limit` to one of the other tree, and those of the other tree, by their places in the lists
  /// that the trees were made of, in ascending order.
  [[nodiscard]] std::array<std::vector<int>, 2> nearer(const TriangleTree& other, const Pose& pose, double limit) const;
  /// Looks for a triangle of which `proves` holds where `gap`, a signed distance from some solid, m, is least. Begins with the
  /// triangle `first`, and leaves there the one found. Looks into a few boxes only, none of them at a gap of `enough`: where it
  /// finds no triangle, there may be one.
  template <class Gap, class Proves>
  [[nodiscard]] bool seek(double enough, const Gap& gap, const Proves& proves, int& first) const;

 private:
  struct Node {
    Vector3d center, half;   ///< of the box
    int begin = 0, end = 0;  ///< its triangles
    int right = 0;           ///< second child; the first is the next node; 0: a leaf
    int place = 0;           ///< in `leaves_` or, of other nodes, in `below_`
  };
  /// A node's box once more, in single precision; the fourth numbers are zero.
  struct SingleBox {
    Eigen::Array4f center, half;
  };
  /// The two to four boxes of a node's children's children, or of a child that is a leaf: one vector for each coordinate.
  struct FourBoxes {
    std::array<Eigen::Array4f, 3> center, half;
    std::array<int, 4> node{};
    int count = 0;
  };
  /// A box along the axes of what it holds: a leaf is a patch of a surface, and thin.
  struct OrientedBox {
    std::array<Eigen::Array4f, 3> axes, rows;  ///< columns and rows of the matrix of its axes
    Eigen::Array4f center, half;
  };
  struct Item {
    Vector3d center;
    int triangle;
  };
  Eigen::AlignedBox3d build(std::vector<Item>& items, int begin, int end);
  [[nodiscard]] OrientedBox oriented_box(const Node& leaf) const;
  [[nodiscard]] FourBoxes boxes_below(int node) const;

  static constexpr std::size_t kDeepest = 64;  // of a tree that halves its triangles, and of the stack of one that goes down it

  std::vector<Triangle> triangles_;
  std::vector<int> places_;  // of triangles_ in the list given
  std::vector<Node> nodes_;
  std::vector<SingleBox> single_;  // of nodes_
  std::vector<FourBoxes> below_;
  std::vector<OrientedBox> leaves_;
  double reach_ = 0;  // no point is further from the frame's origin, m
};

template <class Gap, class Proves>
bool TriangleTree::seek(double enough, const Gap& gap, const Proves& proves, int& first) const {
  if (proves(triangles_[first])) return true;
  // Looking into 16 proves 910 of a thousand collisions of an arm's links with boxes, into 64 proves 990. Where nothing collides,
  // none of it helps.
  constexpr int kMostBoxes = 40;
  struct Open {
    int node;
    double gap;  // of its box's centre
  };
  std::array<Open, kDeepest> stack;
  std::size_t open = 0;
  const auto at = [&](int node) { return Open{node, gap(nodes_[node].center)}; };
  stack[open++] = at(0);
  for (int left = kMostBoxes; left > 0 && open > 0; --left) {
    const Open here = stack[--open];
    const Node& node = nodes_[here.node];
    if (here.gap - node.half.norm() >= enough) continue;
    if (node.right == 0) {
      for (int k = node.begin; k < node.end; ++k)
        if (proves(triangles_[k])) {
          first = k;
          return true;
        }
      continue;
    }
    Open near = at(here.node + 1), far = at(node.right);
    if (far.gap < near.gap) std::swap(near, far);
    stack[open++] = far;
    stack[open++] = near;
  }
  return false;
}

}  // namespace swivel::detail
