// SPDX-License-Identifier: BSD-3-Clause
#include "job/lift_offs/lift_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "job/transitions/job_transitions.hpp"
#include "plan/layout/told_turns.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "validity/collision_validity.hpp"
#include "validity/hooked_validity.hpp"

namespace swivel {

namespace {

constexpr int kMostLayersToCut = 5000;  // all nodes and edges are stored
constexpr double kSameLength = 1e-9;    // m

/// Returns the problem of a stroke without approach and retract, whose corners stay sharp: where
/// they are rounded, a run that ends at a corner ends beside the curve.
PathProblem bare_problem(const Problem& job, std::size_t stroke) {
  Problem bare = job;
  bare.arm().strokes[stroke].smooth.reset();
  bare.arm().strokes[stroke].approach.setZero();
  bare.arm().strokes[stroke].retract.setZero();
  return problem_of_run(bare, {stroke, false});
}

/// Throws InputError for what strokes in several runs do not have.
void require_cuttable(const PreparedRobot& robot, const PathProblem& problem,
                      const ToolPath& path) {
  if (robot.arm().chain.free_roll)
    throw InputError(problem.source,
                     "lift: is of arms without a roll besides the arm angle: allowed is to leave "
                     "out `lift`, or the roll of the path");
  if (path.size() > kMostLayersToCut)
    throw InputError(problem.source, "lift: the stroke has " + std::to_string(path.size()) +
                                         " layers and must be done in several runs: allowed are "
                                         "at most " +
                                         std::to_string(kMostLayersToCut) +
                                         ", by a coarser resolution");
}

}  // namespace

LiftSearch::LiftSearch(const PreparedRobot& robot, const Problem& job, std::size_t stroke,
                       DistanceProofs proofs, std::shared_ptr<StateCheck> check, int threads,
                       const Budget& budget)
    : robot_(&robot),
      job_(&job),
      stroke_(stroke),
      proofs_(proofs),
      hooks_{std::move(check), nullptr},
      budget_(budget),
      problem_(on_all_layers(bare_problem(job, stroke), robot.arm_class())),
      world_(robot.world(), problem_, budget),
      executor_(threads),
      path_(problem_path(problem_, robot.arm().chain, budget)) {
  require_cuttable(robot, problem_, path_);
  lattice_ = with_all_windings(
      make_lattice(robot.arm().chain, robot.arm_class(), path_, problem_, budget));
  CollisionValidity validity(*lattice_, world_, world_.edge_rule(robot.radii()),
                             problem_.limits.edges, proofs_, executor_, 0, budget_);
  HookedValidity hooked(*lattice_, validity, hooks_, budget_);
  program_.emplace(*lattice_, hooked, budget_);
  find_places(job.arm().lift->overlap);
  begin_known_.resize(places_.size());
  end_known_.resize(places_.size());
  find_lines(0, path_.size() - 1);
  for (;;) {
    least_ = program_->least_cuts();
    if (!least_ || best(*least_)) return;
  }
}

bool LiftSearch::turns_on_the_spot(int layer) const {
  const auto same = [&](int a, int b) {
    return path_.layer(b).s - path_.layer(a).s <= kSameLength;
  };
  return (layer > 0 && same(layer - 1, layer)) ||
         (layer + 1 < path_.size() && same(layer, layer + 1));
}

void LiftSearch::find_places(double overlap) {
  places_.resize(static_cast<std::size_t>(path_.size()));
  for (int i = 1; i + 1 < path_.size(); ++i) {
    if (turns_on_the_spot(i)) continue;
    int begin = i;
    while (begin > 0 && (path_.layer(begin).s > path_.layer(i).s - overlap + kSameLength ||
                         turns_on_the_spot(begin)))
      --begin;
    places_[static_cast<std::size_t>(i)] = {true, begin};
  }
  program_->set_places(places_);
}

/// Finds what the approach costs at the layer `begin` and the retract at the layer `end`. Returns
/// false if both were known.
bool LiftSearch::find_lines(int begin, int end) {
  const Stroke& stroke = job_->arm().strokes[stroke_];
  const auto b = static_cast<std::size_t>(begin), e = static_cast<std::size_t>(end);
  bool found = false;
  if (begin_known_[b] == 0 && !stroke.approach.isZero(0)) {
    program_->set_begin_costs(begin, line_costs(begin, stroke.approach));
    found = true;
  }
  if (end_known_[e] == 0 && !stroke.retract.isZero(0)) {
    program_->set_end_costs(end, line_costs(end, stroke.retract));
    found = true;
  }
  begin_known_[b] = end_known_[e] = 1;
  return found;
}

/// Returns the cheapest cuts of a number. Lines count as free and without cost until a path that
/// has them is the cheapest.
std::optional<CutPath> LiftSearch::best(int count) {
  for (;;) {
    auto found = program_->best(count, without_, budget_);
    if (!found) return std::nullopt;
    bool more = false;
    for (const int end : found->ends)
      more = find_lines(places_[static_cast<std::size_t>(end)].resumed, end) || more;
    if (!more) return found;
  }
}

/// Returns for each valid node of a layer what the straight line from there to where the tool
/// stands with `offset` costs; kUnreachable where it is barred. A line is as good in both
/// directions.
std::vector<double> LiftSearch::line_costs(int layer, const Vector3d& offset) {
  const double s = path_.layer(layer).s;
  PathProblem line = problem_;
  line.end.reset();
  if (layer == 0) {
    // The stroke beyond the line says how the tool's frame is carried along its axis.
    line.waypoints.insert(line.waypoints.begin(), line.waypoints.front());
  } else if (layer + 1 < path_.size()) {
    const Problem cut = with_lift_offs(*job_, {{stroke_, s, s}});
    line.waypoints = cut.arm().strokes[stroke_].waypoints;
  }
  if (layer > 0) line.waypoints.push_back(line.waypoints.back());
  const auto beyond = layer > 0 ? line.waypoints.end() - 1 : line.waypoints.begin() + 1;
  const Vector3d away = beyond->orientation.normalized() * offset;
  for (auto waypoint = beyond; waypoint != line.waypoints.end(); ++waypoint)
    waypoint->position += away;
  ToolPath path = problem_path(line, robot_->arm().chain, budget_);
  if (layer == 0) {
    int end = 1;
    while (path.layer(end).waypoint != 1) ++end;
    path.end_at(end);
  }
  path.begin_at(s, path_.layer(layer).tool, 0, line.source);
  const auto lattice = with_all_windings(
      make_lattice(robot_->arm().chain, robot_->arm_class(), path, line, budget_));
  CollisionValidity validity(*lattice, world_, world_.edge_rule(robot_->radii()), line.limits.edges,
                             proofs_, executor_, 0, budget_);
  HookedValidity hooked(*lattice, validity, hooks_, budget_);
  const CostsToEnd line_ends = costs_to_end(*lattice, hooked, budget_);
  std::vector<double> costs;
  constexpr double kSameJoints = 1e-6;  // rad
  for (const Lattice::Node& node : program_->nodes(layer)) {
    costs.push_back(kUnreachable);
    for (std::size_t k = 0; k < line_ends.nodes.size(); ++k)
      if ((line_ends.nodes[k].q - node.q).cwiseAbs().maxCoeff() <= kSameJoints)
        costs.back() = std::min(costs.back(), line_ends.costs[k]);
  }
  return costs;
}

std::optional<LiftSearch::Places> LiftSearch::next(int count) {
  const auto found = best(count);
  last_.clear();
  if (!found) return std::nullopt;
  last_ = found->ends;
  Places places{{}, found->cost};
  for (const int end : found->ends)
    places.lift_offs.push_back({stroke_, path_.layer(end).s,
                                path_.layer(places_[static_cast<std::size_t>(end)].resumed).s});
  return places;
}

void LiftSearch::leave_out(std::size_t k, int around) {
  for (int layer = last_[k] - around; layer <= last_[k] + around; ++layer)
    without_.push_back({static_cast<int>(k), layer});
}

double LiftSearch::reach(double from) const {
  int begin = 0;
  while (begin + 1 < path_.size() && path_.layer(begin).s < from - kSameLength) ++begin;
  return path_.layer(std::max(begin, program_->reach(begin))).s;
}

double LiftSearch::distance(const Config& from, const Config& to) const {
  return transition_distance(*lattice_, from, to);
}

}  // namespace swivel
