// SPDX-License-Identifier: BSD-3-Clause
#include "shapes/triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace swivel::detail {

namespace {

constexpr int kLeaf = 4;
constexpr int kBox = 12;  // triangles of a box: one leaf, whose bound is the box itself

/// Computes a lower bound of the squared distance of a segment from boxes, m^2, by the gaps along
/// the box's axes and across the segment. The bound may be coarser where it is at least `limit`.
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

/// Computes lower bounds of the squared distances, m^2, of boxes of one tree from boxes of another
/// tree that is placed at a pose, by the gaps along the axes of both. It works in single precision,
/// with one vector for three numbers, or for one number of four boxes. The rounding error is
/// subtracted from each gap: a few dozen roundings of 2^-24 each, of lengths that are at most how
/// far the boxes lie from both frames' origins (`reach`) plus how far these lie from each other.
class BoxPairBound {
 public:
  BoxPairBound(const Pose& pose, double reach)
      : at_(in_single(pose.translation())),
        lost_(static_cast<float>(kLost * (reach + pose.translation().norm()))) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      turn_[k] = in_single(pose.linear().col(axis));
      back_[k] = in_single(pose.linear().row(axis).transpose());
      spread_[k] = turn_[k].abs();
      back_spread_[k] = back_[k].abs();
    }
  }
  /// Returns the bound for two boxes along the axes of their trees. It may be coarser where it is
  /// at least `limit`.
  template <class Box>
  [[nodiscard]] float squared(const Box& box, const Box& other, float limit) const {
    const Single offset = at_ + product(turn_, other.center) - box.center;
    const float along_box = squared(offset.abs() - box.half - product(spread_, other.half));
    if (along_box >= limit) return along_box;
    return std::max(along_box, squared(product(back_, offset).abs() - other.half -
                                       product(back_spread_, box.half)));
  }
  /// Squared distances of four boxes from one.
  struct FourGaps {
    Single bound;    ///< least distance
    Single between;  ///< of the centres
  };
  /// Returns the bounds for four boxes of this tree and one of the other, all along the axes of
  /// their trees.
  template <class Four, class Box>
  [[nodiscard]] FourGaps squared_of_four(const Four& boxes, const Box& other) const {
    const Single center = at_ + product(turn_, other.center), reach = product(spread_, other.half);
    Three offset;
    Single along_boxes = Single::Zero(), along_other = Single::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      offset[k] = center[axis] - boxes.center[k];
      along_boxes += over_gap(offset[k].abs() - boxes.half[k] - reach[axis]);
    }
    for (std::size_t k = 0; k < 3; ++k)
      along_other +=
          over_gap(dot(turn_[k], offset).abs() - other.half[static_cast<Eigen::Index>(k)] -
                   dot(spread_[k], boxes.half));
    return {along_boxes.max(along_other), squared_norm(offset)};
  }
  /// Returns true if two boxes with axes of their own are proved to be apart by at least
  /// sqrt(limit).
  template <class Box>
  [[nodiscard]] bool further(const Box& box, const Box& other, float limit) const {
    const Single offset = product(box.rows, at_ + product(turn_, other.center) - box.center);
    std::array<Single, 3> axes;  // the other's, along this one's
    for (std::size_t k = 0; k < 3; ++k) axes[k] = product(box.rows, product(turn_, other.axes[k]));
    const Single reach = axes[0].abs() * other.half[0] + axes[1].abs() * other.half[1] +
                         axes[2].abs() * other.half[2];
    if (squared(offset.abs() - box.half - reach) >= limit) return true;
    Single gaps = Single::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      gaps[axis] =
          std::abs((axes[k] * offset).sum()) - other.half[axis] - (axes[k].abs() * box.half).sum();
    }
    return squared(gaps) >= limit;
  }

 private:
  static constexpr double kLost = 0x1p-17;
  static Single product(const std::array<Single, 3>& columns, const Single& v) {
    return columns[0] * v[0] + columns[1] * v[1] + columns[2] * v[2];
  }
  [[nodiscard]] float squared(const Single& gaps) const {
    return (gaps - lost_).max(0).matrix().squaredNorm();
  }
  using Three = std::array<Single, 3>;  // coordinates of four
  static Single dot(const Single& axis, const Three& of_four) {
    return axis[0] * of_four[0] + axis[1] * of_four[1] + axis[2] * of_four[2];
  }
  static Single squared_norm(const Three& of_four) {
    return of_four[0].square() + of_four[1].square() + of_four[2].square();
  }
  [[nodiscard]] Single over_gap(const Single& gaps) const { return (gaps - lost_).max(0).square(); }

  std::array<Single, 3> turn_, back_, spread_, back_spread_;  // columns
  Single at_;
  float lost_;
};

/// Returns a lower bound of the squared distance of a triangle from a box, m^2, by the gaps along
/// the box's axes.
double squared_gap(const Triangle& t, const Vector3d& center, const Vector3d& half) {
  const Vector3d from = t.a - center;
  const Vector3d low = from + t.ab.cwiseMin(t.ac).cwiseMin(0),
                 high = from + t.ab.cwiseMax(t.ac).cwiseMax(0);
  return (low - half).cwiseMax(-high - half).cwiseMax(0).squaredNorm();
}

