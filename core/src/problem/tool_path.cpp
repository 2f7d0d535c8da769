// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/problem/tool_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/base/cubic_spline.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

namespace {

/// Share of the tolerances for what lies between the ends of segments that are made one.
constexpr double kMergedShare = 0.5;
constexpr double kSame = 1e-9;  // m and rad: two poses nearer than that are one
/// How far a waypoint may lie from the straight segment between its neighbours, m and rad, and be
/// no corner. A row of a trajectory may be 1e-6 off the path (check.cpp), so that a trajectory
/// which meets all waypoints passes.
constexpr PathSmoothing kCollinear{5e-7, 5e-7};
constexpr double kOnLayer = 1e-6;  // m and rad: a place this near to a layer is that layer
/// Share of the step from a start beside the path over which the tool bends into the path, on both
/// sides of where the straight line to the path meets it.
constexpr double kJoining = 1. / 8;

/// Returns axis times angle, rad, of the short arc from a to b, in a's frame.
Vector3d short_arc(const Quaterniond& a, const Quaterniond& b) {
  Quaterniond d = a.conjugate() * b;
  if (d.w() < 0) d.coeffs() = -d.coeffs();
  const double sine = d.vec().norm();
  if (sine < 1e-300) return Vector3d::Zero();
  return d.vec() * (2 * std::atan2(sine, d.w()) / sine);
}

/// Returns axis times angle, rad, of the turn from a to b, in a's frame: the short arc. A tool that
/// is free to turn about its z axis makes a half turn about that axis right-handed: either way the
/// z axis stands still. Returns nothing for any other half turn.
std::optional<Vector3d> turn_between(const Quaterniond& a, const Quaterniond& b,
                                     bool turns_freely) {
  // the largest sine of the angle between the axis of the turn and the tool's z axis
  constexpr double kAboutZ = 1e-6;
  const Vector3d turn = short_arc(a, b);
  const double angle = turn.norm();
  if (angle <= kPi - kSame) return turn;
  if (!turns_freely || turn.head<2>().norm() > kAboutZ * angle) return std::nullopt;
  return turn.z() < 0 ? -turn : turn;
}

/// Cuts 0 ... n - 1 into runs as long as they may be, one after the other: `fits(first, count)`
/// says whether `count` from `first` on may be one run. Calls `end(first, count)` for each run,
/// which returns where the next one begins. Asks O(n log n) questions.
template <class Fits, class End>
void cut_into_runs(std::size_t n, const Fits& fits, const End& end) {
  for (std::size_t first = 0; first < n;) {
    const std::size_t all = n - first;
    std::size_t good = 1, bad = all + 1;  // the most that fit, and the fewest that do not
    while (bad - good > 1) {
      const std::size_t count = bad > all ? std::min(2 * good, all) : (good + bad) / 2;
      (fits(first, count) ? good : bad) = count;
    }
    first = end(first, good);
  }
}

/// Returns true if the poses between pose `first` and pose `last` are within tolerances of the
/// straight segment that joins these two, each where its travel says. `travel`, `position` and
/// `orientation` return those of pose k; `turn` is the turn from the first to the last, rad, in the
/// first one's frame.
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

/// Returns the range whose ends are linear between those of a (t = 0) and b (t = 1).
Roll between(const Roll& a, const Roll& b, double t) {
  const auto linear = [t](double x, double y) {
    return x == y ? x : x + t * (y - x);  // equal ends may be infinite
  };
  return {linear(a.lower, b.lower), linear(a.upper, b.upper)};
}

/// Returns orientation a turned by a share t of a rotation (axis times angle, rad, in a's frame).
Quaterniond turned(const Quaterniond& a, const Vector3d& rotation, double t) {
  const double angle = rotation.norm();
  if (angle == 0) return a;
  return (a * Quaterniond(Eigen::AngleAxisd(t * angle, rotation / angle))).normalized();
}

/// A waypoint whose pose differs from the one before: its row in the list of waypoints, and the
/// travel up to it, m.
struct Stop {
  Waypoint waypoint;
  int row = 0;
  double travel = 0;
};

/// Returns the travel, m, of a way of a length (m) and an angle (rad): what takes more layers
/// counts.
double travel_of(double length, double angle, const Resolution& resolution) {
  return std::max(length, angle * resolution.ds / resolution.dalpha);
}

Pose pose_of(const Vector3d& position, const Quaterniond& orientation) {
  Pose X;
  X.linear() = orientation.toRotationMatrix();
  X.translation() = position;
  return X;
}

Roll window_of(const Waypoint& waypoint) {
  return waypoint.roll.value_or(PathLayer().window);
}

/// Narrows the window of a stop to what waypoint `row`, which has the same pose, allows as well.
/// Throws InputError where the two windows have no roll in common.
void narrow_window(std::optional<Roll>& window, const Roll& other, std::size_t row,
                   const std::string& source) {
  if (!window) window = PathLayer().window;
  window = Roll{std::max(window->lower, other.lower), std::min(window->upper, other.upper)};
  if (!(window->lower <= window->upper))
    throw InputError(source, "path: waypoints " + std::to_string(row - 1) + " and " +
                                 std::to_string(row) +
                                 " are one pose, but their rolls have nothing in common: "
                                 "allowed are roll_min and roll_max that overlap");
}

/// Lists the waypoints whose poses differ; counts the others in `merged`. Throws InputError where
/// the tool would turn by 180 deg to a waypoint, or windows of one pose have no roll in common.
std::vector<Stop> stops_of(const std::vector<Waypoint>& waypoints, const Resolution& resolution,
                           const std::string& source, bool turns_freely, int& merged) {
  std::vector<Stop> stops{{waypoints[0]}};
  for (std::size_t k = 1; k < waypoints.size(); ++k) {
    const Waypoint &from = stops.back().waypoint, &to = waypoints[k];
    const double length = (to.position - from.position).norm(),
                 angle = short_arc(from.orientation, to.orientation).norm();
    if (length <= kSame && angle <= kSame) {
      ++merged;
      if (to.roll) narrow_window(stops.back().waypoint.roll, *to.roll, k, source);
      continue;
    }
    if (!turn_between(from.orientation, to.orientation, turns_freely))
      throw InputError(
          source, "path: waypoint " + std::to_string(k) +
                      ": turns by 180 deg from the one before: which way is undefined: allowed is "
                      "less, by a waypoint in "
                      "between; or, where it turns about the tool's z axis alone, path.roll: free");
    stops.push_back(
        {to, static_cast<int>(k), stops.back().travel + travel_of(length, angle, resolution)});
  }
  return stops;
}

/// Throws InputError where two neighbouring waypoints are one pose, so that a stop stands for both.
void require_distinct(const std::vector<Stop>& stops, std::size_t waypoints,
                      const std::string& source) {
  std::size_t k = 1;
  while (k < stops.size() && stops[k].row == static_cast<int>(k)) ++k;
  if (k < waypoints)
    throw InputError(source, "path: waypoint " + std::to_string(k) +
                                 " is where the one before it is: allowed are waypoints at which "
                                 "the tool is elsewhere than at the one before, since the path is "
                                 "cut into given steps");
}

/// Returns true if the stops between `first` and `last` are no corners: one straight segment leads
/// through all of them.
bool one_segment(const std::vector<Stop>& stops, std::size_t first, std::size_t last,
                 bool turns_freely) {
  const auto turn = turn_between(stops[first].waypoint.orientation,
                                 stops[last].waypoint.orientation, turns_freely);
  return turn &&
         straight_between(
             first, last, [&](std::size_t k) { return stops[k].travel; },
             [&](std::size_t k) -> const Vector3d& { return stops[k].waypoint.position; },
             [&](std::size_t k) { return stops[k].waypoint.orientation.toRotationMatrix(); }, *turn,
             kCollinear);
}

/// The way of a straight segment: its length, m, its turn in the frame of its first pose, and the
/// angle of that turn, rad.
struct Way {
  double length = 0;
  Vector3d rotation = Vector3d::Zero();
  double angle = 0;
  Way(const Waypoint& from, const Waypoint& to, bool turns_freely)
      : length((to.position - from.position).norm()),
        rotation(*turn_between(from.orientation, to.orientation, turns_freely)),
        angle(rotation.norm()) {}
};

/// Returns into how many steps the resolution cuts a segment, at least one. Throws InputError where
/// the path, which has `layers` layers before it, would have too many.
int steps_of(const Way& way, const Resolution& resolution, std::size_t layers,
             const std::string& source) {
  constexpr double kMostLayers = 2e6;  // 1 mm over 2 km; each holds about 1 kB
  const double wanted = std::max({1.0, std::ceil(way.length / resolution.ds - 1e-9),
                                  std::ceil(way.angle / resolution.dalpha - 1e-9)});
  if (static_cast<double>(layers) + wanted > kMostLayers)
    throw InputError(source,
                     "resolution.ds: " + formatted("%.9g", resolution.ds) +
                         " cuts the path into more than 2e6 layers: allowed are larger steps");
  return static_cast<int>(wanted);
}

/// Appends the layers of a straight segment of `travel` m, which begins at the last layer and is
/// cut into `steps` steps. Its last layer is the stop `to`.
void append_layers(const Waypoint& from, const Stop& to, const Way& way, double travel, int steps,
                   const Budget& budget, std::vector<PathLayer>& layers) {
  const double s = layers.back().s, begun = layers.back().travel;
  for (int step = 1; step <= steps; ++step) {
    if (layers.size() % 1024 == 0) budget.poll();
    PathLayer& previous = layers.back();
    previous.step_length = way.length / steps;
    previous.step_angle = way.angle / steps;
    previous.step_rotation = way.rotation / steps;
    const double t = static_cast<double>(step) / steps;
    if (step == steps)
      layers.push_back({s + way.length, pose_of(to.waypoint.position, to.waypoint.orientation),
                        to.row, 0, 0, Vector3d::Zero()});
    else
      layers.push_back({s + t * way.length,
                        pose_of(from.position + t * (to.waypoint.position - from.position),
                                turned(from.orientation, way.rotation, t)),
                        -1, 0, 0, Vector3d::Zero()});
    layers.back().travel = begun + t * travel;
  }
  layers.back().window = window_of(to.waypoint);
}

/// Makes several segments one where a straight segment keeps to their poses within the tolerances:
/// where waypoints are dense, corners have no room to be rounded.
template <class Segment>
class SegmentMerger {
 public:
  /// Takes the segments of a path and its last layer.
  SegmentMerger(const std::vector<Segment>& segments, const PathLayer& last,
                const PathSmoothing& smooth, bool turns_freely)
      : segments_(segments),
        last_(last),
        within_{kMergedShare * smooth.position, kMergedShare * smooth.angle},
        turns_freely_(turns_freely) {}

