// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/answer/answer.hpp"

#include <utility>

namespace swivel {

namespace {

/// Returns the parts of an arm that runs its only stroke, with these rows; none without rows.
std::vector<Part> one_run(std::vector<TrajectoryRow> rows, double cost) {
  if (rows.empty()) return {};
  return {{.run = StrokeRun(), .cost = cost, .rows = std::move(rows)}};
}

}  // namespace

std::vector<bool> process_of_rows(const Part& part, const Problem& problem) {
  std::vector<bool> process(part.rows.size(), false);
  if (!part.run) return process;
  constexpr double kTolerance = 1e-9;  // m, of sums of lengths
  const Stroke& stroke = problem.arm().strokes[part.run->stroke];
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

const std::vector<TrajectoryRow>& ArmAnswer::rows() const {
  static const std::vector<TrajectoryRow> none;
  return parts.empty() ? none : parts.front().rows;
}

double ArmAnswer::cost() const {
  double cost = 0;
  for (const Part& part : parts) cost += part.cost;
  return cost;
}

std::optional<std::size_t> Answer::given_arm() const {
  for (std::size_t k = 0; k < arms.size(); ++k)
    if (arms[k].given) return k;
  return std::nullopt;
}

Answer answer_of(PlanResult result) {
  Answer answer;
  answer.status = result.status;
  answer.cost = result.cost;
  answer.lattice_cost = answer.bound = answer.bound_any = answer.bound_orders = result.lattice.cost;
  answer.checked = result.checked;
  answer.planner = std::move(result.planner);
  answer.threads = result.threads;
  answer.time_ms = std::move(result.time_ms);
  answer.warnings = std::move(result.warnings);
  ArmAnswer& arm = answer.arm();
  arm.parts = one_run(std::move(result.trajectory), result.cost);
  arm.partial = one_run(std::move(result.partial), result.cost);
  arm.counters = result.counters;
  arm.joint_names = std::move(result.joint_names);
  arm.held = std::move(result.held);
  arm.dropped_pairs = std::move(result.dropped_pairs);
  arm.reduced_pairs = std::move(result.reduced_pairs);
  arm.runs.push_back(std::move(result));
  return answer;
}

std::array<std::string, 2> names_of_arms(const Answer& answer) {
  return {answer.arms[0].name, answer.arms[1].name};
}

std::array<std::array<std::string, kDof>, 2> joint_names_of_arms(const Answer& answer) {
  return {answer.arms[0].joint_names, answer.arms[1].joint_names};
}

std::array<std::vector<TrajectoryRow>, 2> rows_of_arms(const Answer& answer) {
  return {answer.arms[0].rows(), answer.arms[1].rows()};
}

const char* to_string(PairSearch search) {
  switch (search) {
    case PairSearch::kArmsAlone:
      return "arms alone";
    case PairSearch::kRegions:
      return "regions";
    case PairSearch::kProduct:
      return "pairs of nodes";
    case PairSearch::kNone:
      break;
  }
  return "none";
}

Problem executed_problem(const Problem& problem, const Answer& answer) {
  const std::vector<LiftOffAnswer>& lift_offs = answer.arm().lift_offs;
  if (lift_offs.empty()) return problem;
  return with_lift_offs(problem, {lift_offs.begin(), lift_offs.end()});
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
