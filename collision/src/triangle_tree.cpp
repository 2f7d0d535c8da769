// SPDX-License-Identifier: BSD-3-Clause
#include "triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace swivel {

namespace {

constexpr int kLeaf = 4;
constexpr std::size_t kDeepest = 64;  // of a tree that halves its triangles, and of the stack of one that goes down it

/// Least squared distance that a segment may have from a box: by the gaps along the box's axes and across the segment.
class BoxBound {
 public:
  explicit BoxBound(const Segment& s) : middle_(s.at(0.5)), half_(s.along.cwiseAbs() / 2) {
    for (int k = 0; k < 3; ++k) across_[static_cast<std::size_t>(k)] = Vector3d::Unit(k).cross(s.along).stableNormalized();
  }
  [[nodiscard]] double squared(const Vector3d& center, const Vector3d& half) const {
    const Vector3d offset = center - middle_;
    double widest = (offset.cwiseAbs() - half - half_).cwiseMax(0).squaredNorm();
    for (const Vector3d& axis : across_) {
      const double gap = std::abs(axis.dot(offset)) - axis.cwiseAbs().dot(half);
      if (gap > 0) widest = std::max(widest, gap * gap);
    }
    return widest;
  }

 private:
  Vector3d middle_, half_;
  std::array<Vector3d, 3> across_;
};

}  // namespace

TriangleTree::TriangleTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  nodes_.reserve(triangles_.size());
  build(0, static_cast<int>(triangles_.size()));
}

void TriangleTree::build(int begin, int end) {
  Eigen::AlignedBox3d box, centers;
  const auto center = [](const Triangle& t) { return Vector3d(t.a + (t.ab + t.ac) / 3); };
  for (int k = begin; k < end; ++k) {
    const Triangle& t = triangles_[static_cast<std::size_t>(k)];
    box.extend(t.a).extend(t.a + t.ab).extend(t.a + t.ac);
    centers.extend(center(t));
  }
  const std::size_t index = nodes_.size();
  nodes_.push_back({box.center(), box.sizes() / 2, begin, end, 0});
  if (end - begin <= kLeaf) return;
  int axis = 0;
  centers.sizes().maxCoeff(&axis);
  const int middle = begin + (end - begin) / 2;
  std::nth_element(triangles_.begin() + begin, triangles_.begin() + middle, triangles_.begin() + end,
                   [&](const Triangle& s, const Triangle& t) { return center(s)[axis] < center(t)[axis]; });
  build(begin, middle);
  nodes_[index].right = static_cast<int>(nodes_.size());
  build(middle, end);
}

double TriangleTree::distance(const Segment& segment, double enough, double limit) const {
  const BoxBound bound(segment);
  const auto squared_bound = [&](int node) {
    const Node& n = nodes_[static_cast<std::size_t>(node)];
    return bound.squared(n.center, n.half);
  };
  struct Open {
    int node;
    double bound;
  };
  std::array<Open, kDeepest> stack;
  std::size_t open = 0;
  double least = limit * limit;
  const double squared_enough = enough > 0 ? enough * enough : 0;
  stack[open++] = {0, squared_bound(0)};
  while (open > 0) {
    const auto [index, at_least] = stack[--open];
    if (at_least >= least) continue;
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    if (node.right == 0) {
      for (int k = node.begin; k < node.end; ++k) {
        least = std::min(least, squared_distance(segment, triangles_[static_cast<std::size_t>(k)], least));
        if (least < squared_enough) return std::sqrt(least);
      }
      continue;
    }
    Open near{index + 1, squared_bound(index + 1)}, far{node.right, squared_bound(node.right)};
    if (far.bound < near.bound) std::swap(near, far);
    if (far.bound < least) stack[open++] = far;
    if (near.bound < least) stack[open++] = near;
  }
  return std::sqrt(least);
}

double TriangleTree::distance(const TriangleTree& other, const Pose& pose, double enough, double limit) const {
  const Matrix3d turn = pose.linear(), spread = turn.cwiseAbs();
  const auto squared_bound = [&](int a, int b) {
    const Node &m = nodes_[static_cast<std::size_t>(a)], &n = other.nodes_[static_cast<std::size_t>(b)];
    const Vector3d offset = pose * n.center - m.center;
    const Vector3d gap = offset.cwiseAbs() - m.half - spread * n.half;
    const Vector3d other_gap = (turn.transpose() * offset).cwiseAbs() - n.half - spread.transpose() * m.half;
    return std::max(gap.cwiseMax(0).squaredNorm(), other_gap.cwiseMax(0).squaredNorm());
  };
  struct Open {
    int a, b;
    double bound;
  };
  std::array<Open, 2 * kDeepest> stack;
  std::size_t open = 0;
  double least = limit * limit;
  const double squared_enough = enough > 0 ? enough * enough : 0;
  stack[open++] = {0, 0, squared_bound(0, 0)};
  while (open > 0) {
    const Open here = stack[--open];
    if (here.bound >= least) continue;
    const Node &m = nodes_[static_cast<std::size_t>(here.a)], &n = other.nodes_[static_cast<std::size_t>(here.b)];
    if (m.right == 0 && n.right == 0) {
      for (int j = n.begin; j < n.end; ++j) {
        const Triangle& t = other.triangles_[static_cast<std::size_t>(j)];
        const Vector3d corner = pose * t.a;
        const Triangle moved(corner, corner + turn * t.ab, corner + turn * t.ac);
        for (int k = m.begin; k < m.end; ++k) {
          least = std::min(least, squared_distance(triangles_[static_cast<std::size_t>(k)], moved, least));
          if (least < squared_enough) return std::sqrt(least);
        }
      }
      continue;
    }
    // The larger box is halved.
    const bool halve_a = n.right == 0 || (m.right != 0 && m.half.squaredNorm() >= n.half.squaredNorm());
    Open near = halve_a ? Open{here.a + 1, here.b, 0} : Open{here.a, here.b + 1, 0};
    Open far = halve_a ? Open{m.right, here.b, 0} : Open{here.a, n.right, 0};
    near.bound = squared_bound(near.a, near.b);
    far.bound = squared_bound(far.a, far.b);
    if (far.bound < near.bound) std::swap(near, far);
    if (far.bound < least) stack[open++] = far;
    if (near.bound < least) stack[open++] = near;
  }
  return std::sqrt(least);
}

}  // namespace swivel
