// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/answer/job_result.hpp"

namespace swivel {

std::vector<bool> process_of_rows(const JobPart& part, const Problem& job) {
  std::vector<bool> process(part.rows.size(), false);
  if (!part.run) return process;
  constexpr double kTolerance = 1e-9;  // m, of sums of lengths
  const Stroke& stroke = job.arm().strokes[part.run->stroke];
  const std::vector<Waypoint> waypoints = waypoints_of_run(stroke, part.run->reversed);
  const ProcessWaypoints range = process_waypoints(stroke);
  double s = 0, first = 0, last = 0;
  for (std::size_t k = 1; k < waypoints.size(); ++k) {
    s += (waypoints[k].position - waypoints[k - 1].position).norm();
    if (k == range.first) first = s;
    if (k == range.last) last = s;
  }
  for (std::size_t k = 0; k < process.size(); ++k)
    process[k] = part.rows[k].s >= first - kTolerance && part.rows[k].s <= last + kTolerance;
  return process;
}

Problem executed_job(const Problem& job, const JobResult& result) {
  return with_lift_offs(job, {result.lift_offs.begin(), result.lift_offs.end()});
}

const char* to_string(NoTransition::Where where) {
  switch (where) {
    case NoTransition::Where::kBetween:
      return "between";
    case NoTransition::Where::kHome:
      return "home";
    case NoTransition::Where::kEndBefore:
      return "end";
    case NoTransition::Where::kBegin:
      break;
  }
  return "begin";
}

std::string words(const NoTransition& none, const std::vector<std::string>& runs) {
  const std::string bodies =
      none.bodies ? (*none.bodies)[0] + " - " + (*none.bodies)[1] : std::string("bodies");
  const std::string too_near = bodies + " come nearer to each other than transitions may";
  switch (none.where) {
    case NoTransition::Where::kHome:
      return "at home " + too_near;
    case NoTransition::Where::kEndBefore:
      return "wherever " + runs[none.to - 1] + " may end, " + too_near +
             ": a longer retract would lead away";
    case NoTransition::Where::kBegin:
      return "wherever " + runs[none.to] + " may begin, " + too_near +
             ": a longer approach would begin further away";
    case NoTransition::Where::kBetween:
      break;
  }
  std::string text = "no way leads from " + (none.to == 0 ? "home" : runs[none.to - 1]) + " to " +
                     (none.to < runs.size() ? runs[none.to] : "home");
  if (none.bodies) text += "; " + bodies + " bar the straight one";
  return text;
}

}  // namespace swivel
