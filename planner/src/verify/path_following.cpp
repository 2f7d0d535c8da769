// SPDX-License-Identifier: BSD-3-Clause
#include "verify/path_following.hpp"

#include <algorithm>
#include <cmath>

#include "swivel/core/lattice/places_near.hpp"

namespace swivel {

namespace {

constexpr double kForgiven = 1e-6;  // m and rad

/// An interval of a parameter in [0, 1]; empty if low > high.
struct Interval {
  double low = 1, high = 0;
  [[nodiscard]] bool empty() const { return !(low <= high); }
  void cut(const Interval& other) {
    low = std::max(low, other.low), high = std::min(high, other.high);
  }
};

/// Returns the u in [0, 1] with |a + u (b - a)| <= radius.
Interval where_within(const Vector3d& a, const Vector3d& b, double radius) {
  const Vector3d d = b - a;
  const double dd = d.squaredNorm(), ad = a.dot(d), rest = a.squaredNorm() - radius * radius;
  if (dd < 1e-30) return rest <= 0 ? Interval{0, 1} : Interval{};
  const double root2 = ad * ad - dd * rest;
  if (!(root2 >= 0)) return {};
  const double root = std::sqrt(root2);
  return {std::max(0.0, (-ad - root) / dd), std::min(1.0, (-ad + root) / dd)};
}

/// Returns the rotation vector (axis times angle, rad) from a to b, in a's frame.
Vector3d rotation_between(const Pose& a, const Pose& b) {
  const Eigen::AngleAxisd turn(a.linear().transpose() * b.linear());
  return turn.angle() * turn.axis();
}

/// Returns the part of the straight motion from a to b that is within the tolerance of a fixed
/// pose. The motion may turn by 0.1 rad at most, so that the rotation from the fixed pose is linear
/// in the parameter.
Interval where_within(const Pose& fixed, const Pose& a, const Pose& b,
                      const PoseDistance& tolerance) {
  Interval free{0, 1};
  if (std::isfinite(tolerance.position))
    free = where_within(a.translation() - fixed.translation(),
                        b.translation() - fixed.translation(), tolerance.position);
  if (std::isfinite(tolerance.angle) && !free.empty()) {
    const Vector3d from = rotation_between(fixed, a), to = rotation_between(fixed, b);
    if ((to - from).norm() > kPi) return {};  // on both sides of the half turn
    free.cut(where_within(from, to, tolerance.angle));
  }
  return free;
}

PoseDistance widened(const PoseDistance& tolerance, const PoseDistance& error) {
  return {tolerance.position + error.position + kForgiven,
          tolerance.angle + error.angle + kForgiven};
}

/// Iterates over a path from a place on, by straight pieces that turn little and end with each
/// step.
class Pieces {
 public:
  Pieces(const ToolPath& path, double begin)
      : path_(&path), to_(begin), end_(pose_at(path, begin)) {}
  /// Goes to the next piece; returns false at the end of the path.
  bool next() {
    const int step = static_cast<int>(std::floor(to_));
    if (step + 1 >= path_->size()) return false;
    double parts = std::max(1.0, std::ceil(path_->layer(step).step_angle / kTurn));
    if (rounded_near(step)) parts = std::max(parts, kBend);
    const double part = std::floor((to_ - step) * parts + 1e-9) + 1;
    from_ = to_;
    start_ = end_;
    to_ = part >= parts ? step + 1 : step + part / parts;
    end_ = pose_at(*path_, to_);
    return true;
  }
  [[nodiscard]] double from() const { return from_; }
  [[nodiscard]] double to() const { return to_; }
  [[nodiscard]] const Pose& start() const { return start_; }
  [[nodiscard]] const Pose& end() const { return end_; }
  [[nodiscard]] bool ends_at_waypoint() const {
    const int layer = static_cast<int>(to_);
    return layer == to_ && path_->layer(layer).waypoint >= 0;
  }