  /// Returns the segments, merged in the order of the path. Throws Stopped.
  std::vector<Segment> merge(const Budget& budget) {
    cut_into_runs(
        segments_.size(),
        [&](std::size_t first, std::size_t count) { return straight(first, count).has_value(); },
        [&](std::size_t first, std::size_t count) {
          budget.poll();
          merged_.push_back(count > 1 ? *straight(first, count) : segments_[first]);
          begins_.push_back(first);
          share_with_short_rest(first + count);
          return first + count;
        });
    return std::move(merged_);
  }

 private:
  [[nodiscard]] double travel(std::size_t k) const {
    return k < segments_.size() ? segments_[k].travel : last_.travel;
  }
  [[nodiscard]] const Pose& pose(std::size_t k) const {
    return k < segments_.size() ? segments_[k].start : last_.tool;
  }

  /// Returns the straight segment in the place of `count` ones; none where a waypoint between is
  /// too far from it.
  [[nodiscard]] std::optional<Segment> straight(std::size_t first, std::size_t count) const {
    const auto orientation = [&](std::size_t k) -> Eigen::Matrix3d { return pose(k).linear(); };
    const auto position = [&](std::size_t k) -> Vector3d { return pose(k).translation(); };
    const auto turn = turn_between(Quaterniond(orientation(first)),
                                   Quaterniond(orientation(first + count)), turns_freely_);
    if (!turn || !straight_between(
                     first, first + count, [&](std::size_t k) { return travel(k); }, position,
                     orientation, *turn, within_))
      return std::nullopt;
    Segment segment = segments_[first];
    const double span = travel(first + count) - segment.travel;
    segment.velocity = (position(first + count) - position(first)) / span;
    segment.rotation = *turn / span;
    segment.merged = count > 1;
    return segment;
  }

