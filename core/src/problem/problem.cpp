// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/problem/problem.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "problem/two_arms.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/core/problem/validate.hpp"

namespace swivel {

namespace {

Waypoint shifted(Waypoint waypoint, const Vector3d& offset) {
  waypoint.position += waypoint.orientation.normalized() * offset;
  return waypoint;
}

bool is_none(const Vector3d& offset) {
  return offset == Vector3d::Zero();
}

void require_speed(const std::optional<double>& speed, const std::string& what) {
  if (speed && !(std::isfinite(*speed) && *speed > 0))
    throw InvalidArgument(what + ": allowed are numbers above 0, m/s");
}

void validate(const Stroke& stroke) {
  const std::string name = "stroke '" + stroke.name + "': ";
  if (stroke.start || stroke.start_at)
    throw InvalidArgument(name + "start: allowed is the home of the job");
  if (stroke.end && stroke.reversible)
    throw InvalidArgument(name + "end: allowed in strokes that are not reversible");
  if (stroke.closed && stroke.approach != stroke.retract)
    throw InvalidArgument(name +
                          "closed: is of the whole run: allowed are an approach and a "
                          "retract that are equal");
  if (!stroke.rolls.empty()) throw InvalidArgument(name + "rolls: allowed are none");
  if (!stroke.steps.empty()) throw InvalidArgument(name + "steps: allowed are none");
  if (!stroke.approach.allFinite() || !stroke.retract.allFinite())
    throw InvalidArgument(name + "approach, retract: allowed are finite numbers");
  require_speed(stroke.process_speed, name + "process_speed");
  require_speed(stroke.approach_speed, name + "approach_speed");
  if (!stroke.feed.empty() && stroke.feed.size() != stroke.waypoints.size())
    throw InvalidArgument(name + "feed: allowed is one for each waypoint");
  for (const double feed : stroke.feed) require_speed(feed, name + "feed");
}

void validate(const LiftOffs& lift, const Problem& job) {
  for (const double value : {lift.cost, lift.overlap})
    if (!(std::isfinite(value) && value >= 0))
      throw InvalidArgument("lift: cost, overlap: allowed are numbers from 0 on");
  if (job.arm().order != StrokeOrder::kGiven)
    throw InvalidArgument("lift: allowed is the order of strokes that is given");
  for (const Stroke& stroke : job.arm().strokes) {
    if (!stroke.piece && stroke.name.find('/') != std::string::npos)
      throw InvalidArgument("strokes: name '" + stroke.name +
                            "': with lift-offs allowed are names without a slash");
    if (stroke.closed)
      throw InvalidArgument("lift: stroke '" + stroke.name +
                            "' is closed and is done in one run: allowed is no lift");
  }
}

constexpr double kSamePlace = 1e-9;  // m

/// Returns the arc length of each waypoint, m.
std::vector<double> lengths_to(const std::vector<Waypoint>& waypoints) {
  std::vector<double> s{0};
  for (std::size_t k = 1; k < waypoints.size(); ++k)
    s.push_back(s.back() + (waypoints[k].position - waypoints[k - 1].position).norm());
  return s;
}

/// Returns the waypoint that lies at a share t of the way from `a` to `b`.
Waypoint between(const Waypoint& a, const Waypoint& b, double t) {
  Waypoint found = a;
  found.position += t * (b.position - a.position);
  found.orientation = a.orientation.normalized().slerp(t, b.orientation.normalized());
  if (a.roll && b.roll)
    found.roll = Roll{a.roll->lower + t * (b.roll->lower - a.roll->lower),
                      a.roll->upper + t * (b.roll->upper - a.roll->upper)};
  return found;
}

/// Returns the run of a stroke from one arc length to another, m.
Stroke piece_of(const Stroke& stroke, double from, double to, std::size_t number) {
  const std::vector<double> s = lengths_to(stroke.waypoints);
  if (!(from >= 0 && from + kSamePlace < to && to <= s.back() + kSamePlace))
    throw InvalidArgument("stroke '" + stroke.name + "': lift-offs: allowed are runs forwards");
  Stroke piece = stroke;
  piece.name += '/' + std::to_string(number);
  piece.reversible = false;
  piece.piece = StrokePiece{stroke.name, from, {}};
  piece.waypoints.clear();
  piece.feed.clear();
  if (to < s.back() - kSamePlace) piece.end.reset();
  const auto add = [&](const Waypoint& waypoint, std::size_t k) {
    piece.waypoints.push_back(waypoint);
    if (!stroke.feed.empty()) piece.feed.push_back(stroke.feed[k]);
  };
  for (std::size_t k = 0; k < s.size(); ++k) {
    const auto cut = [&](double at) {  // between waypoint k - 1 and waypoint k
      return k > 0 && s[k - 1] < at - kSamePlace && at + kSamePlace < s[k];
    };
    const auto on_way = [&](double at) {
      return between(stroke.waypoints[k - 1], stroke.waypoints[k],
                     (at - s[k - 1]) / (s[k] - s[k - 1]));
    };
    if (cut(from)) add(on_way(from), k - 1);
    if (cut(to)) add(on_way(to), k - 1);
    if (s[k] < from - kSamePlace)
      piece.piece->before.push_back(stroke.waypoints[k]);
    else if (s[k] <= to + kSamePlace)
      add(stroke.waypoints[k], k);
  }
  return piece;
}

}  // namespace

Problem with_lift_offs(const Problem& job, const std::vector<LiftOff>& lift_offs) {
  Problem made = job;
  made.arm().strokes.clear();
  auto next = lift_offs.begin();
  for (std::size_t k = 0; k < job.arm().strokes.size(); ++k) {
    const Stroke& stroke = job.arm().strokes[k];
    if (next == lift_offs.end() || next->stroke != k) {
      made.arm().strokes.push_back(stroke);
      continue;
    }
    double from = 0;
    std::size_t number = 1;
    for (; next != lift_offs.end() && next->stroke == k; ++next, ++number) {
      made.arm().strokes.push_back(piece_of(stroke, from, next->end, number));
      if (!(next->resumed <= next->end + kSamePlace))
        throw InvalidArgument("stroke '" + stroke.name +
                              "': lift-offs: allowed are runs that leave nothing out");
      from = next->resumed;
    }
    made.arm().strokes.push_back(
        piece_of(stroke, from, lengths_to(stroke.waypoints).back(), number));
  }
  if (next != lift_offs.end())
    throw InvalidArgument("lift-offs: allowed are those of the job's strokes, in their order");
  return made;
}

std::size_t lift_off_count(const Problem& job) {
  std::size_t count = 0;
  for (std::size_t k = 1; k < job.arm().strokes.size(); ++k) {
    const auto &before = job.arm().strokes[k - 1].piece, &own = job.arm().strokes[k].piece;
    count += before && own && before->stroke == own->stroke ? 1 : 0;
  }
  return count;
}

std::string words(const StrokeRun& run, const Problem& problem) {
  return "'" + problem.arm().strokes[run.stroke].name + "'" + (run.reversed ? " backwards" : "");
}

std::optional<std::size_t> find_stroke(const Problem& job, const std::string& name) {
  for (std::size_t k = 0; k < job.arm().strokes.size(); ++k)
    if (job.arm().strokes[k].name == name) return k;
  return std::nullopt;
}

std::vector<Waypoint> waypoints_of_run(const Stroke& stroke, bool reversed) {
  std::vector<Waypoint> waypoints = stroke.waypoints;
  if (reversed) std::reverse(waypoints.begin(), waypoints.end());
  if (waypoints.empty()) return waypoints;
  const Waypoint before = shifted(waypoints.front(), stroke.approach),
                 after = shifted(waypoints.back(), stroke.retract);
  if (!is_none(stroke.approach)) waypoints.insert(waypoints.begin(), before);
  if (!is_none(stroke.retract)) waypoints.push_back(after);
  return waypoints;
}

ProcessWaypoints process_waypoints(const Stroke& stroke) {
  const std::size_t first = is_none(stroke.approach) ? 0 : 1;
  return {first, first + stroke.waypoints.size() - 1};
}

bool is_path(const Problem& problem) {
  return problem.arms.size() == 1 && problem.arm().strokes.size() == 1 &&
         problem.arm().path().name.empty();
}

bool is_path_alone(const ArmTask& arm) {
  if (arm.strokes.size() != 1) return false;
  const Stroke& path = arm.path();
  return path.name.empty() && !path.reversible && path.approach.isZero(0) &&
         path.retract.isZero(0) && !path.process_speed && !path.approach_speed &&
         path.feed.empty() && !path.piece && !arm.home && arm.order == StrokeOrder::kGiven &&
         !arm.process_speed && !arm.approach_speed && arm.rapid == 1 && !arm.lift;
}

namespace {

/// Returns true if two waypoints are one pose.
bool same_pose(const Waypoint& a, const Waypoint& b) {
  constexpr double kOnePose = 1e-9;  // m and rad
  return (a.position - b.position).norm() <= kOnePose &&
         a.orientation.angularDistance(b.orientation) <= kOnePose;
}

/// Returns true if ToolPath might merge `middle`, to which the tool comes from `before` without
/// turning, into a straight segment to `after`.
bool on_one_line(const Waypoint& before, const Waypoint& middle, const Waypoint& after) {
  constexpr double kNear = 2e-6;  // m and rad; more than ToolPath merges
  const Vector3d way = after.position - before.position;
  const double first = (middle.position - before.position).norm(),
               second = (after.position - middle.position).norm();
  return (before.position + first / (first + second) * way - middle.position).norm() <= kNear &&
         middle.orientation.angularDistance(after.orientation) <= kNear;
}

/// Returns the steps into which the path of a run is cut (Task::steps) where its approach or its
/// retract goes straight on into its stroke: with them the stroke's first and last waypoint are
/// layers, so that the process begins and ends there. Elsewhere, and where neighbouring waypoints
/// are one pose, returns none.
std::vector<int> steps_along_lines(const Stroke& stroke, const PathProblem& problem) {
  const std::vector<Waypoint>& waypoints = problem.waypoints;
  const ProcessWaypoints process = process_waypoints(stroke);
  const auto is_lost = [&](std::size_t line, std::size_t end, std::size_t inner) {
    return on_one_line(waypoints[line], waypoints[end], waypoints[inner]);
  };
  const std::size_t first = process.first, last = process.last;
  const bool lost =
      first < last && ((first > 0 && is_lost(first - 1, first, first + 1)) ||
                       (last + 1 < waypoints.size() && is_lost(last + 1, last, last - 1)));
  if (!lost || !(problem.resolution.ds > 0 && problem.resolution.dalpha > 0) ||
      std::adjacent_find(waypoints.begin(), waypoints.end(), same_pose) != waypoints.end())
    return {};
  return steps_between(waypoints, problem.resolution, problem.source,
                       problem.roll && problem.roll->circle());
}

}  // namespace

PathProblem problem_of_path(const Problem& problem, const ArmTask& arm, const Task& path) {
  PathProblem alone;
  static_cast<Robot&>(alone) = arm;
  static_cast<Task&>(alone) = path;
  alone.scene = problem.scene;
  alone.vary = problem.vary;
  alone.source = problem.source;
  return alone;
}

PathProblem problem_of_run(const Problem& problem, const StrokeRun& run) {
  const Stroke& stroke = problem.arm().strokes[run.stroke];
  PathProblem alone = problem_of_path(problem, problem.arm(), stroke);
  if (is_path(problem)) return alone;
  alone.waypoints = waypoints_of_run(stroke, run.reversed);
  alone.source = problem.source.empty() ? "stroke '" + stroke.name + "'"
                                        : problem.source + ": stroke '" + stroke.name + "'";
  alone.steps = steps_along_lines(stroke, alone);
  return alone;
}

Problem two_arms() {
  Problem problem;
  problem.arms.resize(2);
  for (ArmTask& arm : problem.arms) arm.strokes.resize(1);
  return problem;
}

Problem one_path(const PathProblem& path) {
  Problem problem;
  problem.source = path.source;
  problem.scene = path.scene;
  problem.vary = path.vary;
  static_cast<Robot&>(problem.arm()) = path;
  static_cast<Task&>(problem.arm().strokes.emplace_back()) = path;
  return problem;
}

Limits limits_of_transitions(const Problem& problem) {
  Limits limits = problem.arm().transition_limits;
  for (const Stroke& stroke : problem.arm().strokes)
    limits.joint_margin = std::min(limits.joint_margin, stroke.limits.joint_margin);
  return limits;
}

namespace {

/// Throws InvalidArgument for strokes of one arm that make no sense.
void validate_strokes(const Problem& problem) {
  const ArmTask& arm = problem.arm();
  if (arm.strokes.empty()) throw InvalidArgument("strokes: allowed is at least one");
  std::set<std::string> names;
  for (std::size_t k = 0; k < arm.strokes.size(); ++k) {
    const Stroke& stroke = arm.strokes[k];
    if (stroke.name.empty()) throw InvalidArgument("strokes: name: allowed are non-empty names");
    if (!names.insert(stroke.name).second)
      throw InvalidArgument("strokes: name '" + stroke.name + "' is taken: allowed are new names");
    validate(stroke);
    validate(problem_of_run(problem, {k, false}));
  }
  if (arm.home && !arm.home->allFinite())
    throw InvalidArgument("home: allowed are finite numbers, rad");
  require_speed(arm.process_speed, "process_speed");
  require_speed(arm.approach_speed, "approach_speed");
  if (arm.lift) validate(*arm.lift, problem);
  if (!(arm.rapid > 0 && arm.rapid <= 1))
    throw InvalidArgument("rapid: allowed are numbers above 0 and at most 1");
}

}  // namespace

void validate(const Problem& problem) {
  if (problem.arms.size() == 2) {
    validate_two_arms(problem);
    return;
  }
  if (problem.arms.size() != 1) throw InvalidArgument("arms: allowed are one or two");
  const ArmTask& arm = problem.arm();
  if (!arm.name.empty() || !arm.given.empty() || !problem.may_touch.empty())
    throw InvalidArgument("arms: name, given, may_touch: allowed are they of two arms");
  if (is_path_alone(arm))
    validate(problem_of_run(problem, {0, false}));
  else
    validate_strokes(problem);
}

}  // namespace swivel