 private:
  /// Returns true if a corner at one of the step's ends is rounded.
  [[nodiscard]] bool rounded_near(int step) const {
    const auto& corners = path_->corners();
    const auto first = std::lower_bound(
        corners.begin(), corners.end(), step,
        [](const ToolPath::Corner& corner, int layer) { return corner.layer < layer; });
    return std::any_of(first, corners.end() - first > 2 ? first + 2 : corners.end(),
                       [&](const ToolPath::Corner& corner) {
                         return corner.layer <= step + 1 && corner.reach > 0;
                       });
  }

  static constexpr double kTurn = 0.05;  // rad
  static constexpr double kBend = 32;    // parts of a step that is rounded
  const ToolPath* path_;
  double from_ = 0, to_;
  Pose start_, end_;
};

}  // namespace

double travel_at(const ToolPath& path, double place) {
  const int i = std::min(static_cast<int>(std::floor(place)), path.size() - 2);
  return path.layer(i).travel + (place - i) * (path.layer(i + 1).travel - path.layer(i).travel);
}

Pose pose_at(const ToolPath& path, double place) {
  const int layer = static_cast<int>(std::floor(place));
  return layer == place ? path.layer(layer).tool : path.at(layer, place - layer);
}

ToolMotion tool_motion(const Chain& chain, const Config& from, const Config& to,
                       const std::array<Pose, 2>& ends, const PoseDistance& tolerance, int fewest,
                       const std::array<double, 2>& rolls) {
  constexpr double kMost = 2048;
  const Config move = (to - from).cwiseAbs();
  // The tool stays within reach_j of axis j, so its acceleration is at most sum |dq_i| sum |dq_j|
  // reach_j, and that of its angle half of (sum |dq_i|)^2. A chord is off by an eighth of the
  // acceleration. Beside a slide, whose own reach is 1 m per m, a turn before it adds twice
  // |dq_i dq_j|, so that 2 is enough; what it carries is further from the axes before it.
  double reach = (chain.home.translation() - chain.point[kDof - 1]).norm(), swept = 0;
  for (std::size_t j = kDof; j-- > 0;) {
    const auto at = static_cast<Eigen::Index>(j);
    swept += move[at] * (chain.limit[j].slides ? 2 : reach);
    if (chain.limit[j].slides) reach += std::max(std::abs(from[at]), std::abs(to[at]));
    if (j > 0) reach += (chain.point[j] - chain.point[j - 1]).norm();
  }
  const PoseDistance chord{joint_sum(move) * swept / 8, joint_sum(move) * joint_sum(move) / 16};
  const double parts2 = std::max(chord.position / std::max(0.01 * tolerance.position, kForgiven),
                                 chord.angle / std::max(0.01 * tolerance.angle, kForgiven));
  const auto parts = static_cast<int>(
      std::clamp(fewest * std::ceil(std::sqrt(parts2) / fewest), 1.0 * fewest, kMost));
  ToolMotion motion;
  motion.error = {chord.position / parts / parts, chord.angle / parts / parts};
  motion.poses.push_back(ends[0]);
  for (int m = 1; m < parts; ++m) {
    const double t = static_cast<double>(m) / parts, roll = rolls[0] + t * (rolls[1] - rolls[0]);
    const Pose tool = chain.tool(from + t * (to - from));
    motion.poses.push_back(roll != 0 ? rolled(tool, roll) : tool);
  }
  motion.poses.push_back(ends[1]);
  return motion;
}

std::vector<bool> follows(const ToolMotion& motion, const ToolPath& path, double begin,
                          std::span<const double> ends, const PoseDistance& between,
                          const PoseDistance& waypoints) {
  const PoseDistance on_the_way = widened(between, motion.error),
                     at_waypoint = widened(waypoints, motion.error);
  std::vector<bool> reached(ends.size(), false);
  const std::size_t parts = motion.poses.size() - 1;
  // The free-space diagram of Alt & Godau. Columns are pieces of the path, cells the parts of the
  // motion in them. `left` and `right` hold for each part the interval that can be reached where
  // the piece starts and ends; `below` and `above` hold for the piece the interval that can be
  // reached where the part starts and ends.
  std::vector<Interval> left(parts), right(parts);
  left[0] = {0, 0};
  bool alive = true;
  for (Pieces piece(path, begin); alive && piece.next();) {
    Interval below;
    alive = false;
    for (std::size_t m = 0; m < parts; ++m) {
      Interval above;
      right[m] = {};
      if (!below.empty() || !left[m].empty()) {
        const Pose &a = motion.poses[m], &b = motion.poses[m + 1];
        right[m] =
            where_within(piece.end(), a, b, piece.ends_at_waypoint() ? at_waypoint : on_the_way);
        above = where_within(b, piece.start(), piece.end(), on_the_way);
        if (below.empty()) right[m].low = std::max(right[m].low, left[m].low);
        if (left[m].empty()) above.low = std::max(above.low, below.low);
        alive = alive || !right[m].empty();
      }
      below = above;
    }
    for (std::size_t k = 0; k < ends.size(); ++k) {
      if (ends[k] < piece.from() || ends[k] > piece.to() || below.empty()) continue;
      const double u = (ends[k] - piece.from()) / (piece.to() - piece.from());
      if (u >= below.low - 1e-9 && u <= below.high + 1e-9) reached[k] = true;
    }
    if (piece.to() >= ends.back()) break;
    left.swap(right);
  }
  return reached;
}

PoseDistance largest_deviation(const ToolMotion& motion, const ToolPath& path, double begin,
                               double end) {
  const auto travel_at = [&](double place) {
    const int layer = std::min(static_cast<int>(std::floor(place)), path.size() - 2);
    const double from = path.layer(layer).travel;
    return from + (place - layer) * (path.layer(layer + 1).travel - from);
  };
  /// A straight piece of the path, and the travel at its ends, m.
  struct Stretch {
    Pose start;
    Vector3d along, turn;
    double from, to;
    [[nodiscard]] double distance(const Vector3d& p) const {
      const Vector3d d = p - start.translation();
      const double length2 = along.squaredNorm();
      const double u = length2 > 1e-18 ? std::clamp(d.dot(along) / length2, 0.0, 1.0) : 0;
      return (d - u * along).norm();
    }
  };
  std::vector<Stretch> stretches;
  for (Pieces piece(path, begin); piece.next() && (piece.from() < end || piece.from() == begin);) {
    const double last = std::min(1.0, (end - piece.from()) / (piece.to() - piece.from()));
    stretches.push_back({piece.start(),
                         last * (piece.end().translation() - piece.start().translation()),
                         last * rotation_between(piece.start(), piece.end()),
                         travel_at(piece.from()), travel_at(std::min(end, piece.to()))});
  }
  PoseDistance worst{0, 0};
  const double first = travel_at(begin), way = travel_at(end) - first;
  for (std::size_t m = 0; m < motion.poses.size(); ++m) {
    const Pose& tool = motion.poses[m];
    double least = std::numeric_limits<double>::infinity();
    for (const Stretch& stretch : stretches)
      least = std::min(least, stretch.distance(tool.translation()));
    // Where several places of the path are equally near, the one is taken whose travel is closest
    // to what the motion has covered by then.
    const double travel =
        first + way * static_cast<double>(m) / static_cast<double>(motion.poses.size() - 1);
    double gap = std::numeric_limits<double>::infinity(), angle = 0;
    for (const Stretch& stretch : stretches) {
      if (stretch.distance(tool.translation()) > least + kAsNear) continue;
      const Shares near =
          places_near(stretch.start.translation(), stretch.along, tool.translation(), least);
      const double length = stretch.to - stretch.from,
                   u = std::clamp(length > 0 ? (travel - stretch.from) / length : 0, near.low,
                                  near.high),
                   off = std::abs(stretch.from + u * length - travel);
      if (off >= gap) continue;
      gap = off;
      angle = (rotation_between(stretch.start, tool) - u * stretch.turn).norm();
    }
    worst.position = std::max(worst.position, least);
    worst.angle = std::max(worst.angle, angle);
  }
  return worst;
}

}  // namespace swivel