  /// Divides the last two merged segments anew, in halves, where the last, which ends before
  /// segment `end`, is short: a corner beside it would have no room.
  void share_with_short_rest(std::size_t end) {
    const std::size_t before = begins_.size() < 2 ? end : begins_[begins_.size() - 2],
                      middle = (before + end) / 2;
    if (before == end || 2 * (end - begins_.back()) >= begins_.back() - before) return;
    const auto one = straight(before, middle - before), other = straight(middle, end - middle);
    if (!one || !other) return;
    *(merged_.end() - 2) = *one;
    merged_.back() = *other;
    begins_.back() = middle;
  }

  const std::vector<Segment>& segments_;
  const PathLayer& last_;
  PathSmoothing within_;
  bool turns_freely_;
  std::vector<Segment> merged_;
  std::vector<std::size_t> begins_;  // the first segment that each merged one is made of
};

/// A place on a path: on the step that starts at layer `step`, by a share of it from 0 to below 1;
/// and how far the tool is from there, m or rad, whichever is more.
struct PlaceOnPath {
  int step = 0;
  double share = 0;
  double gap = std::numeric_limits<double>::infinity();
};

/// Returns the place from which on a path is kept: at s = `start_at` (m), where the path only turns
/// there the place that comes nearest to the pose `tool`, the first of those as near; without
/// `start_at` layer 0.
PlaceOnPath start_on(const ToolPath& path, std::optional<double> start_at, const Pose& tool) {
  PlaceOnPath nearest;
  const auto try_place = [&](int step, double share) {
    const Pose pose = share > 0 ? path.at(step, share) : path.layer(step).tool;
    const double gap =
        std::max((pose.translation() - tool.translation()).norm(),
                 Eigen::AngleAxisd(pose.linear().transpose() * tool.linear()).angle());
    if (gap < nearest.gap - 1e-9) nearest = {step, share, gap};
  };
  if (!start_at) {
    try_place(0, 0);
    return nearest;
  }
  const double s = *start_at;
  for (int i = 0; i < path.size() && nearest.gap > kOnLayer; ++i)
    if (std::abs(path.layer(i).s - s) <= kOnLayer) try_place(i, 0);
  for (int i = 0; i + 1 < path.size() && nearest.gap > kOnLayer; ++i) {
    const PathLayer& step = path.layer(i);
    if (step.s > s + kOnLayer || path.layer(i + 1).s < s - kOnLayer) continue;
    const double turned = Eigen::AngleAxisd(step.tool.linear().transpose() * tool.linear()).angle();
    const double share =
        step.step_length > kOnLayer ? (s - step.s) / step.step_length : turned / step.step_angle;
    if (share > 0 && share < 1) try_place(i, share);
  }
  return nearest;
}

/// Returns the least travel, m, of a step between two poses: as much as the tool's way, and enough
/// for its turn.
double travel_between(const Pose& from, const Pose& to) {
  constexpr double kPerTurn = 0.05;  // m per rad, as of the default resolution
  return std::max((to.translation() - from.translation()).norm(),
                  kPerTurn * Eigen::AngleAxisd(from.linear().transpose() * to.linear()).angle());
}

/// Returns which part of its distance from the path a tool that began beside it still has at a
/// share t of the first step: from 1 it falls in a straight line, is rounded over the last 2
/// kJoining of the step as corners are, and ends at 0.
double part_beside(double t) {
  constexpr double kSlope = 1 / (1 - kJoining);
  const double y = (t - (1 - 2 * kJoining)) / (2 * kJoining);
  if (y <= 0) return 1 - kSlope * t;
  if (y >= 1) return 0;
  return 2 * kJoining * kSlope * (0.5 - y + y * y * y * (1 - y / 2));
}

/// Returns a layer at s (m) and a share t of the step between two layers, where the tool stands at
/// the pose `tool`. For t = 0 that is the first of the two layers, with another pose.
PathLayer layer_within_step(const PathLayer& from, const PathLayer& to, double s, double t,
                            const Pose& tool) {
  PathLayer layer = from;
  if (t > 0) {
    layer.s = s;
    layer.waypoint = -1;
  }
  layer.tool = tool;
  layer.window = between(from.window, to.window, t);
  layer.travel += t * (to.travel - from.travel);
  layer.step_length = (to.tool.translation() - tool.translation()).norm();
  layer.step_rotation = short_arc(Quaterniond(tool.linear()), Quaterniond(to.tool.linear()));
  layer.step_angle = layer.step_rotation.norm();
  return layer;
}

}  // namespace

