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

using Single = Eigen::Array4f;
Single in_single(const Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
}

/// Least squared distances of boxes from boxes of a tree that stands at a pose, by the gaps along the axes of both. In single
/// precision, one vector for three numbers. What that loses is taken off each gap: a few dozen roundings, of 2^-24 each, of lengths
/// that are at most how far the boxes lie from both frames' origins (`reach`) and these from each other.
class BoxPairBound {
 public:
  BoxPairBound(const Pose& pose, double reach)
      : at_(in_single(pose.translation())), lost_(static_cast<float>(kLost * (reach + pose.translation().norm()))) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      turn_[k] = in_single(pose.linear().col(axis));
      back_[k] = in_single(pose.linear().row(axis).transpose());
      spread_[k] = turn_[k].abs();
      back_spread_[k] = back_[k].abs();
    }
  }
  /// Upright boxes. Need not be told where it is at least `limit`.
  template <class Box>
  [[nodiscard]] float squared(const Box& box, const Box& other, float limit) const {
    const Single offset = at_ + product(turn_, other.center) - box.center;
    const float along_box = squared(offset.abs() - box.half - product(spread_, other.half));
    if (along_box >= limit) return along_box;
    return std::max(along_box, squared(product(back_, offset).abs() - other.half - product(back_spread_, box.half)));
  }
  /// Whether boxes with axes of their own are apart by `limit`, squared.
  template <class Box>
  [[nodiscard]] bool further(const Box& box, const Box& other, float limit) const {
    const Single offset = product(box.rows, at_ + product(turn_, other.center) - box.center);
    std::array<Single, 3> axes;  // the other's, along this one's
    for (std::size_t k = 0; k < 3; ++k) axes[k] = product(box.rows, product(turn_, other.axes[k]));
    const Single reach = axes[0].abs() * other.half[0] + axes[1].abs() * other.half[1] + axes[2].abs() * other.half[2];
    if (squared(offset.abs() - box.half - reach) >= limit) return true;
    Single gaps = Single::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      gaps[axis] = std::abs((axes[k] * offset).sum()) - other.half[axis] - (axes[k].abs() * box.half).sum();
    }
    return squared(gaps) >= limit;
  }

 private:
  static constexpr double kLost = 0x1p-17;
  static Single product(const std::array<Single, 3>& columns, const Single& v) {
    return columns[0] * v[0] + columns[1] * v[1] + columns[2] * v[2];
  }
  [[nodiscard]] float squared(const Single& gaps) const { return (gaps - lost_).max(0).matrix().squaredNorm(); }

  std::array<Single, 3> turn_, back_, spread_, back_spread_;  // columns
  Single at_;
  float lost_;
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
  single_.reserve(nodes_.size());
  for (Node& node : nodes_) {
    single_.push_back({in_single(node.center), in_single(node.half)});
    if (node.right != 0) continue;
    node.leaf = static_cast<int>(leaves_.size());
    leaves_.push_back(oriented_box(node));
  }
  reach_ = nodes_[0].center.norm() + nodes_[0].half.norm();
}

/// Along the patch's mean normal and its longest edge.
TriangleTree::OrientedBox TriangleTree::oriented_box(const Node& leaf) const {
  Vector3d normal = Vector3d::Zero(), longest = Vector3d::Zero();
  for (int k = leaf.begin; k < leaf.end; ++k) {
    const Triangle& t = triangles_[k];
    normal += t.ab.cross(t.ac);
    for (const Vector3d& edge : {t.ab, t.ac})
      if (edge.squaredNorm() > longest.squaredNorm()) longest = edge;
  }
  Matrix3d axes = Matrix3d::Identity();
  const Vector3d across = normal.cross(longest);
  if (triangles_.size() > kBox && normal.norm() > 0 && across.norm() > 0) {
    axes.col(0) = normal.stableNormalized();
    axes.col(1) = across.stableNormalized();
    axes.col(2) = axes.col(0).cross(axes.col(1));
  }
  Eigen::AlignedBox3d box;
  for (int k = leaf.begin; k < leaf.end; ++k) {
    const Triangle& t = triangles_[k];
    const Vector3d a = axes.transpose() * t.a;
    box.extend(a).extend(a + axes.transpose() * t.ab).extend(a + axes.transpose() * t.ac);
  }
  const auto column = [&](int k) { return in_single(axes.col(k)); };
  const auto row = [&](int k) { return in_single(axes.row(k).transpose()); };
  return {{column(0), column(1), column(2)}, {row(0), row(1), row(2)}, in_single(axes * box.center()), in_single(box.sizes() / 2)};
}

Eigen::AlignedBox3d TriangleTree::build(std::vector<Item>& items, int begin, int end) {
  const std::size_t index = nodes_.size();
  nodes_.push_back({Vector3d::Zero(), Vector3d::Zero(), begin, end, 0, 0});
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
  const BoxPairBound bound(pose, reach_ + other.reach_);
  const Matrix3d back = pose.linear().transpose();
  struct Open {
    int a, b;
    float bound;
  };
  std::array<Open, 2 * kDeepest> stack;
  std::size_t open = 0;
  double least = limit * limit;
  const double squared_enough = enough > 0 ? enough * enough : 0;
  const auto squared_bound = [&](int a, int b) { return bound.squared(single_[a], other.single_[b], static_cast<float>(least)); };
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
      if (bound.further(leaves_[m.leaf], other.leaves_[n.leaf], static_cast<float>(least))) continue;
      const Vector3d there = back * (m.center - pose.translation()), half_there = back.cwiseAbs() * m.half;  // around m's box
      for (int j = n.begin; j < n.end; ++j) {
        if (squared_gap(other.triangles_[j], there, half_there) >= least) continue;
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

double TriangleTree::distance_at(const TriangleTree& other, const Pose& pose, const TrianglePair& pair) const {
  constexpr double kFarAway = 1e12;  // m^2
  return std::sqrt(squared_distance(triangles_[pair.a], other.triangles_[pair.b].moved(pose), kFarAway));
}

std::array<std::vector<int>, 2> TriangleTree::nearer(const TriangleTree& other, const Pose& pose, double limit) const {
  const BoxPairBound bound(pose, reach_ + other.reach_);
  const auto squared_limit = static_cast<float>(limit * limit);
  std::array<std::vector<int>, 2> near;
  std::vector<std::array<int, 2>> open{{0, 0}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    const Node &m = nodes_[a], &n = other.nodes_[b];
    if (bound.squared(single_[a], other.single_[b], squared_limit) >= squared_limit) continue;
    if (m.right == 0 && n.right == 0) {
      if (bound.further(leaves_[m.leaf], other.leaves_[n.leaf], squared_limit)) continue;
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