/// Two boxes of two trees that are still to be looked into: their nodes, a lower bound of the
/// squared distance of what they hold, and the squared distance of their centres, m^2.
struct OpenPair {
  int a, b;
  float bound, between;
  /// Orders by the bound. All boxes that overlap have the bound 0: among these the ones whose
  /// centres are nearest are the likeliest to hold triangles that touch.
  [[nodiscard]] bool before(const OpenPair& other) const {
    return bound < other.bound || (bound == other.bound && between < other.between);
  }
};

/// The pairs of boxes that a search is still to look into, the next one last.
template <std::size_t kMost>
struct PairStack {
  std::array<OpenPair, kMost> at;
  std::size_t open = 0;
  [[gnu::always_inline]] OpenPair pop() { return at[--open]; }
  /// Adds a pair in its order among those from place `others` on.
  [[gnu::always_inline]] void push(const OpenPair& pair, std::size_t others) {
    std::size_t place = open++;
    for (; place > others && !pair.before(at[place - 1]); --place) at[place] = at[place - 1];
    at[place] = pair;
  }
};

/// Calls meet(k, j, moved) for triangles k of leaf m and j of leaf n that may be nearer than
/// sqrt(least), until it returns true. `others` are the triangles of n's tree, which lies at `pose`
/// in m's frame; `moved` is triangle j in that frame, `back` the rotation from it. Returns true
/// where meet() did.
template <class Node, class Meet>
[[gnu::always_inline]] inline bool meet_leaves(const Node& m, const Node& n,
                                               const std::vector<Triangle>& others,
                                               const Pose& pose, const Matrix3d& back,
                                               const double& least, const Meet& meet) {
  const Vector3d there = back * (m.center - pose.translation()),
                 half_there = back.cwiseAbs() * m.half;  // around m's box
  for (int j = n.begin; j < n.end; ++j) {
    if (squared_gap(others[j], there, half_there) >= least) continue;
    const Triangle moved = others[j].moved(pose);
    if (squared_gap(moved, m.center, m.half) >= least) continue;
    for (int k = m.begin; k < m.end; ++k)
      if (meet(k, j, moved)) return true;
  }
  return false;
}

}  // namespace

TriangleTree::TriangleTree(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  std::vector<Item> items;
  items.reserve(triangles_.size());
  for (const Triangle& t : triangles_)
    items.push_back({t.a + (t.ab + t.ac) / 3, static_cast<int>(items.size())});
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
    node.place = static_cast<int>(node.right == 0 ? leaves_.size() : below_.size());
    if (node.right == 0)
      leaves_.push_back(oriented_box(node));
    else
      below_.push_back(boxes_below(static_cast<int>(&node - nodes_.data())));
  }
  reach_ = nodes_[0].center.norm() + nodes_[0].half.norm();
}

TriangleTree::FourBoxes TriangleTree::boxes_below(int node) const {
  FourBoxes boxes;
  const auto add = [&](int below) {
    const auto place = static_cast<Eigen::Index>(boxes.count);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      boxes.center[k][place] = static_cast<float>(nodes_[below].center[axis]);
      boxes.half[k][place] = static_cast<float>(nodes_[below].half[axis]);
    }
    boxes.node[static_cast<std::size_t>(boxes.count++)] = below;
  };
  for (auto& coordinates : {&boxes.center, &boxes.half}) coordinates->fill(Eigen::Array4f::Zero());
  for (const int child : {node + 1, nodes_[node].right}) {
    if (nodes_[child].right == 0) {
      add(child);
      continue;
    }
    add(child + 1);
    add(nodes_[child].right);
  }
  return boxes;
}

/// Returns a box around a leaf's triangles, along their mean normal and their longest edge.
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
  return {{column(0), column(1), column(2)},
          {row(0), row(1), row(2)},
          in_single(axes * box.center()),
          in_single(box.sizes() / 2)};
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
    std::nth_element(
        items.begin() + begin, items.begin() + middle, items.begin() + end,
        [axis](const Item& s, const Item& t) { return s.center[axis] < t.center[axis]; });
    box = build(items, begin, middle);
    nodes_[index].right = static_cast<int>(nodes_.size());
    box.extend(build(items, middle, end));
  }
  nodes_[index].center = box.center();
  nodes_[index].half = box.sizes() / 2;
  return box;
}