ToolPath::ToolPath(const std::vector<Waypoint>& waypoints, const Resolution& resolution,
                   const std::string& source, const Budget& budget,
                   const std::optional<PathSmoothing>& smooth, bool turns_freely,
                   const std::vector<int>& given_steps) {
  if (waypoints.empty()) throw InputError(source, "path: no waypoints: allowed are at least two");
  // A waypoint with a window of its own bends what the roll may be, if not the path.
  const bool windows = waypoints[0].roll.has_value();
  const std::vector<Stop> stops = stops_of(waypoints, resolution, source, turns_freely, merged_);
  if (!given_steps.empty()) require_distinct(stops, waypoints.size(), source);
  const auto fits = [&](std::size_t first, std::size_t count) {
    return !windows && given_steps.empty() &&
           one_segment(stops, first, first + count, turns_freely);
  };
  layers_.push_back(
      {0.0, pose_of(waypoints[0].position, waypoints[0].orientation), 0, 0, 0, Vector3d::Zero()});
  layers_.back().window = window_of(stops[0].waypoint);
  waypoints_.push_back({0, 0});
  cut_into_runs(stops.size() - 1, fits, [&](std::size_t first, std::size_t count) {
    const Stop &from = stops[first], &to = stops[first + count];
    const Way way(from.waypoint, to.waypoint, turns_freely);
    const int steps = given_steps.empty() ? steps_of(way, resolution, layers_.size(), source)
                                          : given_steps[first];
    const double begun = layers_.back().travel,
                 travel = travel_of(way.length, way.angle, resolution);
    segments_.push_back({static_cast<int>(layers_.size()) - 1, begun, layers_.back().tool,
                         (to.waypoint.position - from.waypoint.position) / travel,
                         way.rotation / travel, 0});
    append_layers(from.waypoint, to, way, travel, steps, budget, layers_);
    for (std::size_t k = first + 1; k <= first + count; ++k) {
      const double share = (stops[k].travel - from.travel) / (to.travel - from.travel);
      waypoints_.push_back({begun + share * travel, stops[k].row});
    }
    return first + count;
  });
  if (windows) spread_windows();
  if (layers_.size() < 2)
    throw InputError(source,
                     "path: all waypoints are one pose: allowed are at least two distinct ones");
  if (smooth) {
    auto merged = SegmentMerger(segments_, layers_.back(), *smooth, turns_freely).merge(budget);
    rounded_ = merged.size() < segments_.size();
    segments_.swap(merged);
  }
  rounding_ = smooth ? smooth->angle : 0;
  find_corners(smooth.value_or(PathSmoothing{0, 0}));
}

