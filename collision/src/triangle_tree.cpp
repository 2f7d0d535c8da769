// SPDX-License-Identifier: BSD-3-Clause
#include "triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace swivel::detail {

namespace {

constexpr int kLeaf = 4;
constexpr int kBox = 12;  // triangles of a box: one leaf, whose bound is the box itself

/// Least squared distance that a segment may have from a box: by the gaps along the box's axes and across the segment. Need not be
/// told where it is at least `limit`.
class BoxBound {
 public:
  explicit BoxBound(const Segment& s) : middle_(s.at(0.5)), half_(s.along.cwiseAbs() / 2) {
    for (int k = 0; k < 3; ++k) across_[k] = Vector3d::Unit(k).cross(s.along).stableNormalized();
  }
  [[nodiscard]] double squared(const Vector3d& center, const Vector3d& half, double limit) const {
    const Vector3d offset = center - middle_;
    double widest = (offset.cwiseAbs() - half - half_).cwiseMax(0).squaredNorm();
    if (widest >= limit) return widest;
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

/// Least squared distance of a box from another, which stands at a pose: by the gaps along the axes of both. Need not be told where
/// it is at least `limit`.
class BoxPairBound {
 public:
  explicit BoxPairBound(const Pose& pose) : pose_(pose), turn_(pose.linear()), spread_(turn_.cwiseAbs()) {}
  [[nodiscard]] double squared(const Vector3d& center, const Vector3d& half, const Vector3d& other_center,
                               const Vector3d& other_half, double limit) const {
    const Vector3d offset = pose_ * other_center - center;
    const Vector3d gap = offset.cwiseAbs() - half - spread_ * other_half;
    const double squared_gap = gap.cwiseMax(0).squaredNorm();
    if (squared_gap >= limit) return squared_gap;
    const Vector3d other_gap = (turn_.transpose() * offset).cwiseAbs() - other_half - spread_.transpose() * half;
    return std::max(squared_gap, other_gap.cwiseMax(0).squaredNorm());
  }

 private:
  Pose pose_;
  Matrix3d turn_, spread_;
};

/// Least squared distance that a triangle may have from a box: by the gaps along the box's axes.
double squared_gap(const Triangle& t, const Vector3d& center, const Vector3d& half) {
  const Vector3d from = t.a - center;
  const Vector3d low = from + t.ab.cwiseMin(t.ac).cwiseMin(0), high = from + t.ab.cwiseMax(t.ac).cwiseMax(0);
  return (low - half).cwiseMax(-high - half).cwiseMax(0).squaredNorm();
}

}  // namespace

TriangleTree::TriangleTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  std::vector<Item> items;
  items.reserve(triangles_.size());
  for (const Triangle& t : triangles_) items.push_back({t.a + (t.ab + t.ac) / 3, static_cast<int>(items.size())});
  nodes_.reserve(triangles_.size());
  build(items, 0, static_cast<int>(items.size()));
  std::vector<Triangle> in_order;
  in_order.reserve(items.size());
  places_.reserve(items.size());
  for (const Item& item : items) {
    in_order.push_back(triangles_[item.triangle]);
    places_.push_back(item.triangle);
  }
  triangles_.swap(in_order);
}

Eigen::AlignedBox3d TriangleTree::build(std::vector<Item>& items, int begin, int end) {
  const std::size_t index = nodes_.size();
  nodes_.push_back({Vector3d::Zero(), Vector3d::Zero(), begin, end, 0});
  Eigen::AlignedBox3d box;
  if (end - begin <= kLeaf || items.size() <= kBox) {
    for (int k = begin; k < end; ++k) {
      const Triangle& t = triangles_[items[k].triangle];
      box.extend(t.a).extend(t.a + t.ab).extend(t.a + t.ac);
    }
  } else {
    Eigen::AlignedBox3d centers;
    for (int k = begin; k < end; ++k) centers.extend(items[k].center);
    int axis = 0;
    centers.sizes().maxCoeff(&axis);
    const int middle = begin + (end - begin) / 2;
    std::nth_element(items.begin() + begin, items.begin() + middle, items.begin() + end,
                     [axis](const Item& s, const Item& t) { return s.center[axis] < t.center[axis]; });
    box = build(items, begin, middle);
    nodes_[index].right = static_cast<int>(nodes_.size());
    box.extend(build(items, middle, end));
  }
  nodes_[index].center = box.center();
  nodes_[index].half = box.sizes() / 2;
  return box;
}

double TriangleTree::distance(const Segment& segment, double enough, double limit, int& first) const {
  const BoxBound bound(segment);
  struct Open {
    int node;
    double bound;
  };
  std::array<Open, kDeepest> stack;
  std::size_t open = 0;
  double least = limit * limit;
  const double squared_enough = enough > 0 ? enough * enough : 0;
  const auto meet = [&](int triangle) {
    const double found = squared_distance(segment, triangles_[triangle], least);
    if (found < least) {
      least = found;
      first = triangle;
    }
    return least < squared_enough;
  };
  if (meet(first)) return std::sqrt(least);
  const auto squared_bound = [&](int node) {
    const Node& n = nodes_[node];
    return bound.squared(n.center, n.half, least);
  };
  stack[open++] = {0, squared_bound(0)};
  while (open > 0) {
    const auto [index, at_least] = stack[--open];
    if (at_least >= least) continue;
    const Node& node = nodes_[index];
    if (node.right == 0) {
      for (int k = node.begin; k < node.end; ++k)
        if (meet(k)) return std::sqrt(least);
      continue;
    }
    Open near{index + 1, squared_bound(index + 1)}, far{node.right, squared_bound(node.right)};
    if (far.bound < near.bound) std::swap(near, far);
    if (far.bound < least) stack[open++] = far;
    if (near.bound < least) stack[open++] = near;
  }
  return std::sqrt(least);
}

double TriangleTree::distance(const TriangleTree& other, const Pose& pose, double enough, double limit, TrianglePair& first) const {
  if (triangles_.size() > kBox && other.triangles_.size() <= kBox) {  // triangles are held against the box itself
    TrianglePair swapped{first.b, first.a};
    const double found = other.distance(*this, pose.inverse(Eigen::Isometry), enough, limit, swapped);
    first = {swapped.b, swapped.a};
    return found;
  }
  const BoxPairBound bound(pose);
  struct Open {
    int a, b;
    double bound;
  };
  std::array<Open, 2 * kDeepest> stack;
  std::size_t open = 0;
  double least = limit * limit;
  const double squared_enough = enough > 0 ? enough * enough : 0;
  const auto squared_bound = [&](int a, int b) {
    const Node &m = nodes_[a], &n = other.nodes_[b];
    return bound.squared(m.center, m.half, n.center, n.half, least);
  };
  const auto meet = [&](int own, int others, const Triangle& moved) {
    const double found = squared_distance(triangles_[own], moved, least);
    if (found < least) {
      least = found;
      first = {own, others};
    }
    return least < squared_enough;
  };
  if (meet(first.a, first.b, other.triangles_[first.b].moved(pose))) return std::sqrt(least);
  stack[open++] = {0, 0, squared_bound(0, 0)};
  while (open > 0) {
    const Open here = stack[--open];
    if (here.bound >= least) continue;
    const Node &m = nodes_[here.a], &n = other.nodes_[here.b];
    if (m.right == 0 && n.right == 0) {
      for (int j = n.begin; j < n.end; ++j) {
        const Triangle moved = other.triangles_[j].moved(pose);
        if (squared_gap(moved, m.center, m.half) >= least) continue;
        for (int k = m.begin; k < m.end; ++k)
          if (meet(k, j, moved)) return std::sqrt(least);
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

std::array<std::vector<int>, 2> TriangleTree::nearer(const TriangleTree& other, const Pose& pose, double limit) const {
  const BoxPairBound bound(pose);
  std::array<std::vector<int>, 2> near;
  std::vector<std::array<int, 2>> open{{0, 0}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    const Node &m = nodes_[a], &n = other.nodes_[b];
    if (bound.squared(m.center, m.half, n.center, n.half, limit * limit) >= limit * limit) continue;
    if (m.right == 0 && n.right == 0) {
      for (int j = n.begin; j < n.end; ++j) {
        const Triangle moved = other.triangles_[j].moved(pose);
        for (int k = m.begin; k < m.end; ++k) {
          if (squared_distance(triangles_[k], moved, limit * limit) >= limit * limit) continue;
          near[0].push_back(places_[k]);
          near[1].push_back(other.places_[j]);
        }
      }
    } else if (n.right == 0 || (m.right != 0 && m.half.squaredNorm() >= n.half.squaredNorm())) {
      open.insert(open.end(), {{a + 1, b}, {m.right, b}});
    } else {
      open.insert(open.end(), {{a, b + 1}, {a, n.right}});
    }
  }
  for (auto& triangles : near) {
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  }
  return near;
}

}  // namespace swivel::detail
