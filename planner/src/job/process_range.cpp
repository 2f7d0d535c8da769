// SPDX-License-Identifier: BSD-3-Clause
#include "job/process_range.hpp"

#include <algorithm>

namespace swivel {

std::vector<double> waypoint_distances(const PathProblem& problem) {
  std::vector<double> s{0};
  for (std::size_t k = 1; k < problem.waypoints.size(); ++k)
    s.push_back(s.back() +
                (problem.waypoints[k].position - problem.waypoints[k - 1].position).norm());
  return s;
}

std::array<ProcessEvent, 2> events_of_run(const Problem& job, const StrokeRun& run,
                                          const PathProblem& problem,
                                          std::span<const TimedRow> rows) {
  constexpr double kSame = 1e-6;  // m; waypoints on a straight line are merged
  const std::vector<double> s = waypoint_distances(problem);
  const ProcessWaypoints process = process_waypoints(job.arm().strokes[run.stroke]);
  const auto event = [&](std::size_t waypoint, bool on) {
    auto found = std::find_if(rows.begin(), rows.end(), [&](const TimedRow& row) {
      return row.row.s >= s[waypoint] - kSame;
    });
    if (found == rows.end()) --found;
    // where the stroke ends with a turn on the spot, its end is that of the turn
    while (!on && found + 1 != rows.end() && (found + 1)->row.s <= s[waypoint] + kSame) ++found;
    return ProcessEvent{found->t, run.stroke, found->row.s, on};
  };
  return {event(process.first, true), event(process.last, false)};
}

std::optional<RunSpeeds> speeds_of_run(const Problem& job, const StrokeRun& run,
                                       const PathProblem& problem, std::optional<double> speed) {
  const Stroke& stroke = job.arm().strokes[run.stroke];
  std::optional<double> usual;  // where the waypoints have no feed
  for (const std::optional<double>& said :
       {speed, stroke.process_speed, job.arm().process_speed, stroke.limits.tool_speed})
    if (said && !usual) usual = said;
  // If nothing but feeds states a speed, the lines of approach and retract have the first of them.
  if (!usual && !stroke.feed.empty()) usual = stroke.feed.front();
  if (!usual) return std::nullopt;
  const std::vector<double> s = waypoint_distances(problem);
  const ProcessWaypoints process = process_waypoints(stroke);
  RunSpeeds speeds;
  speeds.first = stroke.approach_speed.value_or(job.arm().approach_speed.value_or(*usual));
  const std::size_t count = stroke.waypoints.size();
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const bool fed = !speed && !stroke.feed.empty();
    const std::size_t from = run.reversed ? count - 2 - k : k;
    speeds.from.push_back({s[process.first + k], fed ? stroke.feed[from] : *usual});
  }
  if (process.last + 1 < s.size()) speeds.from.push_back({s[process.last], speeds.first});
  return speeds;
}

}  // namespace swivel