std::vector<int> steps_between(const std::vector<Waypoint>& waypoints, const Resolution& resolution,
                               const std::string& source, bool turns_freely) {
  int merged = 0;
  const std::vector<Stop> stops = stops_of(waypoints, resolution, source, turns_freely, merged);
  std::vector<int> steps(waypoints.empty() ? 0 : waypoints.size() - 1, 1);
  std::size_t layers = 1;
  for (std::size_t k = 1; k < stops.size(); ++k) {
    const Way way(stops[k - 1].waypoint, stops[k].waypoint, turns_freely);
    const int count = steps_of(way, resolution, layers, source);
    steps[static_cast<std::size_t>(stops[k].row) - 1] = count;
    layers += static_cast<std::size_t>(count);
  }
  return steps;
}

void ToolPath::find_corners(const PathSmoothing& smooth) {
  constexpr double kStraight = 1e-9;  // change of velocity that is none: m and rad per metre
  // m; the tool stops at a corner that would be rounded over less
  constexpr double kShortest = 0.05e-3;
  // share of reach |b - a| by which the curve leaves the corner: the integral of the velocity's
  // change up to it
  constexpr double kDeviation = 3. / 16;
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
  auto begin =
      std::lower_bound(waypoints_.begin(), waypoints_.end(), first,
                       [](const Place& place, double travel) { return place.travel < travel; });
  auto end = std::upper_bound(begin, waypoints_.end(), last, [](double travel, const Place& place) {
    return travel < place.travel;
  });
  const auto given = [](const Place& place) { return place.row >= 0; };
  begin = std::find_if(begin, end, given);
  while (end != begin && !given(*(end - 1))) --end;
  if (begin != end) rows = {begin->row, (end - 1)->row};
  return rows;
}

