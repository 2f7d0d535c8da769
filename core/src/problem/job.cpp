// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/problem/job.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "swivel/core/messages/invalid_argument.hpp"
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

}  // namespace

std::optional<std::size_t> find_stroke(const Job& job, const std::string& name) {
  for (std::size_t k = 0; k < job.strokes.size(); ++k)
    if (job.strokes[k].name == name) return k;
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

Problem problem_of_run(const Job& job, const StrokeRun& run) {
  const Stroke& stroke = job.strokes[run.stroke];
  Problem problem;
  static_cast<Robot&>(problem) = job;
  static_cast<Task&>(problem) = stroke;
  problem.waypoints = waypoints_of_run(stroke, run.reversed);
  problem.scene = job.scene;
  problem.vary = job.vary;
  problem.source = job.source.empty() ? "stroke '" + stroke.name + "'"
                                      : job.source + ": stroke '" + stroke.name + "'";
  return problem;
}

Limits limits_of_transitions(const Job& job) {
  Limits limits = job.limits;
  for (const Stroke& stroke : job.strokes)
    limits.joint_margin = std::min(limits.joint_margin, stroke.limits.joint_margin);
  return limits;
}

void validate(const Job& job) {
  if (job.strokes.empty()) throw InvalidArgument("strokes: allowed is at least one");
  std::set<std::string> names;
  for (std::size_t k = 0; k < job.strokes.size(); ++k) {
    const Stroke& stroke = job.strokes[k];
    if (stroke.name.empty()) throw InvalidArgument("strokes: name: allowed are non-empty names");
    if (!names.insert(stroke.name).second)
      throw InvalidArgument("strokes: name '" + stroke.name + "' is taken: allowed are new names");
    validate(stroke);
    validate(problem_of_run(job, {k, false}));
  }
  if (job.home && !job.home->allFinite())
    throw InvalidArgument("home: allowed are finite numbers, rad");
  require_speed(job.process_speed, "process_speed");
  require_speed(job.approach_speed, "approach_speed");
  if (!(job.rapid > 0 && job.rapid <= 1))
    throw InvalidArgument("rapid: allowed are numbers above 0 and at most 1");
}

}  // namespace swivel