double TriangleTree::distance(const Segment& segment, double enough, double limit,
                              int& first) const {
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

double TriangleTree::distance(const TriangleTree& other, const Pose& pose, double enough,
                              double limit, TrianglePair& first) const {
  // triangles are held against the box itself
  if (triangles_.size() > kBox && other.triangles_.size() <= kBox) {
    TrianglePair swapped{first.b, first.a};
    const double found =
        other.distance(*this, pose.inverse(Eigen::Isometry), enough, limit, swapped);
    first = {swapped.b, swapped.a};
    return found;
  }
  const BoxPairBound bound(pose, reach_ + other.reach_),
      bound_from_other(pose.inverse(Eigen::Isometry), reach_ + other.reach_);
  const Matrix3d back = pose.linear().transpose();
  PairStack<4 * kDeepest> stack;  // three more for each two levels of either tree
  double least = limit * limit;
  const double squared_enough = enough > 0 ? enough * enough : 0;
  const auto meet = [&](int own, int others, const Triangle& moved) {
    const double found = squared_distance(triangles_[own], moved, least);
    if (found < least) {
      least = found;
      first = {own, others};
    }
    return least < squared_enough;
  };
  if (meet(first.a, first.b, other.triangles_[first.b].moved(pose))) return std::sqrt(least);
  stack.push({0, 0, bound.squared(single_[0], other.single_[0], static_cast<float>(least)), 0}, 0);
  while (stack.open > 0) {
    const OpenPair here = stack.pop();
    if (here.bound >= least) continue;
    const Node &m = nodes_[here.a], &n = other.nodes_[here.b];
    if (m.right == 0 && n.right == 0) {
      if (bound.further(leaves_[m.place], other.leaves_[n.place], static_cast<float>(least)))
        continue;
      if (meet_leaves(m, n, other.triangles_, pose, back, least, meet)) return std::sqrt(least);
      continue;
    }
    // The larger box is quartered.
    const bool part_a =
        n.right == 0 || (m.right != 0 && m.half.squaredNorm() >= n.half.squaredNorm());
    const FourBoxes& parts = part_a ? below_[m.place] : other.below_[n.place];
    const BoxPairBound::FourGaps gaps =
        part_a ? bound.squared_of_four(parts, other.single_[here.b])
               : bound_from_other.squared_of_four(parts, single_[here.a]);
    const std::size_t others = stack.open;
    for (int k = 0; k < parts.count; ++k) {
      const int node = parts.node[static_cast<std::size_t>(k)];
      const OpenPair part{part_a ? node : here.a, part_a ? here.b : node, gaps.bound[k],
                          gaps.between[k]};
      if (part.bound >= least) continue;
      stack.push(part, others);  // the first to look into last
    }
  }
  return std::sqrt(least);
}

double TriangleTree::distance_at(const Vector3d& point, int triangle) const {
  constexpr double kFarAway = 1e12;  // m^2
  return std::sqrt(
      squared_distance(Segment{point, Vector3d::Zero()}, triangles_[triangle], kFarAway));
}

Vector3d TriangleTree::nearest_on(const Vector3d& point, int triangle) const {
  const Triangle& t = triangles_[triangle];
  const Vector3d from = point - t.a, foot = from - t.normal.dot(from) * t.normal;
  if (t.normal.dot(t.ab.cross(foot)) >= 0 && t.normal.dot(foot.cross(t.ac)) >= 0 &&
      t.normal.dot((t.ac - t.ab).cross(foot - t.ab)) >= 0)
    return t.a + foot;
  Vector3d nearest = t.a;
  for (int k = 0; k < 3; ++k) {
    const Segment edge = t.edge(k);
    const double length = edge.along.squaredNorm();
    const Vector3d here = edge.at(
        length > 0 ? std::clamp((point - edge.start).dot(edge.along) / length, 0.0, 1.0) : 0);
    if ((here - point).squaredNorm() < (nearest - point).squaredNorm()) nearest = here;
  }
  return nearest;
}

double TriangleTree::reach_near(const Vector3d& point, double radius, const Vector3d& normal,
                                double least, double most) const {
  const Segment at{point, Vector3d::Zero()};
  const double limit = radius * radius;
  double reach = least;
  std::array<int, kDeepest> stack;
  std::size_t open = 0;
  stack[open++] = 0;
  while (open > 0 && reach <= most) {
    const int index = stack[--open];
    const Node& node = nodes_[index];
    if (normal.dot(node.center) + normal.cwiseAbs().dot(node.half) <= reach) continue;
    if (((node.center - point).cwiseAbs() - node.half).cwiseMax(0).squaredNorm() >= limit) continue;
    if (node.right != 0) {
      stack[open++] = node.right;
      stack[open++] = index + 1;
      continue;
    }
    for (int k = node.begin; k < node.end; ++k) {
      const Triangle& t = triangles_[k];
      const double found = normal.dot(t.a) + std::max({0.0, normal.dot(t.ab), normal.dot(t.ac)});
      if (found > reach && squared_distance(at, t, 2 * limit) < limit) reach = found;
    }
  }
  return reach;
}

double TriangleTree::distance_at(const TriangleTree& other, const Pose& pose,
                                 const TrianglePair& pair) const {
  constexpr double kFarAway = 1e12;  // m^2
  return std::sqrt(
      squared_distance(triangles_[pair.a], other.triangles_[pair.b].moved(pose), kFarAway));
}

std::array<std::vector<int>, 2> TriangleTree::nearer(const TriangleTree& other, const Pose& pose,
                                                     double limit) const {
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
      if (bound.further(leaves_[m.place], other.leaves_[n.place], squared_limit)) continue;
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