int ToolPath::step_at(double travel) const {
  const auto after =
      std::upper_bound(layers_.begin() + 1, layers_.end() - 1, travel,
                       [](double value, const PathLayer& layer) { return value < layer.travel; });
  return static_cast<int>(after - layers_.begin()) - 1;
}

/// Sets the windows of the layers between waypoints: their ends are linear in between.
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
  if (const double begin = layer(0).travel, end = layer(1).travel; begins_aside_ && travel < end)
    return at(0, (travel - begin) / (end - begin));
  return twisted(on_curve(segment_of(step_at(travel)), travel), travel);
}

Pose ToolPath::twisted(const Pose& pose, double travel) const {
  return twist_ == 0 ? pose : rolled(pose, twist_ * travel);
}

void ToolPath::set_waypoint_turns(const std::vector<double>& angles) {
  constexpr double kHalfTurn = kPi - 1e-9;  // rad, by rounding
  constexpr double kNone = 1e-12;           // rad, rounding
  double before = 0;
  turned_waypoints_ = false;
  for (Place& place : waypoints_) {
    const double change =
        wrap_angle(angles[static_cast<std::size_t>(place.row)] - twist_ * place.travel - before);
    place.turn = before += change < -kHalfTurn ? change + kTwoPi : change;
    turned_waypoints_ = turned_waypoints_ || std::abs(place.turn) > kNone;
  }
}

double ToolPath::waypoint_turn(double travel) const {
  if (!turned_waypoints_) return 0;
  const auto after =
      std::upper_bound(waypoints_.begin() + 1, waypoints_.end() - 1, travel,
                       [](double value, const Place& place) { return value < place.travel; });
  const Place &from = *(after - 1), &to = *after;
  const double share = std::clamp((travel - from.travel) / (to.travel - from.travel), 0.0, 1.0);
  return from.turn + share * (to.turn - from.turn);
}

