// SPDX-License-Identifier: BSD-3-Clause
#include "job/lift_offs/lift_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "job/lift_offs/piece_planes.hpp"
#include "job/transitions/job_transitions.hpp"
#include "plan/layout/told_turns.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "validity/collision_validity.hpp"
#include "validity/hooked_validity.hpp"

namespace swivel {

namespace {

constexpr int kMostLayersToCut = 5000;  // all edges are stored
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

/// A line with what its validity refers to.
struct Line {
  PathProblem problem;
  std::optional<ToolPath> path;
  std::shared_ptr<const Lattice> lattice;
  std::optional<CollisionValidity> collision;
  std::optional<HookedValidity> validity;
};

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
  collision_.emplace(*lattice_, world_, world_.edge_rule(robot.radii()), problem_.limits.edges,
                     proofs_, executor_, 0, budget_);
  validity_.emplace(*lattice_, *collision_, hooks_, budget_);
  const Stroke& own = job.arm().strokes[stroke];
  CutProgram::Setting setting;
  setting.places = places_ = find_places(job.arm().lift->overlap);
  if (stroke == 0) setting.home_before = job.arm().home;
  if (stroke + 1 == job.arm().strokes.size()) setting.home_after = job.arm().home;
  setting.approach = !own.approach.isZero(0);
  setting.retract = !own.retract.isZero(0);
  setting.make_line = [this](int layer, CutProgram::LineKind kind) { return line(layer, kind); };
  program_.emplace(*lattice_, *validity_, std::move(setting), budget_);
  least_ = program_->least_cuts();
}

bool LiftSearch::turns_on_the_spot(int layer) const {
  const auto same = [&](int a, int b) {
    return path_.layer(b).s - path_.layer(a).s <= kSameLength;
  };
  return (layer > 0 && same(layer - 1, layer)) ||
         (layer + 1 < path_.size() && same(layer, layer + 1));
}

std::vector<CutPlace> LiftSearch::find_places(double overlap) const {
  std::vector<CutPlace> places(static_cast<std::size_t>(path_.size()));
  for (int i = 1; i + 1 < path_.size(); ++i) {
    if (turns_on_the_spot(i)) continue;
    int begin = i;
    while (begin > 0 && (path_.layer(begin).s > path_.layer(i).s - overlap + kSameLength ||
                         turns_on_the_spot(begin)))
      --begin;
    places[static_cast<std::size_t>(i)] = {true, begin};
  }
  return places;
}

CutLine LiftSearch::line(int layer, CutProgram::LineKind kind) {
  const bool approach = kind == CutProgram::LineKind::kApproach;
  const double s = path_.layer(layer).s;
  // the run that begins or ends at the layer, with this line alone
  Problem job = *job_;
  Stroke& stroke = job.arm().strokes[stroke_];
  stroke.smooth.reset();
  stroke.end.reset();
  const double length = stroke.approach.norm();
  (approach ? stroke.retract : stroke.approach).setZero();
  const bool cut = approach ? layer > 0 : layer + 1 < path_.size();
  if (cut) job = with_lift_offs(job, {{stroke_, s, s}});
  const auto line = std::make_shared<Line>();
  const std::size_t run = stroke_ + (cut && approach ? 1 : 0);
  line->problem = on_all_layers(problem_of_run(job, {run, false}), robot_->arm_class());
  const PathProblem& problem = line->problem;
  line->path = problem_path(problem, robot_->arm().chain, budget_);
  ToolPath& path = *line->path;
  std::vector<ArmPlane> planes;
  if (approach) {
    planes = planes_of_piece(job.arm().strokes[run], problem, *robot_, path, budget_);
    path.end_at(layer_at(path, length));
    if (!planes.empty()) planes.resize(static_cast<std::size_t>(path.size()));
  } else {
    path.begin_at(s, path_.layer(layer).tool, 0, problem.source);
  }
  line->lattice =
      with_all_windings(make_piece_lattice(*robot_, path, problem, std::move(planes), budget_));
  line->collision.emplace(*line->lattice, world_, world_.edge_rule(robot_->radii()),
                          problem.limits.edges, proofs_, executor_, 0, budget_);
  line->validity.emplace(*line->lattice, *line->collision, hooks_, budget_);
  // Lists have other nodes in another path: those of a line are near those of the stroke.
  constexpr double kSameOnGrids = 1e-6, kNearInLists = 0.2;  // rad
  return {line->lattice,
          {line, &*line->validity},
          robot_->arm_class().kind == ArmKind::kSrs ? kSameOnGrids : kNearInLists};
}

std::optional<LiftSearch::Places> LiftSearch::next(int count) {
  const auto found = program_->best(count);
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
    program_->bar(static_cast<int>(last_.size() - k), layer);
}

double LiftSearch::reach(double from) {
  const int begin = layer_at(path_, from);
  return path_.layer(std::max(begin, program_->reach(begin))).s;
}

double LiftSearch::distance(const Config& from, const Config& to) const {
  return transition_distance(*lattice_, from, to);
}

}  // namespace swivel
