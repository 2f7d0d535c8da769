// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/problem/tool_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/problem/cubic_spline.hpp"

namespace swivel {

namespace {

constexpr double kMergedShare =
    0.5;  // of the tolerances, for what lies between the ends of segments that are made one
constexpr double kSame = 1e-9;  // m and rad: two poses nearer than that are one
/// How far a waypoint may lie from the straight segment between its neighbours, m and rad, so that
/// it is no corner. A row of a trajectory may be 1e-6 off the path (check.cpp): one that meets all
/// waypoints then passes.
constexpr PathSmoothing kCollinear{5e-7, 5e-7};

/// Axis times angle of the short arc from a to b, in a's frame.
Vector3d short_arc(const Quaterniond& a, const Quaterniond& b) {
  Quaterniond d = a.conjugate() * b;
  if (d.w() < 0) d.coeffs() = -d.coeffs();
  const double sine = d.vec().norm();
  if (sine < 1e-300) return Vector3d::Zero();
  return d.vec() * (2 * std::atan2(sine, d.w()) / sine);
}

/// Axis times angle of the turn from a to b, in a's frame: the short arc. A half turn of a tool
/// that is free to turn about its z axis, about that axis, is taken right-handed: either way the z
/// axis stands still. None of any other half turn.
std::optional<Vector3d> turn_between(const Quaterniond& a, const Quaterniond& b,
                                     bool turns_freely) {
  constexpr double kAboutZ =
      1e-6;  // sine of the angle between the axis of the turn and the tool's z axis
  const Vector3d turn = short_arc(a, b);
  const double angle = turn.norm();
  if (angle <= kPi - kSame) return turn;
  if (!turns_freely || turn.head<2>().norm() > kAboutZ * angle) return std::nullopt;
  return turn.z() < 0 ? -turn : turn;
}

/// Cuts 0 ... n - 1 into runs as long as they may be, one after the other: `fits(first, count)`
/// says whether `count` from `first` on may be one run. Calls `end(first, count)` for each run;
/// what is left over begins the next one. O(n log n) questions.
template <class Fits, class End>
void cut_into_runs(std::size_t n, const Fits& fits, const End& end) {
  for (std::size_t first = 0; first < n;) {
    const std::size_t all = n - first;
    std::size_t good = 1, bad = all + 1;  // so many go, and do not
    while (bad - good > 1) {
      const std::size_t count = bad > all ? std::min(2 * good, all) : (good + bad) / 2;
      (fits(first, count) ? good : bad) = count;
    }
    first = end(first, good);
  }
}

/// Whether the poses between the ends of some are within the tolerances of the straight segment
/// that joins the ends, each where its travel says. `travel` and `position`, `orientation` of pose
/// k; `turn`: from the first to the last, in the first one's frame.
template <class Travel, class Position, class Orientation>
bool straight_between(std::size_t first, std::size_t last, const Travel& travel,
                      const Position& position, const Orientation& orientation,
                      const Vector3d& turn, const PathSmoothing& within) {
  const double angle = turn.norm(), span = travel(last) - travel(first);
  const Vector3d begin = position(first), way = position(last) - begin;
  const Eigen::Matrix3d from = orientation(first);
  for (std::size_t k = first + 1; k < last; ++k) {
    const double t = (travel(k) - travel(first)) / span;
    if ((begin + t * way - position(k)).norm() > within.position) return false;
    Eigen::Matrix3d rotated = from;
    if (angle > 0)
      rotated = rotated * Eigen::AngleAxisd(t * angle, turn / angle).toRotationMatrix();
    if (Eigen::AngleAxisd(rotated.transpose() * orientation(k)).angle() > within.angle)
      return false;
  }
  return true;
}

/// Ends linear in between.
Roll between(const Roll& a, const Roll& b, double t) {
  const auto linear = [t](double x, double y) {
    return x == y ? x : x + t * (y - x);
  };  // also of infinite ends
  return {linear(a.lower, b.lower), linear(a.upper, b.upper)};
}

Quaterniond turned(const Quaterniond& a, const Vector3d& rotation, double t) {
  const double angle = rotation.norm();
  if (angle == 0) return a;
  return (a * Quaterniond(Eigen::AngleAxisd(t * angle, rotation / angle))).normalized();
}

}  // namespace

ToolPath::ToolPath(const std::vector<Waypoint>& waypoints, const Resolution& resolution,
                   const std::string& source, const Budget& budget,
                   const std::optional<PathSmoothing>& smooth, bool turns_freely) {
  constexpr double kMostLayers = 2e6;  // 1 mm over 2 km; each holds about 1 kB
  const auto pose = [](const Vector3d& p, const Quaterniond& q) {
    Pose X;
    X.linear() = q.toRotationMatrix();
    X.translation() = p;
    return X;
  };
  const auto travel_of = [&](double length, double angle) {
    return std::max(length, angle * resolution.ds / resolution.dalpha);
  };
  if (waypoints.empty()) throw InputError(source, "path: no waypoints: allowed are at least two");
  // The poses that differ, each with its row and with the travel up to it.
  struct Stop {
    Waypoint waypoint;
    int row = 0;
    double travel = 0;
  };
  std::vector<Stop> stops{{waypoints[0]}};
  for (std::size_t k = 1; k < waypoints.size(); ++k) {
    const Waypoint &from = stops.back().waypoint, &to = waypoints[k];
    const double length = (to.position - from.position).norm(),
                 angle = short_arc(from.orientation, to.orientation).norm();
    if (length <= kSame && angle <= kSame) {
      ++merged_;
      if (to.roll) {  // both hold
        std::optional<Roll>& window = stops.back().waypoint.roll;
        if (!window) window = PathLayer().window;
        window =
            Roll{std::max(window->lower, to.roll->lower), std::min(window->upper, to.roll->upper)};
        if (!(window->lower <= window->upper))
          throw InputError(source, "path: waypoints " + std::to_string(k - 1) + " and " +
                                       std::to_string(k) +
                                       " are one pose, but their rolls have nothing in common: "
                                       "allowed are roll_min and roll_max that overlap");
      }
      continue;
    }
    if (!turn_between(from.orientation, to.orientation, turns_freely))
      throw InputError(
          source, "path: waypoint " + std::to_string(k) +
                      ": turns by 180 deg from the one before: which way is undefined: allowed is "
                      "less, by a waypoint in "
                      "between; or, where it turns about the tool's z axis alone, path.roll: free");
    stops.push_back({to, static_cast<int>(k), stops.back().travel + travel_of(length, angle)});
  }
  // A waypoint with a window of its own bends what the roll may be, if not the path.
  const auto one_segment = [&](std::size_t first, std::size_t count) {
    if (waypoints[0].roll) return false;
    const auto turn = turn_between(stops[first].waypoint.orientation,
                                   stops[first + count].waypoint.orientation, turns_freely);
    return turn &&
           straight_between(
               first, first + count, [&](std::size_t k) { return stops[k].travel; },
               [&](std::size_t k) -> const Vector3d& { return stops[k].waypoint.position; },
               [&](std::size_t k) { return stops[k].waypoint.orientation.toRotationMatrix(); },
               *turn, kCollinear);
  };
  const auto window_of = [](const Waypoint& waypoint) {
    return waypoint.roll.value_or(PathLayer().window);
  };
  layers_.push_back(
      {0.0, pose(waypoints[0].position, waypoints[0].orientation), 0, 0, 0, Vector3d::Zero()});
  layers_.back().window = window_of(stops[0].waypoint);
  waypoints_.push_back({0, 0});
  double s = 0;
  cut_into_runs(stops.size() - 1, one_segment, [&](std::size_t first, std::size_t count) {
    const Waypoint &from = stops[first].waypoint, &to = stops[first + count].waypoint;
    const double length = (to.position - from.position).norm();
    const Vector3d rotation = *turn_between(from.orientation, to.orientation, turns_freely);
    const double angle = rotation.norm();
    const double wanted = std::max({1.0, std::ceil(length / resolution.ds - 1e-9),
                                    std::ceil(angle / resolution.dalpha - 1e-9)});
    if (static_cast<double>(layers_.size()) + wanted > kMostLayers)
      throw InputError(source,
                       "resolution.ds: " + formatted("%.9g", resolution.ds) +
                           " cuts the path into more than 2e6 layers: allowed are larger steps");
    const int steps = static_cast<int>(wanted);
    const double begun = layers_.back().travel, travel = travel_of(length, angle);
    segments_.push_back({static_cast<int>(layers_.size()) - 1, begun, layers_.back().tool,
                         (to.position - from.position) / travel, rotation / travel, 0});
    for (int step = 1; step <= steps; ++step) {
      if (layers_.size() % 1024 == 0) budget.poll();
      PathLayer& previous = layers_.back();
      previous.step_length = length / steps;
      previous.step_angle = angle / steps;
      previous.step_rotation = rotation / steps;
      const double t = static_cast<double>(step) / steps;
      if (step == steps)
        layers_.push_back({s + length, pose(to.position, to.orientation), stops[first + count].row,
                           0, 0, Vector3d::Zero()});
      else
        layers_.push_back({s + t * length,
                           pose(from.position + t * (to.position - from.position),
                                turned(from.orientation, rotation, t)),
                           -1, 0, 0, Vector3d::Zero()});
      layers_.back().travel = begun + t * travel;
    }
    layers_.back().window = window_of(to);
    for (std::size_t k = first + 1; k <= first + count; ++k) {
      const double share = (stops[k].travel - stops[first].travel) /
                           (stops[first + count].travel - stops[first].travel);
      waypoints_.push_back({begun + share * travel, stops[k].row});
    }
    s += length;
    return first + count;
  });
  if (waypoints[0].roll) spread_windows();
  if (layers_.size() < 2)
    throw InputError(source,
                     "path: all waypoints are one pose: allowed are at least two distinct ones");
  if (smooth) {
    // Where waypoints are dense, corners have no room to be rounded: several segments are made one.
    std::vector<Segment> merged;
    const std::size_t n = segments_.size();
    const auto travel = [&](std::size_t k) {
      return k < n ? segments_[k].travel : layers_.back().travel;
    };
    const auto pose_of = [&](std::size_t k) -> const Pose& {
      return k < n ? segments_[k].start : layers_.back().tool;
    };
    // Straight over `count` segments; none where a waypoint between is too far from it.
    const auto straight = [&](std::size_t first, std::size_t count) -> std::optional<Segment> {
      const auto orientation = [&](std::size_t k) -> Eigen::Matrix3d {
        return pose_of(k).linear();
      };
      const auto position = [&](std::size_t k) -> Vector3d { return pose_of(k).translation(); };
      const auto turn = turn_between(Quaterniond(orientation(first)),
                                     Quaterniond(orientation(first + count)), turns_freely);
      const PathSmoothing within{kMergedShare * smooth->position, kMergedShare * smooth->angle};
      if (!turn ||
          !straight_between(first, first + count, travel, position, orientation, *turn, within))
        return std::nullopt;
      Segment segment = segments_[first];
      const double span = travel(first + count) - segment.travel;
      segment.velocity = (position(first + count) - position(first)) / span;
      segment.rotation = *turn / span;
      segment.merged = count > 1;
      return segment;
    };
    std::vector<std::size_t> begins;  // the first of those that each is made of
    const auto fits = [&](std::size_t first, std::size_t count) {
      return straight(first, count).has_value();
    };
    cut_into_runs(n, fits, [&](std::size_t first, std::size_t count) {
      budget.poll();
      merged.push_back(count > 1 ? *straight(first, count) : segments_[first]);
      begins.push_back(first);
      first += count;
      // What is left over, before a corner or the end, may be so short that there would be no room
      // beside it: halves of both.
      const std::size_t before = begins.size() < 2 ? first : begins[begins.size() - 2],
                        middle = (before + first) / 2;
      if (before == first || 2 * (first - begins.back()) >= begins.back() - before) return first;
      const auto one = straight(before, middle - before), other = straight(middle, first - middle);
      if (!one || !other) return first;
      *(merged.end() - 2) = *one;
      merged.back() = *other;
      begins.back() = middle;
      return first;
    });
    rounded_ = merged.size() < n;
    segments_.swap(merged);
  }
  rounding_ = smooth ? smooth->angle : 0;
  find_corners(smooth.value_or(PathSmoothing{0, 0}));
}

void ToolPath::find_corners(const PathSmoothing& smooth) {
  constexpr double kStraight = 1e-9;  // change of velocity that is none: m and rad per metre
  constexpr double kShortest =
      0.05e-3;  // m; a corner rounded over less is one that the tool stops at
  constexpr double kDeviation =
      3. / 16;  // of reach |b - a|: the integral of the velocity's change up to the corner
  for (std::size_t k = 1; k < segments_.size(); ++k) {
    const Segment& before = segments_[k - 1];
    Segment& after = segments_[k];
    const double end = k + 1 < segments_.size() ? segments_[k + 1].travel : layers_.back().travel;
    const double bend = (after.velocity - before.velocity).norm(),
                 twist = (after.rotation - before.rotation).norm();
    if (bend <= kStraight && twist <= kStraight) continue;
    const double share = before.merged || after.merged ? 1 - kMergedShare : 1;
    double reach = 0.5 * std::min(after.travel - before.travel, end - after.travel);
    if (bend > kStraight) reach = std::min(reach, share * smooth.position / (kDeviation * bend));
    if (twist > kStraight) reach = std::min(reach, share * smooth.angle / (kDeviation * twist));
    if (reach < kShortest) reach = 0;
    after.reach = reach;
    rounded_ = rounded_ || reach > 0;
    corners_.push_back({after.layer, reach, kDeviation * reach * bend, kDeviation * reach * twist});
  }
  if (!rounded_) return;
  for (std::size_t k = 0; k < segments_.size(); ++k)
    for (int i = segments_[k].layer;
         i < (k + 1 < segments_.size() ? segments_[k + 1].layer : size()); ++i)
      layers_[static_cast<std::size_t>(i)].tool = on_curve(k, layer(i).travel);
}

std::size_t ToolPath::segment_of(int step) const {
  const auto after =
      std::upper_bound(segments_.begin(), segments_.end(), step,
                       [](int layer, const Segment& segment) { return layer < segment.layer; });
  return static_cast<std::size_t>(after - segments_.begin()) - 1;
}

std::array<int, 2> ToolPath::waypoints_along(double from, double to) const {
  const double first = std::max(from, layers_.front().travel) - kSame, last = to + kSame;
  std::array<int, 2> rows{-1, -1};
  const auto begin =
      std::lower_bound(waypoints_.begin(), waypoints_.end(), first,
                       [](const Place& place, double travel) { return place.travel < travel; });
  const auto end =
      std::upper_bound(begin, waypoints_.end(), last,
                       [](double travel, const Place& place) { return travel < place.travel; });
  if (begin != end) rows = {begin->row, (end - 1)->row};
  return rows;
}

int ToolPath::step_at(double travel) const {
  const auto after =
      std::upper_bound(layers_.begin() + 1, layers_.end() - 1, travel,
                       [](double value, const PathLayer& layer) { return value < layer.travel; });
  return static_cast<int>(after - layers_.begin()) - 1;
}

/// From waypoints to the layers in between.
void ToolPath::spread_windows() {
  for (std::size_t a = 0, b = 1; b < layers_.size(); ++b) {
    if (layers_[b].waypoint < 0) continue;
    for (std::size_t i = a + 1; i < b; ++i)
      layers_[i].window = between(
          layers_[a].window, layers_[b].window,
          (layers_[i].travel - layers_[a].travel) / (layers_[b].travel - layers_[a].travel));
    a = b;
  }
}

std::vector<double> ToolPath::shares() const {
  std::vector<double> shares(layers_.size(), 0.0);
  for (std::size_t i = 0; i + 1 < layers_.size(); ++i) {
    const double half = (layers_[i + 1].s - layers_[i].s) / 2;
    shares[i] += half;
    shares[i + 1] += half;
  }
  return shares;
}

Roll ToolPath::window_at(double travel) const {
  const PathLayer &from = layer(step_at(travel)), &to = layer(step_at(travel) + 1);
  return between(from.window, to.window,
                 std::clamp((travel - from.travel) / (to.travel - from.travel), 0.0, 1.0));
}

double ToolPath::roll_at(double travel) const {
  return unturned_ ? roll_->at(travel) : 0;
}

Pose ToolPath::at_travel(double travel) const {
  if (unturned_) return rolled(unturned_->at_travel(travel), roll_at(travel));
  return on_curve(segment_of(step_at(travel)), travel);
}

Pose ToolPath::on_curve(std::size_t k, double travel) const {
  const Segment* base = &segments_[k];
  if (k + 1 < segments_.size() && segments_[k + 1].travel - travel < segments_[k + 1].reach)
    base = &segments_[++k];
  const double x = travel - base->travel;
  Vector3d way = x * base->velocity, turn = x * base->rotation;
  if (base->reach > 0 && x < base->reach) {
    const Segment& before = segments_[k - 1];
    const double z = std::max(0.0, (x + base->reach) / (2 * base->reach));
    const double part = 2 * base->reach * z * z * z * (1 - z / 2);
    way = x * before.velocity + part * (base->velocity - before.velocity);
    turn = x * before.rotation + part * (base->rotation - before.rotation);
  }
  Pose X;
  X.translation() = base->start.translation() + way;
  X.linear() = base->start.linear();
  const double angle = turn.norm();
  if (angle > 0)
    X.linear() = base->start.linear() * Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  return X;
}

void ToolPath::begin_at(std::optional<double> start_at, const Pose& tool, double tolerance,
                        const std::string& source) {
  constexpr double kOnLayer = 1e-6;  // m and rad
  const double s = start_at.value_or(0), length = layers_.back().s;
  const auto refuse = [&] {
    const std::string text =
        formatted("start_at: is %.9g m: allowed is from 0 to before the end of the path, at %.9g m",
                  s, length);
    throw InputError(source, text);
  };
  if (!(s >= 0 && s <= length + kOnLayer)) refuse();
  const auto gap = [&](const Pose& pose) {
    return std::max((pose.translation() - tool.translation()).norm(),
                    Eigen::AngleAxisd(pose.linear().transpose() * tool.linear()).angle());
  };
  // The place: on step `first`, by a share `t` of it.
  int first = 0;
  double t = 0, least = std::numeric_limits<double>::infinity();
  const auto try_place = [&](int step, double share) {
    const double distance = gap(share > 0 ? at(step, share) : layer(step).tool);
    if (!(distance < least - 1e-9)) return;
    first = step, t = share, least = distance;
  };
  if (!start_at) try_place(0, 0);
  for (int i = 0; start_at && i < size() && least > kOnLayer; ++i)
    if (std::abs(layer(i).s - s) <= kOnLayer) try_place(i, 0);
  for (int i = 0; start_at && i + 1 < size() && least > kOnLayer; ++i) {
    const PathLayer& step = layer(i);
    if (step.s > s + kOnLayer || layer(i + 1).s < s - kOnLayer) continue;
    const double turned = Eigen::AngleAxisd(step.tool.linear().transpose() * tool.linear()).angle();
    const double share =
        step.step_length > kOnLayer ? (s - step.s) / step.step_length : turned / step.step_angle;
    if (share > 0 && share < 1) try_place(i, share);
  }
  if (first + 1 >= size()) refuse();

  const bool aside = least > kOnLayer && least <= tolerance;
  for (int i = 0; i < first; ++i) before_.push_back(layer(i).tool);
  if (t > 0 || aside) {
    before_.push_back(layer(first).tool);
    begins_on_layer_ = false;
    PathLayer start = layer(first);
    if (t > 0) {
      start.s = s;
      start.waypoint = -1;
    }
    start.tool = aside ? tool : at(first, t);
    const PathLayer& next = layer(first + 1);
    start.window = between(start.window, next.window, t);
    start.travel += t * (next.travel - start.travel);
    begins_aside_ = aside;
    start.step_length = (next.tool.translation() - start.tool.translation()).norm();
    start.step_rotation =
        short_arc(Quaterniond(start.tool.linear()), Quaterniond(next.tool.linear()));
    start.step_angle = start.step_rotation.norm();
    layers_[static_cast<std::size_t>(first)] = start;
  }
  layers_.erase(layers_.begin(), layers_.begin() + first);
  for (Segment& segment : segments_) segment.layer -= first;
  for (Corner& corner : corners_) corner.layer -= first;
  std::erase_if(corners_, [](const Corner& corner) { return corner.layer <= 0; });
}

ToolPath ToolPath::with_layers(const std::vector<int>& kept) const {
  ToolPath path = *this;
  path.segments_.clear();
  path.corners_.clear();
  path.rounded_ = path.begins_aside_ = false;
  path.layers_.clear();
  for (std::size_t k = 0; k < kept.size(); ++k) {
    PathLayer& own = path.layers_.emplace_back(layer(kept[k]));
    own.step_length = own.step_angle = 0;
    for (int i = kept[k]; k + 1 < kept.size() && i < kept[k + 1]; ++i) {
      own.step_length += layer(i).step_length;
      own.step_angle += layer(i).step_angle;
    }
    own.step_rotation.setZero();
  }
  return path;
}

ToolPath ToolPath::with_rolls(const std::vector<double>& rolls) const {
  ToolPath path = *this;
  for (std::size_t i = 0; i < path.layers_.size(); ++i)
    path.layers_[i].tool = rolled(path.layers_[i].tool, rolls[i]);
  path.unturned_ = std::make_shared<const ToolPath>(*this);
  std::vector<double> travels;
  for (const PathLayer& layer : layers_) travels.push_back(layer.travel);
  path.roll_ = std::make_shared<const CubicSpline>(std::move(travels), rolls);
  return path;
}

Pose rolled(const Pose& pose, double roll) {
  Pose turned = pose;
  turned.linear() = pose.linear() * Eigen::AngleAxisd(roll, Vector3d::UnitZ()).toRotationMatrix();
  return turned;
}

double roll_between(const Pose& pose, const Pose& tool) {
  const Matrix3d R = pose.linear().transpose() * tool.linear();
  return std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
}

Pose ToolPath::at(int i, double t) const {
  if (unturned_)
    return rolled(unturned_->at(i, t),
                  roll_at(layer(i).travel + t * (layer(i + 1).travel - layer(i).travel)));
  const PathLayer& from = layer(i);
  const PathLayer& to = layer(i + 1);
  if (rounded_ && !(begins_aside_ && i == 0))
    return on_curve(segment_of(i), from.travel + t * (to.travel - from.travel));
  Pose X;
  X.translation() = from.tool.translation() + t * (to.tool.translation() - from.tool.translation());
  X.linear() = from.tool.linear();
  if (from.step_angle > 0)
    X.linear() = from.tool.linear() *
                 Eigen::AngleAxisd(t * from.step_angle, from.step_rotation / from.step_angle)
                     .toRotationMatrix();
  return X;
}

}  // namespace swivel
