// SPDX-License-Identifier: BSD-3-Clause
#include "job/process_range.hpp"

#include <algorithm>

namespace swivel {

std::vector<double> waypoint_distances(const Problem& problem) {
  std::vector<double> s{0};
  for (std::size_t k = 1; k < problem.waypoints.size(); ++k)
    s.push_back(s.back() +
                (problem.waypoints[k].position - problem.waypoints[k - 1].position).norm());
  return s;
}

std::array<ProcessEvent, 2> events_of_run(const Job& job, const StrokeRun& run,
                                          const Problem& problem, std::span<const TimedRow> rows) {
  constexpr double kSame = 1e-6;  // m; waypoints on a straight line are merged
  const std::vector<double> s = waypoint_distances(problem);
  const ProcessWaypoints process = process_waypoints(job.strokes[run.stroke]);
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

}  // namespace swivel
