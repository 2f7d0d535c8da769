// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "shapes/segment.hpp"

namespace swivel::detail {

/// The index of a triangle in one tree and of a triangle in another.
struct TrianglePair {
  int a = 0, b = 0;
};

/// A binary tree of boxes over triangles, which computes exact distances up to a limit. Const calls
/// are safe from many threads.
class TriangleTree {
 public:
  /// Builds the tree of at least one triangle.
  explicit TriangleTree(std::vector<Triangle> triangles);
  /// Returns the distance of the segment, in the triangles' frame, from the nearest triangle, m, if
  /// it lies in [enough, limit]; if it is less, the first distance found that is below `enough`; if
  /// it is more, `limit`. `first` is a warm start: the search begins with this triangle and stores
  /// the nearest one that it meets, so that the next call for bodies that have moved little is
  /// faster.
  [[nodiscard]] double distance(const Segment& segment, double enough, double limit,
                                int& first) const;
  /// Returns the distance of this tree's triangles from those of `other`, m, whose frame lies at
  /// `pose` in this tree's frame, if it lies in [enough, limit]; if it is less, the first distance
  /// found that is below `enough`; if it is more, `limit`. `first` is a warm start: the search
  /// begins with this pair and stores the nearest one that it meets.
  [[nodiscard]] double distance(const TriangleTree& other, const Pose& pose, double enough,
                                double limit, TrianglePair& first) const;
  /// Returns the box about all triangles, along the axes of their frame.
  [[nodiscard]] Eigen::AlignedBox3d box() const {
    return {nodes_[0].center - nodes_[0].half, nodes_[0].center + nodes_[0].half};
  }
  /// Returns the distance of a point from one of the triangles, m.
  [[nodiscard]] double distance_at(const Vector3d& point, int triangle) const;
  /// Returns the point of one of the triangles that is nearest to `point`.
  [[nodiscard]] Vector3d nearest_on(const Vector3d& point, int triangle) const;
  /// Returns how far the triangles that are nearer than `radius`, m, to the point reach along a
  /// direction: the greatest normal . x of their points x, m, if it lies in [least, most]; if it is
  /// less, `least`; if it is more, the first value found that is above `most`.
  [[nodiscard]] double reach_near(const Vector3d& point, double radius, const Vector3d& normal,
                                  double least, double most) const;
  /// Returns the distance of triangle pair.a of this tree from triangle pair.b of `other`, m, whose
  /// frame lies at `pose` in this tree's frame.
  [[nodiscard]] double distance_at(const TriangleTree& other, const Pose& pose,
                                   const TrianglePair& pair) const;
  /// Returns the triangles of this tree that are nearer than `limit`, m, to a triangle of `other`,
  /// and those of `other` that are nearer than it to one of this tree: indices into the lists that
  /// the trees were made of, in ascending order. The frame of `other` lies at `pose` in this tree's
  /// frame.
  [[nodiscard]] std::array<std::vector<int>, 2> nearer(const TriangleTree& other, const Pose& pose,
                                                       double limit) const;
  /// Looks for a triangle for which `proves` returns true, where `gap`, a signed distance from some
  /// solid, m, is least, and returns true if it finds one. `first` is a warm start: the search
  /// begins with this triangle and stores the one found. Only a few boxes are searched, and none
  /// whose gap is at least `enough`: if the result is false, there may still be such a triangle.
  template <class Gap, class Proves>
  [[nodiscard]] bool seek(double enough, const Gap& gap, const Proves& proves, int& first) const;
  /// Calls look_at(triangle) with triangles in the order of a bound of theirs. `most(center, half)`
  /// is an upper bound, for a box, of some value of the triangles in it. look_at() returns the
  /// value below which boxes are of no interest, which is `of_interest` at the beginning. Returns
  /// the greatest bound of the boxes that were not looked into; minus infinity if all were.
  template <class Most, class LookAt>
  double visit_best_first(const Most& most, double of_interest, const LookAt& look_at) const;

 private:
  struct Node {
    Vector3d center, half;   ///< of the box
    int begin = 0, end = 0;  ///< its triangles
    int right = 0;           ///< second child; the first is the next node; 0: a leaf
    int place = 0;           ///< in `leaves_` or, of other nodes, in `below_`
  };
  /// A node's box in single precision. The fourth numbers are zero.
  struct SingleBox {
    Eigen::Array4f center, half;
  };
  /// The two to four boxes of a node's grandchildren, or of a child that is a leaf, with one vector
  /// for each coordinate.
  struct FourBoxes {
    std::array<Eigen::Array4f, 3> center, half;
    std::array<int, 4> node{};
    int count = 0;
  };
  /// A box along axes fitted to its triangles: a leaf is a patch of a surface, and thin.
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

  // of a tree that halves its triangles, and of the stack of one that goes down it
  static constexpr std::size_t kDeepest = 64;

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
  // The search of 16 boxes proves 910 of a thousand collisions of an arm's links with boxes, the
  // search of 64 proves 990. If nothing collides, the search is wasted.
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

template <class Most, class LookAt>
double TriangleTree::visit_best_first(const Most& most, double of_interest,
                                      const LookAt& look_at) const {
  double left = -std::numeric_limits<double>::infinity();
  std::priority_queue<std::pair<double, int>> open;
  const auto add = [&](int node) {
    const double bound = most(nodes_[node].center, nodes_[node].half);
    if (bound <= of_interest)
      left = std::max(left, bound);
    else
      open.emplace(bound, node);
  };
  add(0);
  while (!open.empty() && open.top().first > of_interest) {
    const int index = open.top().second;
    const Node& node = nodes_[index];
    open.pop();
    if (node.right != 0) {
      add(index + 1);
      add(node.right);
      continue;
    }
    for (int k = node.begin; k < node.end; ++k) of_interest = look_at(triangles_[k]);
  }
  return open.empty() ? left : std::max(left, open.top().first);
}

}  // namespace swivel::detail
