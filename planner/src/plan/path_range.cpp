// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/plan/path_range.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

namespace {

constexpr double kSameLength = 1e-9;  // m

double length_of(const std::vector<Waypoint>& waypoints) {
  double length = 0;
  for (std::size_t k = 1; k < waypoints.size(); ++k)
    length += (waypoints[k].position - waypoints[k - 1].position).norm();
  return length;
}

}  // namespace

PathProblem problem_of_range(const PathProblem& problem, const PathRange& range) {
  if (!problem.rolls.empty() || !problem.steps.empty())
    throw InvalidArgument("path range: rolls, steps: allowed are none, since they are of the path");
  const double length = length_of(problem.waypoints), to = std::min(range.to, length);
  if (!(range.from >= 0 && range.from + kSameLength < to))
    throw InvalidArgument(
        formatted("path range: from %.6g to %.6g m: allowed are ranges forwards "
                  "within 0 to %.6g m",
                  range.from, range.to, length));
  PathProblem found = problem;
  found.start.reset();
  found.start_at.reset();
  found.end.reset();
  found.closed = false;
  Problem job;
  static_cast<Task&>(job.arm().strokes.emplace_back()) = found;
  std::vector<LiftOff> cuts;
  if (range.from > kSameLength) cuts.push_back({0, range.from, range.from});
  if (to < length - kSameLength) cuts.push_back({0, to, to});
  const std::size_t stretch = range.from > kSameLength ? 1 : 0;
  found.waypoints = with_lift_offs(job, cuts).arm().strokes[stretch].waypoints;
  return found;
}

PathReach reach_from(const PreparedRobot& robot, const PathProblem& problem, double from,
                     PathDirection direction, const PlanOptions& options) {
  const bool backwards = direction == PathDirection::kBackwards;
  PathProblem ahead = problem_of_range(problem, backwards ? PathRange{0, from} : PathRange{from});
  if (backwards) std::reverse(ahead.waypoints.begin(), ahead.waypoints.end());
  PathReach reach;
  reach.plan = plan(robot, ahead, options);
  const std::vector<TrajectoryRow>& rows =
      reach.plan.status == PlanStatus::kSolved ? reach.plan.trajectory : reach.plan.partial;
  const auto& diagnosis = reach.plan.diagnosis;
  double along = diagnosis ? diagnosis->reached_s.value_or(0) : 0;
  if (!rows.empty()) along = std::max(along, rows.back().s);
  from = std::min(from, length_of(problem.waypoints));
  reach.s = backwards ? from - along : from + along;
  return reach;
}

}  // namespace swivel