void ToolPath::close() {
  closed_ = true;
  PathLayer& last = layers_.back();
  if (last.tool.matrix() == layers_.front().tool.matrix()) return;
  twist_ = -roll_between(layers_.front().tool, last.tool) / last.travel;
  for (PathLayer& layer : layers_) {
    layer.tool = twisted(layer.tool, layer.travel);
    layer.step_rotation =
        Eigen::AngleAxisd(-twist_ * layer.travel, Vector3d::UnitZ()) * layer.step_rotation;
  }
  last.tool = layers_.front().tool;
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
  const double s = start_at.value_or(0), length = layers_.back().s;
  const auto refuse = [&] {
    const std::string text =
        formatted("start_at: is %.9g m: allowed is from 0 to before the end of the path, at %.9g m",
                  s, length);
    throw InputError(source, text);
  };
  if (!(s >= 0 && s <= length + kOnLayer)) refuse();
  const auto [first, t, gap] = start_on(*this, start_at, tool);
  if (first + 1 >= size()) refuse();

  // A motion begins in the start's own joints, however near to the path its tool is.
  const bool aside = gap > (rounding_ > 0 ? kSame : kOnLayer) && gap <= tolerance;
  for (int i = 0; i < first; ++i) before_.push_back(layer(i).tool);
  if (t > 0 || aside) {
    before_.push_back(layer(first).tool);
    begins_on_layer_ = false;
    PathLayer to = layer(first + 1);
    const double rest = (1 - t) * (to.travel - layer(first).travel),
                 way = aside ? std::max(rest, travel_between(tool, to.tool)) : rest;
    if (turned_waypoints_ && way > rest) {  // the turns stay where they are along s
      const Place turns[] = {{to.travel - way, -1, waypoint_turn(to.travel - rest)},
                             {to.travel, to.waypoint, waypoint_turn(to.travel)}};
      std::erase_if(waypoints_, [&](const Place& place) { return place.travel <= to.travel; });
      waypoints_.insert(waypoints_.begin(), std::begin(turns), std::end(turns));
    }
    to.tool = twisted(to.tool, -way);
    PathLayer& from = layers_[static_cast<std::size_t>(first)];
    from = layer_within_step(from, to, s, t, aside ? tool : at(first, t));
    if (way > rest) from.travel = to.travel - way;
    begins_aside_ = aside;
  }
  layers_.erase(layers_.begin(), layers_.begin() + first);
  for (Segment& segment : segments_) segment.layer -= first;
  for (Corner& corner : corners_) corner.layer -= first;
  std::erase_if(corners_, [](const Corner& corner) { return corner.layer <= 0; });
  if (begins_aside_ && rounding_ > 0 && gap > kOnLayer)
    corners_.insert(corners_.begin(), {1, 2 * kJoining * (layer(1).travel - layer(0).travel),
                                       kJoining * gap, kJoining * gap});
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
  const double way = t * (to.travel - from.travel);
  const bool joins = begins_aside_ && i == 0;
  const auto curve = [&](double travel) {
    return twisted(on_curve(segment_of(i), travel), travel);
  };
  if (joins && rounding_ > 0) {
    const Pose begin = curve(from.travel);
    const double part = part_beside(t);
    Pose X = curve(from.travel + way);
    X.translation() += part * (from.tool.translation() - begin.translation());
    X.linear() *=
        turned(Quaterniond::Identity(),
               short_arc(Quaterniond(begin.linear()), Quaterniond(from.tool.linear())), part)
            .toRotationMatrix();
    return X;
  }
  if (rounded_ && !joins) return curve(from.travel + way);
  Pose X;
  X.translation() = from.tool.translation() + t * (to.tool.translation() - from.tool.translation());
  X.linear() = from.tool.linear();
  if (from.step_angle > 0)
    X.linear() = from.tool.linear() *
                 Eigen::AngleAxisd(t * from.step_angle, from.step_rotation / from.step_angle)
                     .toRotationMatrix();
  return twisted(X, way);
}

}  // namespace swivel
