// SPDX-License-Identifier: BSD-3-Clause
#include "job/plan_strokes.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "job/job_lift.hpp"
#include "job/lift_offs/piece_planes.hpp"
#include "job/lift_offs/plan_lift_offs.hpp"
#include "job/order/order_bounds.hpp"
#include "job/order/order_estimate.hpp"
#include "job/transitions/job_transitions.hpp"
#include "measure/measure_rows.hpp"
#include "plan/answer.hpp"
#include "plan/layout/keeps_branch.hpp"
#include "plan/layout/told_turns.hpp"
#include "plan/search.hpp"
#include "plan/search_on_knots.hpp"
#include "plan/search_settings.hpp"
#include "plan/stopwatch.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/lattice/kinds/unused_keys.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/graph/eager/eager_validity.hpp"
#include "swivel/graph/search/job_search.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/plan/problem_view.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "validity/collision_validity.hpp"
#include "validity/hooked_validity.hpp"

namespace swivel {

namespace {

/// Returns the problem of a run as its lattice takes it. Runs of a stroke in several runs have
/// nodes at every layer, as the lattice has that finds where to lift off; so have all runs where
/// states cost something by the caller's hook, which is that of every layer.
PathProblem problem_of_lattice(const PreparedRobot& robot, const Problem& job, const StrokeRun& run,
                               const Hooks& hooks) {
  PathProblem problem = problem_of_run(job, run);
  return job.arm().strokes[run.stroke].piece || hooks.cost
             ? on_all_layers(std::move(problem), robot.arm_class())
             : problem;
}

/// A run with what its search needs. Each is searched by one thread at a time.
struct PlannedRun {
  PlannedRun(const StrokeRun& of, PathProblem p, const PreparedRobot& robot, const World& w,
             const Budget& budget)
      : run(of),
        problem(std::move(p)),
        world(&w),
        rule(w.edge_rule(robot.radii())),
        path(path_within_scale(problem, robot.arm().chain, budget)) {}
  /// Makes the lattice of the run of a stroke.
  void make_nodes(const Stroke& stroke, const PreparedRobot& robot, const Budget& budget) {
    std::vector<ArmPlane> planes = planes_of_piece(stroke, problem, robot, path, budget);
    other_planes = !planes.empty();
    lattice = make_piece_lattice(robot, path, problem, std::move(planes), budget);
  }
  /// Makes what answers questions about a lattice of the run.
  void ask_about(const Lattice& asked, const PlanOptions& options, const Hooks& hooks,
                 const Budget& budget) {
    hooked.reset();
    validity.emplace(asked, *world, rule, problem.limits.edges, distance_proofs_of(options), alone,
                     1, budget);
    hooked.emplace(asked, *validity, hooks, budget);
  }
  /// Halves narrow steps between the knots of the lattice as the plan of the run alone does
  /// (search_on_knots()), and keeps what its search found out about nodes and edges.
  void halve(const PlanOptions& options, const Budget& budget) {
    if (!can_halve(*lattice)) return;
    Searched first{std::move(lattice), nullptr};
    std::map<std::string, double> time_ms;
    const auto search = [&](Searched& level, const Searched* coarser, const Budget& time,
                            KnotSearch* known) {
      level.cost_to_go = make_cost_to_go(*level.lattice, pruning_of(*level.lattice), time);
      level.cost_to_go->set_single_use();
      if (coarser) take_from_coarser(*coarser, level, !options.hooks.cost);
      ask_about(*level.lattice, options, options.hooks, time);
      std::optional<EagerValidity> all;
      if (is_eager(options)) all.emplace(*level.lattice, *hooked, true, time);
      Counters counters;
      Found found =
          search_lazily(*level.cost_to_go, false, all ? static_cast<Validity&>(*all) : *hooked, {},
                        {}, options, counters, time_ms, known);
      add_counters(*validity, counters);
      add_counters(counters, alone_counters);
      return found;
    };
    FoundOnKnots found = search_on_knots(first, search, halve_steps, options, budget);
    hooked.reset();
    validity.reset();
    Searched& last = found.finer ? *found.finer : first;
    knots = found.knots;
    lattice = std::move(last.lattice);
    if (last.cost_to_go) alone_verdicts = std::move(last.cost_to_go->verdicts());
  }
  /// Returns the cost-to-go of the run with what its plan alone found out about nodes and edges.
  [[nodiscard]] std::unique_ptr<CostToGo> fresh_cost_to_go(const Budget& budget) const {
    auto fresh = make_cost_to_go(*lattice, Pruning::kNone, budget);
    fresh->set_single_use();
    if (!alone_verdicts) return fresh;
    std::vector<int> layers(static_cast<std::size_t>(lattice->layers()));
    std::iota(layers.begin(), layers.end(), 0);
    fresh->verdicts().take(*alone_verdicts, layers);
    return fresh;
  }

  /// Makes the cost-to-go of the bounds of all orders.
  void begin_bounds(const Budget& budget) {
    of_bounds = make_cost_to_go(*lattice, Pruning::kNone, budget);
    of_bounds->set_single_use();
    if (alone_verdicts) remove_from_bounds(alone_verdicts->removals());
  }
  /// Removes nodes and edges from the bounds of all orders, but for edges of steps that can be
  /// halved: a job in another order may have nodes between, and costs no less than by the edge.
  void remove_from_bounds(const Verdicts::Removals& removals) const {
    Verdicts& verdicts = of_bounds->verdicts();
    for (const auto& [layer, slots] : removals.nodes) verdicts.remove_nodes(layer, slots);
    for (const auto& [layer, edges] : removals.edges) {
      if (lattice->can_halve(layer)) continue;
      for (const auto& [a, b] : edges)
        if (verdicts.edge(layer, a, b) != Verdict::kRemoved) of_bounds->remove_edge(layer, a, b);
    }
  }

  StrokeRun run;
  PathProblem problem;
  const World* world;
  EdgeRule rule;
  ToolPath path;
  bool other_planes = false;  ///< arm angles are not measured from the path's own planes
  std::shared_ptr<Lattice> lattice;
  /// What is said of knots; none of a lattice whose steps cannot be halved.
  std::optional<LatticeInfo::Knots> knots;
  /// What the search of the job says of the steps between knots.
  KnotSearch narrow;
  std::optional<Verdicts> alone_verdicts;  ///< of the search of its plan alone, by halve()
  /// The run's cost-to-go in the job that was searched last. What that found out would change which
  /// ways around obstacles the next one finds: each begins with what the plan alone found out, as
  /// if it were the only one.
  std::shared_ptr<CostToGo> cost_to_go;
  bool of_this_job = false;  ///< cost_to_go is that of the job that is being searched
  /// The run's cost-to-go in the bounds of all orders, without what jobs in one order found out
  /// until they hand it over; null where there are none.
  std::unique_ptr<CostToGo> of_bounds;
  std::int64_t ik_nodes_before = 0, edges_before = 0;  // counts of cost_to_go before this search
  Counters alone_counters;                             // of halve(), until they are added
  Executor alone{1};
  std::optional<CollisionValidity> validity;
  std::optional<HookedValidity> hooked;
  std::optional<EagerValidity> eager;  ///< of an eager planner; what it knows holds in every job
  /// The plan of the run by itself, where it has no path.
  std::optional<Planner> alone_plan;
};

/// The runs of a job's strokes, each made when it is first asked for, and the worlds that they are
/// in. Jobs in several orders share them.
class JobRuns {
 public:
  /// `options`: whose hooks may tell the turns of a joint apart.
  JobRuns(const PreparedRobot& robot, const Problem& job, const PlanOptions& options,
          const Budget& budget)
      : robot_(robot),
        job_(job),
        options_(options),
        budget_(budget),
        turns_told_apart_(robot.arm_class().srs && may_tell_turns_apart(options.hooks)) {}

  /// Returns the world of the job's bodies with some limits. Runs with equal limits share it.
  const World& world_of(const Limits& limits, const PathProblem& problem) {
    for (const auto& [known, world] : worlds_)
      if (known == limits) return world;
    worlds_.emplace_back(
        limits, World(worlds_.empty() ? robot_.world() : worlds_.front().second, problem, budget_));
    return worlds_.back().second;
  }
  /// Returns runs in their order; those that are not known yet are made on the threads of
  /// `executor`. Throws InputError and Stopped.
  std::vector<std::shared_ptr<PlannedRun>> in_order(const std::vector<StrokeRun>& order,
                                                    Executor& executor) {
    std::vector<std::pair<StrokeRun, PathProblem>> missing;
    std::vector<const World*> worlds;
    for (const StrokeRun& run : order) {
      if (find(run)) continue;
      missing.emplace_back(run, problem_of_lattice(robot_, job_, run, options_.hooks));
      worlds.push_back(&world_of(missing.back().second.limits, missing.back().second));
    }
    std::vector<std::shared_ptr<PlannedRun>> made(missing.size());
    executor.for_each(static_cast<int>(missing.size()), [&](int k, int) {
      const auto i = static_cast<std::size_t>(k);
      PlannedRun& run =
          *(made[i] = std::make_shared<PlannedRun>(missing[i].first, std::move(missing[i].second),
                                                   robot_, *worlds[i], budget_));
      run.make_nodes(job_.arm().strokes[run.run.stroke], robot_, budget_);
      if (turns_told_apart_) run.lattice = with_all_windings(std::move(run.lattice));
      run.halve(options_, budget_);
    });
    known_.insert(known_.end(), made.begin(), made.end());
    std::vector<std::shared_ptr<PlannedRun>> runs;
    for (const StrokeRun& run : order) runs.push_back(find(run));
    return runs;
  }
  /// Returns a run like `run` with another lattice, which is no other job's: with more knots, or
  /// with turns of joints told apart, by which no path costs less than before.
  [[nodiscard]] std::shared_ptr<PlannedRun> with_lattice(const PlannedRun& run,
                                                         std::unique_ptr<Lattice> lattice) const {
    auto other = std::make_shared<PlannedRun>(run.run, run.problem, robot_, *run.world, budget_);
    other->other_planes = run.other_planes;
    other->lattice = std::move(lattice);
    other->knots = run.knots;
    return other;
  }

 private:
  [[nodiscard]] std::shared_ptr<PlannedRun> find(const StrokeRun& run) const {
    for (const auto& known : known_)
      if (known->run == run) return known;
    return nullptr;
  }
  const PreparedRobot& robot_;
  const Problem& job_;
  const PlanOptions& options_;
  const Budget& budget_;
  bool turns_told_apart_;
  std::deque<std::pair<Limits, World>> worlds_;  // by their limits; references stay valid
  std::vector<std::shared_ptr<PlannedRun>> known_;
};

class JobPlan {
 public:
  /// Prepares the plan of a job in an order of its strokes, reversible ones in the cheaper
  /// direction. With `one_branch`, no run of an S-R-S arm changes its
  /// branch.
  JobPlan(const PreparedRobot& robot, const Problem& job, const PlanOptions& options,
          const Budget& budget, std::shared_ptr<JobRuns> shared, std::vector<std::size_t> order,
          bool one_branch)
      : robot_(robot),
        shared_(std::move(shared)),
        order_(std::move(order)),
        chain_(robot.arm().chain),
        job_(job),
        transition_limits_(limits_of_transitions(job)),
        options_(options),
        budget_(budget),
        hooks_(options.hooks),
        executor_(threads_for(options)) {
    if (one_branch) hooks_.check = std::make_shared<KeepsBranch>(robot.srs());
  }

  /// Searches for a job that costs less than `most_cost` and proves it. The result has no parts
  /// where there is none, or where time ended its proof; finish() completes it.
  const Answer& search(double most_cost) {
    const TraceSpan span("plan job");
    most_cost_ = most_cost;
    result_.planner = to_string(options_.planner);
    result_.threads = executor_.threads();
    result_.arm().joint_names = chain_.joint_names;
    result_.arm().held = robot_.arm().held;
    try {
      Stopwatch watch;
      lay_out();
      result_.time_ms["lattice"] = watch.lap();
      find();
      result_.time_ms["find"] = watch.lap();
      if (!result_.arm().parts.empty())
        prove_answer(options_, budget_, result_, [&] {
          require_passed(
              check_job(robot_, job_, result_.arm().parts, {.margins = false, .budget = budget_}));
        });
    } catch (const Stopped&) {
      stopped_ = true;
      result_.status = stopped_status(budget_);
    }
    return result_;
  }
  /// Measures the job that was found, or finds out why there is none, as far as time allows.
  Answer finish() {
    if (stopped_) return std::move(result_);
    try {
      Stopwatch watch;
      explain();
      result_.time_ms["report"] = watch.lap();
    } catch (const Stopped&) {
    }
    return std::move(result_);
  }

  /// Returns whether time ended the search before there was a proved job or a verdict.
  [[nodiscard]] bool is_stopped() const { return stopped_; }
  /// Removes from the bounds of all orders what was removed from the runs.
  void hand_over_removals() const {
    for (const auto& directions : directions_)
      for (const auto& run : directions)
        if (run->of_bounds && run->cost_to_go)
          run->remove_from_bounds(run->cost_to_go->verdicts().removals());
  }
  /// Returns the runs that were found to have no path by themselves.
  [[nodiscard]] const std::vector<StrokeRun>& runs_without_path() const { return without_path_; }
  /// Returns what plan() found out about the runs, valid while this and the robot live; empty if it
  /// was stopped before there was a job or a verdict.
  [[nodiscard]] std::vector<PlanView> views() const {
    std::vector<PlanView> views;
    if (paths_.size() != runs_.size()) return views;
    for (std::size_t k = 0; k < runs_.size(); ++k) {
      const PlannedRun& run = *runs_[k];
      if (run.alone_plan)
        views.push_back(run.alone_plan->view());
      else
        views.push_back({robot_, run.problem, *run.lattice, *run.world, &searched_[k]->verdicts(),
                         paths_[k], run.problem.resolution});
    }
    return views;
  }

 private:
  [[nodiscard]] ParallelFor work() {
    return {executor_.threads(),
            [this](int parts, const auto& body) { executor_.for_each(parts, body); }};
  }

  void lay_out() {
    require_joints_that_move(robot_, job_.arm());
    require_home_within_limits();
    std::vector<StrokeRun> all;
    for (const std::size_t stroke : order_)
      for (const bool reversed : {false, true})
        if (!reversed || job_.arm().strokes[stroke].reversible) all.push_back({stroke, reversed});
    for (auto& run : shared_->in_order(all, executor_)) {
      run->of_this_job = false;
      if (!run->run.reversed) directions_.emplace_back();
      directions_.back().push_back(std::move(run));
    }
    for (const auto& directions : directions_) runs_.push_back(directions.front());
    PathProblem between = runs_.front()->problem;
    between.limits = transition_limits_;
    transition_world_ = &shared_->world_of(transition_limits_, between);
    describe();
  }
  /// Notes the warnings and the special pairs of all runs and of the transitions.
  void describe() {
    SpecialPairs pairs;
    add_lines(robot_warnings(robot_, job_.arm()), result_.warnings);
    for (const auto& run : runs_) {
      add_lines(unused_key_warnings(unused_keys(chain_, robot_.arm_class()), run->problem),
                result_.warnings);
      if (!run->lattice->has_layers_between())
        add_lines(unused_key_warnings(
                      unused_knot(hooks_.cost ? "jobs whose states cost something"
                                  : run->problem.limits.step_error ? "paths with limits.step_error"
                                  : run->problem.resolution.arcs   ? "paths with resolution.arcs"
                                                                   : "strokes in several runs"),
                      problem_of_run(job_, run->run)),
                  result_.warnings);
      add_lines(path_warnings(robot_, run->problem, run->path, *run->world), result_.warnings);
      pairs.add(*run->world);
    }
    add_lines(transition_world_->warnings(), result_.warnings);
    pairs.add(*transition_world_);
    result_.arm().dropped_pairs = std::move(pairs.dropped);
    result_.arm().reduced_pairs = std::move(pairs.reduced);
  }

  /// Searches until the joints of the cheapest job keep their limits without jumps of whole turns:
  /// lattices that treat a wide joint as a circle are replaced by such as tell its turns apart,
  /// where the job leaves its limits.
  void find() {
    share_circles();
    std::string turns;  // turns_note() of the first run that did not fit
    for (;;) {
      const std::shared_ptr<const PlannedRun> metric = runs_.front();  // outlives transitions
      JobTransitions transitions(robot_, *transition_world_, transition_limits_, *metric->lattice,
                                 distance_proofs(), executor_, options_.hooks.check, budget_);
      if (home_is_barred(transitions)) return;
      const JobOutcome outcome = search(transitions);
      take_directions(outcome);
      note(outcome, transitions);
      paths_ = outcome.paths;
      paths_.resize(runs_.size());
      searched_.clear();
      for (const auto& run : runs_) searched_.push_back(run->cost_to_go);
      if (outcome.paths.empty()) {
        if (!turns.empty()) result_.warnings.push_back(turns);
        return;
      }
      std::vector<Part> parts = parts_of(outcome, transitions);
      Lattice::Joints off = off_in_every_turn(parts, turns);
      if (off == Lattice::Joints{}) off = lift(parts, *runs_.front()->lattice, job_);
      if (off == Lattice::Joints{}) {
        take(outcome, std::move(parts));
        return;
      }
      for_each_direction([&](std::shared_ptr<PlannedRun>& run) {
        run = shared_->with_lattice(*run, run->lattice->with_windings(off));
      });
      for (std::size_t k = 0; k < runs_.size(); ++k) runs_[k] = directions_[k].front();
    }
  }
  template <class Body>
  void for_each_direction(const Body& body) {
    for (auto& directions : directions_)
      for (auto& run : directions) body(run);
  }
  /// Makes runs_ those of the job that was found. Where there is none, each stroke runs as it is
  /// listed, or backwards if it has a path only so.
  void take_directions(const JobOutcome& outcome) {
    without_path_.clear();
    for (std::size_t k = 0; k < runs_.size(); ++k) {
      std::size_t taken = 0;
      if (k < outcome.least_costs.size()) {
        const std::vector<double>& costs = outcome.least_costs[k];
        for (std::size_t run = 0; run < costs.size(); ++run)
          if (costs[run] == kUnreachable) without_path_.push_back(directions_[k][run]->run);
        if (costs.front() == kUnreachable && costs.back() != kUnreachable) taken = 1;
      }
      runs_[k] = directions_[k][outcome.runs.empty() ? taken : outcome.runs[k]];
    }
  }
  /// Makes parts the answer, with what their rows cost. Parts that a search which was stopped found
  /// are none; throws Stopped then.
  void take(const JobOutcome& outcome, std::vector<Part> parts) {
    std::size_t k = 0;
    for (Part& part : parts) {
      if (!part.run) continue;
      result_.arm().runs[k].lattice.cost = part.cost;
      part.cost = cost_of_rows(*runs_[k]->lattice, paths_[k], part.rows, part.cost);
      describe_knots(part.cost, *runs_[k]->lattice, paths_[k],
                     runs_[k]->problem.resolution.arc_of_nodes(), result_.arm().runs[k].lattice);
      result_.cost += part.cost - result_.arm().runs[k].lattice.cost;
      ++k;
    }
    result_.status = PlanStatus::kSolved;
    result_.arm().parts = std::move(parts);
    if (outcome.decided) return;
    withdraw(result_);
    throw Stopped();
  }
  /// Lets a joint be a circle in all runs or in none, since transitions lead from one to the next:
  /// a joint's largest move on a step, by which it can be a circle or not, may differ from stroke
  /// to stroke.
  void share_circles() {
    Lattice::Joints shared = bounded_circles(*runs_.front()->lattice);
    for_each_direction([&](const std::shared_ptr<PlannedRun>& run) {
      const Lattice::Joints own = bounded_circles(*run->lattice);
      for (std::size_t j = 0; j < kDof; ++j) shared[j] = shared[j] && own[j];
    });
    for_each_direction([&](std::shared_ptr<PlannedRun>& run) {
      Lattice::Joints more = bounded_circles(*run->lattice);
      for (std::size_t j = 0; j < kDof; ++j) more[j] = more[j] && !shared[j];
      if (more != Lattice::Joints{})
        run = shared_->with_lattice(*run, run->lattice->with_windings(more));
    });
    for (std::size_t k = 0; k < runs_.size(); ++k) runs_[k] = directions_[k].front();
  }
  /// Returns the circles that leave their limits along a run, whatever its turn; such runs have no
  /// rows. Puts turns_note() of the first into `note`, if that is empty.
  [[nodiscard]] Lattice::Joints off_in_every_turn(const std::vector<Part>& parts,
                                                  std::string& note) const {
    Lattice::Joints off{};
    std::size_t k = 0;
    for (const Part& part : parts) {
      if (!part.run) continue;
      const auto& run = *runs_[k];
      const SlotPath& path = paths_[k++];
      if (!part.rows.empty()) continue;
      const Lattice::Joints here = run.lattice->off_limits(path);
      for (std::size_t j = 0; j < kDof; ++j) off[j] = off[j] || here[j];
      if (!note.empty()) continue;
      note = turns_note(*run.lattice, path, here, run.problem, "job");
      if (!note.empty()) note = "stroke '" + job_.arm().strokes[run.run.stroke].name + "': " + note;
    }
    return off;
  }
  [[nodiscard]] DistanceProofs distance_proofs() const { return distance_proofs_of(options_); }
  /// Throws InputError if home is outside of the joints' limits.
  void require_home_within_limits() const {
    if (!job_.arm().home) return;
    for (std::size_t j = 0; j < kDof; ++j) {
      const double x = (*job_.arm().home)[static_cast<Eigen::Index>(j)];
      const JointLimit& limit = chain_.limit[j];
      bool none = limit.continuous || limit.wide() || (chain_.roll && j + 1 == kDof);
      const double lower = limit.lower + transition_limits_.joint_margin,
                   upper = limit.upper - transition_limits_.joint_margin;
      none = none || lower > upper;  // the fault of limits.joint_margin, which lattices refuse
      if (!none && !(x >= lower && x <= upper))
        throw InputError(job_.source, "home: joint '" + chain_.joint_names[j] + "' is at " +
                                          formatted(limit.slides ? "%.6g m" : "%.6g rad", x) +
                                          ": allowed is " +
                                          formatted("%.6g to %.6g", lower, upper));
    }
  }
  /// Returns true if the arm comes too near to something at home, and notes to what.
  bool home_is_barred(JobTransitions& transitions) {
    if (!job_.arm().home) return false;
    const auto bodies = transitions.barred(*job_.arm().home);
    if (bodies || !transitions.allows(*job_.arm().home, *job_.arm().home))
      result_.arm().no_transition = {
          .to = 0, .where = NoTransition::Where::kHome, .bodies = bodies};
    return result_.arm().no_transition.has_value();
  }

  /// Searches the runs' lattices and, as long as that is worth it, lattices whose narrow steps
  /// between knots (KnotSearch) are halved, and uneven_steps() of the answer. Returns the cheapest
  /// job of all, that of the coarsest of equal ones; directions_ are its runs. With a job it ends a
  /// while before the budget does.
  JobOutcome search(JobTransitions& transitions) {
    JobOutcome best = search_once(transitions, budget_);
    double least = row_cost(best);
    auto directions_of_best = directions_;
    for (JobOutcome last = best; is_worth_halving(last, least);) {
      try {
        const Budget time = best.paths.empty() ? budget_ : most_of(budget_, options_);
        halve_narrow_steps(time);
        last = search_once(transitions, time);
      } catch (const Stopped&) {
        last = {};
      }
      if (!last.decided && !last.narrow) {  // time is up
        for (auto& directions : directions_of_best)
          for (auto& run : directions)
            if (run->knots) run->knots->halved = false;
        if (best.paths.empty()) best = std::move(last), directions_of_best = directions_;
        break;
      }
      const double cost = row_cost(last);
      if (cost >= least && !best.paths.empty()) continue;
      best = last;
      least = cost;
      directions_of_best = directions_;
    }
    directions_ = std::move(directions_of_best);
    return best;
  }
  JobOutcome search_once(JobTransitions& transitions, const Budget& budget) {
    std::vector<SearchedStroke> searched(directions_.size());
    for_each_direction([&](const std::shared_ptr<PlannedRun>& run) {
      if (run->cost_to_go && run->of_this_job)
        run->cost_to_go->verdicts().forget_exit_costs();
      else
        run->cost_to_go = run->fresh_cost_to_go(budget);
      run->of_this_job = true;
      run->narrow = {};
      run->ik_nodes_before = run->cost_to_go->ik_nodes();
      run->edges_before = run->cost_to_go->edges();
      run->ask_about(*run->lattice, options_, hooks_, budget);
    });
    if (is_eager(options_)) ask_everything();
    for (std::size_t k = 0; k < directions_.size(); ++k)
      for (const auto& run : directions_[k])
        searched[k].runs.push_back(
            {run->cost_to_go.get(),
             run->eager ? static_cast<Validity*>(&*run->eager) : &*run->hooked,
             can_halve(*run->lattice) ? &run->narrow : nullptr});
    JobSearchOptions options;
    options.paths.batch = 8;
    options.work = work();
    options.most_cost = most_cost_;
    options.most_cost_of_any = may_be_halved();
    JobOutcome outcome = search_job(searched, transitions, job_.arm().home, options);
    for_each_direction([&](const std::shared_ptr<PlannedRun>& run) { add_counters(*run); });
    return outcome;
  }
  /// Adds the uneven_steps() of a job's runs to their narrow steps. Returns whether there are any.
  bool add_uneven_steps(const JobOutcome& outcome) {
    bool any = false;
    for (std::size_t k = 0; k < outcome.paths.size(); ++k) {
      PlannedRun& run = *directions_[k][outcome.runs[k]];
      const SlotPath& path = outcome.paths[k];
      const std::set<int> steps = uneven_steps(*run.lattice, path, run.lattice->path_rows(path));
      run.narrow.narrow.insert(steps.begin(), steps.end());
      any = any || !steps.empty();
    }
    return any;
  }
  /// Returns whether a lattice may have more knots in a later search of this job, which then may
  /// find cheaper ways around obstacles, too.
  [[nodiscard]] bool may_be_halved() {
    bool any = false;
    for_each_direction(
        [&](const std::shared_ptr<PlannedRun>& run) { any = any || can_halve(*run->lattice); });
    return any;
  }
  /// Returns the cost of the job's rows as far as turns of joints are told apart; kUnreachable
  /// where none was found.
  [[nodiscard]] double row_cost(const JobOutcome& outcome) const {
    if (outcome.paths.empty()) return kUnreachable;
    double cost = outcome.cost;
    for (std::size_t k = 0; k < directions_.size(); ++k) {
      const Lattice& lattice = *directions_[k][outcome.runs[k]]->lattice;
      const SlotPath& path = outcome.paths[k];
      cost += cost_of_rows(lattice, path, lattice.path_rows(path), outcome.run_costs[k]) -
              outcome.run_costs[k];
    }
    return cost;
  }
  /// Returns whether more knots may give a job where none was found, or a cheaper one than the
  /// best, which costs `least`.
  [[nodiscard]] bool is_worth_halving(const JobOutcome& last, double least) {
    // Chords cost no more than rows do.
    if (last.cost < least && add_uneven_steps(last)) return true;
    return last.narrow && (least == kUnreachable || least > kWorthHalving * last.narrow_from);
  }
  /// Replaces lattices by such as have their narrow steps halved. What is known of nodes and edges
  /// stays known.
  void halve_narrow_steps(const Budget& budget) {
    for_each_direction([&](std::shared_ptr<PlannedRun>& run) {
      if (run->narrow.narrow.empty()) return;
      const std::shared_ptr<PlannedRun> before = std::exchange(
          run, shared_->with_lattice(*run, run->lattice->with_knots(run->narrow.narrow, budget)));
      run->cost_to_go = run->fresh_cost_to_go(budget);
      take_verdicts(*before->cost_to_go, *run->cost_to_go);
      run->of_this_job = true;
    });
  }

  /// Asks about all nodes and edges of the runs, as the eager planners do before they search.
  void ask_everything() {
    std::vector<PlannedRun*> unasked;
    for_each_direction([&](const std::shared_ptr<PlannedRun>& run) {
      if (!run->eager) unasked.push_back(run.get());
    });
    executor_.for_each(static_cast<int>(unasked.size()), [&](int k, int) {
      PlannedRun& run = *unasked[static_cast<std::size_t>(k)];
      run.eager.emplace(*run.lattice, *run.hooked, options_.planner == PlannerKind::kEager,
                        budget_);
    });
  }

  /// Notes what a search did and found.
  void note(const JobOutcome& outcome, JobTransitions& transitions) {
    result_.arm().transitions.pairs += outcome.pairs;
    result_.arm().transitions.searches += outcome.searches;
    result_.arm().transitions.rounds += outcome.rounds;
    swivel::add_counters(transitions.counters(), result_.arm().counters);
    result_.bound = outcome.bound;
    result_.bound_any = outcome.bound_any;
    result_.bound_orders = 0;
    for (const std::vector<double>& costs : outcome.least_costs)
      result_.bound_orders += *std::min_element(costs.begin(), costs.end());
    result_.cost = result_.lattice_cost = outcome.paths.empty() ? 0 : outcome.cost;
    result_.arm().runs.clear();
    for (std::size_t k = 0; k < runs_.size(); ++k) {
      RunAnswer run;
      run.run = runs_[k]->run;
      run.lattice = info_of(*runs_[k]->lattice, robot_.arm_class());
      run.lattice.knots = runs_[k]->knots;
      if (k < outcome.least_costs.size()) {
        run.least_cost = outcome.least_costs[k][run.run.reversed ? 1 : 0];
        run.status = run.least_cost == kUnreachable ? PlanStatus::kInfeasible : PlanStatus::kSolved;
      } else {
        run.status = stopped_status(budget_);
      }
      result_.arm().runs.push_back(std::move(run));
    }
    note_no_transition(outcome, transitions);
    if (!outcome.decided && outcome.paths.empty()) throw Stopped();
  }
  void note_no_transition(const JobOutcome& outcome, JobTransitions& transitions) {
    result_.arm().no_transition.reset();
    if (!outcome.transition_without_way) return;
    NoTransition& none = result_.arm().no_transition.emplace();
    none.to = *outcome.transition_without_way;
    if (outcome.barred_end) {
      none.where = NoTransition::Where::kEndBefore;
      none.bodies = transitions.barred(*outcome.barred_end);
    } else if (outcome.barred_begin) {
      none.where = NoTransition::Where::kBegin;
      none.bodies = transitions.barred(*outcome.barred_begin);
    } else if (const auto& pair = outcome.pair_without_way) {
      none.bodies = transitions.barred((*pair)[0], (*pair)[1]);
    }
  }
  void add_counters(PlannedRun& run) {
    Counters& sum = result_.arm().counters;
    swivel::add_counters(std::exchange(run.alone_counters, {}), sum);
    sum.ik_nodes += run.cost_to_go->ik_nodes() - run.ik_nodes_before;
    sum.edges += run.cost_to_go->edges() - run.edges_before;
    swivel::add_counters(*run.validity, sum);
  }

  /// Returns the parts of the job that was found, with joints as the lattices have them.
  std::vector<Part> parts_of(const JobOutcome& outcome, JobTransitions& transitions) {
    std::vector<Part> parts;
    std::optional<Config> end = job_.arm().home;
    std::size_t next_cost = 0;
    const auto add_transition = [&](std::size_t k, const Config& to) {
      Part part;
      part.cost = outcome.transition_costs[next_cost++];
      for (const Config& q : transitions.way(static_cast<int>(k), *end, to)) {
        TrajectoryRow row;
        row.q = q;
        part.rows.push_back(row);
      }
      if (part.rows.size() > 2) part.barred_by = transitions.barred(*end, to);
      parts.push_back(std::move(part));
    };
    for (std::size_t k = 0; k < runs_.size(); ++k) {
      const Lattice& lattice = *runs_[k]->lattice;
      const SlotPath& path = outcome.paths[k];
      if (end) add_transition(k, *lattice.exact_config(0, path.front()));
      Part part;
      part.run = runs_[k]->run;
      part.cost = outcome.run_costs[k];
      part.rows = lattice.path_rows(path);
      if (!part.rows.empty()) require_same_turns(lattice, part.rows, runs_[k]->problem.source);
      if (runs_[k]->other_planes) measure_arm_angles(*runs_[k], part.rows);
      parts.push_back(std::move(part));
      end = *lattice.exact_config(lattice.layers() - 1, path.back());
    }
    if (job_.arm().home) add_transition(runs_.size(), *job_.arm().home);
    if (chain_.roll) join_rolls(parts);
    return parts;
  }

  /// Moves the rolls of transitions, which may change as they like, so that they lead from that of
  /// the row before to that of the row behind: rows of runs count them from the waypoints.
  static void join_rolls(std::vector<Part>& parts) {
    const auto roll_of_row = [](TrajectoryRow& row) -> double& { return row.q[kDof - 1]; };
    for (std::size_t k = 0; k < parts.size(); ++k) {
      std::vector<TrajectoryRow>& rows = parts[k].rows;
      if (parts[k].run || rows.empty()) continue;
      const auto gap = [&](std::size_t other, bool before) {
        if (other >= parts.size() || parts[other].rows.empty()) return 0.0;
        std::vector<TrajectoryRow>& beside = parts[other].rows;
        return before ? roll_of_row(beside.back()) - roll_of_row(rows.front())
                      : roll_of_row(beside.front()) - roll_of_row(rows.back());
      };
      const double begin = gap(k - 1, true), end = gap(k + 1, false);
      if (begin == 0 && end == 0) continue;
      const auto last = static_cast<double>(rows.size() - 1);
      for (std::size_t i = 0; i < rows.size(); ++i)
        roll_of_row(rows[i]) +=
            last > 0 ? begin + (end - begin) * static_cast<double>(i) / last : begin;
    }
  }

  /// Measures the arm angles of a run's rows from the planes of its own path, as everyone does who
  /// knows the run alone.
  void measure_arm_angles(const PlannedRun& run, std::vector<TrajectoryRow>& rows) const {
    const SrsArm& arm = *robot_.arm_class().srs;
    const std::vector<ArmPlane> planes = carried_planes(arm, run.path, budget_);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const double before = k > 0 ? rows[k - 1].phi : 0;
      rows[k].phi = before + wrap_angle(arm_angle(arm, planes[k], rows[k].q) - before);
    }
  }

  /// Measures the runs of a job, or finds out why there is none.
  void explain() {
    if (!result_.arm().parts.empty()) {
      const auto each = [this](const auto& visit) {
        std::size_t k = 0;
        for (const Part& part : result_.arm().parts)
          if (part.run) visit(part.rows, *runs_[k], result_.arm().runs[k]), ++k;
      };
      each([&](const auto&, const PlannedRun& run, Measures& measures) {
        ask_for(options_.evidence, !run.world->allowed().empty(), measures);
      });
      each([&](const std::vector<TrajectoryRow>& rows, const PlannedRun& run, Measures& measures) {
        measure_margins(chain_, run.path, rows, measures);
        measure_rows(robot_, run.path, *run.world, rows, options_.evidence, budget_, measures);
      });
      return;
    }
    for (std::size_t k = 0; k < result_.arm().runs.size(); ++k)
      if (result_.arm().runs[k].status == PlanStatus::kInfeasible) {
        PlanOptions alone = options_;
        alone.check = false;
        alone.timeout_s = budget_.seconds_left();
        // The pointer does not own the robot, which outlives the plan.
        Planner planner(std::shared_ptr<const PreparedRobot>(std::shared_ptr<void>(), &robot_),
                        runs_[k]->problem);
        PlanResult found = planner.plan(alone);
        const bool known = found.status == PlanStatus::kInfeasible;
        result_.arm().runs[k].diagnosis = diagnosis_alone(std::move(found));
        if (known) runs_[k]->alone_plan.emplace(std::move(planner));
      }
  }

  const PreparedRobot& robot_;
  std::shared_ptr<JobRuns> shared_;
  std::vector<std::size_t> order_;  // of strokes
  const Chain& chain_;
  const Problem& job_;
  Limits transition_limits_;
  const PlanOptions& options_;
  Budget budget_;
  Hooks hooks_;
  Executor executor_;
  double most_cost_ = kUnreachable;
  bool stopped_ = false;  // before there was a proved job or a verdict
  const World* transition_world_ = nullptr;
  std::vector<std::vector<std::shared_ptr<PlannedRun>>> directions_;  // by place in the order
  std::vector<std::shared_ptr<PlannedRun>> runs_;                     // the directions taken
  std::vector<StrokeRun> without_path_;
  std::vector<SlotPath> paths_;  // of the runs, empty where there is no job
  // what the runs had in this job; in jobs of other orders they get others
  std::vector<std::shared_ptr<CostToGo>> searched_;
  Answer result_;
};

std::vector<StrokeRun> given_order(const Problem& job) {
  std::vector<StrokeRun> order;
  for (std::size_t k = 0; k < job.arm().strokes.size(); ++k) order.push_back({k, false});
  return order;
}

std::vector<std::size_t> strokes_of(const std::vector<StrokeRun>& order) {
  std::vector<std::size_t> strokes;
  for (const StrokeRun& run : order) strokes.push_back(run.stroke);
  return strokes;
}

/// Plans a job in its given order, or in the cheapest that is found. Of a few strokes all orders
/// are bounded, and those planned whose bound is less than the cost of the best job, the least
/// bound first, so that none can be cheaper at the end. Of more strokes the cheapest order by
/// estimate is planned, then orders that differ from the best so far by one move, the cheapest by
/// estimate first, and all of these from the last stroke to the first.
class OrderSearch {
 public:
  /// Keeps the plan of the best job for `view`, unless that is null.
  OrderSearch(const PreparedRobot& robot, const Problem& job, const PlanOptions& options,
              const Budget& budget, bool one_branch, ProblemView* view)
      : robot_(robot),
        job_(job),
        options_(options),
        budget_(budget),
        one_branch_(one_branch),
        view_(view),
        executor_(threads_for(options)),
        runs_(std::make_shared<JobRuns>(robot, job, options, budget)) {}

  Answer plan() {
    Stopwatch watch;
    const bool any_order = job_.arm().order == StrokeOrder::kBest;
    if (any_order) {
      try {
        if (job_.arm().strokes.size() <= kMostBounded) {
          search_all();
        } else {
          estimate();
          take(cheapest_order(costs_, budget_));
          improve();
        }
      } catch (const Stopped&) {  // the best job so far is the answer, or else the given order
      }
    }
    if (!best_ || best_cost_ == kUnreachable) take(given_order(job_));
    const double searched_ms = watch.lap();
    Answer found = best_->finish();
    found.arm().counters = counters_;
    found.arm().transitions = transitions_;
    found.bound_orders = any_order ? bound_of_orders(found) : found.bound;
    if (any_order) {  // besides the stages of the best job
      double& order_ms = found.time_ms["order"] = searched_ms;
      for (const auto& [stage, ms] : found.time_ms)
        if (stage != "order" && stage != "report") order_ms = std::max(0.0, order_ms - ms);
    }
    if (view_ != nullptr) view_->runs = best_->views(), view_->owner = best_;
    return found;
  }

 private:
  /// Most strokes of jobs whose orders are all bounded, and of those of which all orders are
  /// planned that may be cheaper: there are no more than kMostOrders.
  static constexpr std::size_t kMostBounded = 12, kMostExact = 5;
  /// Most orders that are planned of so few strokes, of more strokes, and while none has a job.
  static constexpr std::size_t kMostOrders = 120, kMostOrdersOfMany = 20, kMostWithoutJob = 8;
  /// So many orders that may be cheaper are planned before bounds are made anew.
  static constexpr std::size_t kAtOnce = 4;

  [[nodiscard]] ParallelFor work() {
    return {executor_.threads(),
            [this](int parts, const auto& body) { executor_.for_each(parts, body); }};
  }
  void estimate() { costs_ = estimate_order_costs(robot_, job_, work(), budget_); }

  /// Returns a lower bound of jobs in all orders. Before there is one of the orders that were not
  /// planned, it is what the strokes cost by themselves.
  [[nodiscard]] double bound_of_orders(const Answer& found) const {
    return std::min({std::max(found.bound_orders, bound_), bound_of_planned_, found.lattice_cost});
  }
  /// Plans orders until none that is left can be cheaper than the best job, or many were planned.
  void search_all() {
    OrderBounds bounds = bounds_of_orders();
    const std::size_t most =
        job_.arm().strokes.size() <= kMostExact ? kMostOrders : kMostOrdersOfMany;
    for (bool divides = true;;) {
      const OrderProgram program(bounds.graph(), budget_);
      const std::vector<std::vector<StrokeRun>> open = open_orders(program);
      if (open.empty() || planned_.size() >= most) break;
      const bool many = open.size() > kAtOnce;
      for (std::size_t k = 0; k < (many && divides ? 1 : kAtOnce); ++k) {
        const auto next = next_of(open);
        if (!next) break;
        take(*next);
        if (last_->is_stopped()) throw Stopped();  // bound_ is of this order, too
        last_->hand_over_removals();
      }
      if (best_cost_ == kUnreachable && (no_way_.empty() || planned_.size() >= kMostWithoutJob))
        return;
      divides = many && best_cost_ != kUnreachable && bounds.divide(program.uses(), best_cost_);
      if (!divides) bounds.take_removals();
    }
    if (bound_ < best_cost_ && !was_planned(given_order(job_))) take(given_order(job_));
  }
  [[nodiscard]] OrderBounds bounds_of_orders() {
    const std::vector<Stroke>& strokes = job_.arm().strokes;
    std::vector<StrokeRun> all;
    for (std::size_t k = 0; k < strokes.size(); ++k)
      for (const bool reversed : {false, true})
        if (!reversed || strokes[k].reversible) all.push_back({k, reversed});
    std::vector<CostToGo*> values(2 * strokes.size());
    const auto runs = runs_->in_order(all, executor_);
    for (const auto& run : runs) {
      run->begin_bounds(budget_);
      values[2 * run->run.stroke + (run->run.reversed ? 1 : 0)] = run->of_bounds.get();
    }
    budget_.tell(Stage::kSearch);
    // Joints that are circles in all runs are circles of the first.
    return OrderBounds(values, job_.arm().home, *runs.front()->lattice, work(), budget_);
  }
  /// Returns orders whose bound is less than the cost of the best job and that were not planned,
  /// the cheapest first, and takes the least bound of all of these.
  [[nodiscard]] std::vector<std::vector<StrokeRun>> open_orders(const OrderProgram& program) {
    constexpr std::size_t kMostListed = 50;
    std::vector<std::vector<StrokeRun>> open;
    double bound = best_cost_;
    for (const BoundedOrder& order :
         program.cheaper_than(best_cost_, kMostListed + planned_.size())) {
      std::vector<StrokeRun> runs;
      for (const std::size_t stroke : order.strokes) runs.push_back({stroke, false});
      if (was_planned(runs)) continue;
      bound = std::min(bound, order.cost);
      open.push_back(std::move(runs));
    }
    bound_ = bound;
    return open;
  }
  /// Returns the first order that was not planned, as long as no job is known the first without
  /// neighbours between which no transition was found, if there is one.
  [[nodiscard]] std::optional<std::vector<StrokeRun>> next_of(
      const std::vector<std::vector<StrokeRun>>& open) const {
    const std::vector<StrokeRun>* first = nullptr;
    for (const std::vector<StrokeRun>& order : open) {
      if (was_planned(order)) continue;
      if (first == nullptr) first = &order;
      if (best_cost_ != kUnreachable) break;
      bool any = false;
      for (std::size_t k = 0; k <= order.size(); ++k)
        any = any || no_way_.contains(neighbours(order, k));
      if (!any) return order;
    }
    return first == nullptr ? std::nullopt : std::optional(*first);
  }
  /// Returns the strokes before and after a transition of an order; the number of strokes: home.
  [[nodiscard]] static std::pair<std::size_t, std::size_t> neighbours(
      const std::vector<StrokeRun>& order, std::size_t transition) {
    return {transition > 0 ? order[transition - 1].stroke : order.size(),
            transition < order.size() ? order[transition].stroke : order.size()};
  }

  /// Plans in an order of strokes and keeps the job if it is the cheapest so far. Estimates, if
  /// there are some, then know which runs have no path by themselves.
  void take(const std::vector<StrokeRun>& order) {
    const auto plan = std::make_shared<JobPlan>(robot_, job_, options_, budget_, runs_,
                                                strokes_of(order), one_branch_);
    const Answer& found = plan->search(best_cost_);
    add(found);
    last_ = plan;
    if (const auto& none = found.arm().no_transition;
        none && none->where != NoTransition::Where::kHome)
      no_way_.insert(neighbours(order, none->to));
    if (found.has_rows()) bound_of_planned_ = std::min(bound_of_planned_, found.bound);
    if (!best_ || (!found.arm().parts.empty() && found.lattice_cost < best_cost_)) {
      best_ = plan;
      best_order_ = order;
      if (!found.arm().parts.empty()) {
        best_cost_ = found.lattice_cost;
        for (std::size_t k = 0; k < order.size(); ++k) best_order_[k] = found.arm().runs[k].run;
      }
    }
    planned_.push_back(order);
    if (!costs_.first.empty())
      for (const StrokeRun& run : plan->runs_without_path()) forbid(run);
  }
  /// Plans the given order and orders that differ by one move from the best one, as many as are
  /// likely to find a cheaper job: estimates, which know no obstacles, are off by some per cent.
  void improve() {
    constexpr int kMostNeighbours = 16;
    if (best_cost_ == kUnreachable) return;
    take_both_ways(planned_.front());
    take_both_ways(given_order(job_));
    for (int k = 0; k < kMostNeighbours; ++k) {
      const auto next = cheapest_neighbour(costs_, best_order_, planned_, budget_);
      if (!next) return;
      take_both_ways(*next);
    }
  }
  /// Plans the job in an order of its strokes and in the reversed order, if these were not planned
  /// yet.
  void take_both_ways(std::vector<StrokeRun> order) {
    for (int way = 0; way < 2; ++way) {
      if (!was_planned(order)) take(order);
      std::reverse(order.begin(), order.end());
      for (StrokeRun& run : order) run.reversed = !run.reversed;
    }
  }
  /// Adds what one search did to what all did.
  void add(const Answer& found) {
    add_counters(found.arm().counters, counters_);
    transitions_.pairs += found.arm().transitions.pairs;
    transitions_.searches += found.arm().transitions.searches;
    transitions_.rounds += found.arm().transitions.rounds;
  }
  [[nodiscard]] bool was_planned(const std::vector<StrokeRun>& order) const {
    return std::any_of(planned_.begin(), planned_.end(),
                       [&](const auto& other) { return strokes_of(other) == strokes_of(order); });
  }
  void forbid(const StrokeRun& run) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const std::size_t k = 2 * run.stroke + (run.reversed ? 1 : 0);
    costs_.first[k] = costs_.last[k] = kNever;
    costs_.follow[k].assign(costs_.follow[k].size(), kNever);
    for (std::vector<double>& next : costs_.follow) next[k] = kNever;
  }

  const PreparedRobot& robot_;
  const Problem& job_;
  const PlanOptions& options_;
  const Budget& budget_;
  bool one_branch_;
  ProblemView* view_;
  Executor executor_;
  std::shared_ptr<JobRuns> runs_;
  OrderCosts costs_;
  std::shared_ptr<JobPlan> best_, last_;
  std::vector<StrokeRun> best_order_;
  double best_cost_ = kUnreachable;
  double bound_ = 0;                                      // of orders that were not planned
  std::set<std::pair<std::size_t, std::size_t>> no_way_;  // neighbours() without a transition
  double bound_of_planned_ = kUnreachable;
  std::vector<std::vector<StrokeRun>> planned_;  // orders, all so far
  Counters counters_;                            // of all searches, like the next
  TransitionCounters transitions_;
};

/// Throws InvalidArgument for a cost of the caller's own of a job that does not take one.
void require_cost_supported(const Problem& job, const Hooks& hooks) {
  if (!hooks.cost) return;
  if (job.arm().lift)
    throw InvalidArgument(
        "lift: is not supported beside a cost of states: allowed is one of the two");
  for (const Stroke& stroke : job.arm().strokes)
    if (stroke.closed)
      throw InvalidArgument(
          "closed: is not supported beside a cost of states: allowed is one of the two");
}

}  // namespace

Answer plan_strokes(const PreparedRobot& robot, const Problem& job, const PlanOptions& options,
                    const Budget& budget, bool one_branch, ProblemView* view) {
  require_cost_supported(job, options.hooks);
  return plan_with_lift_offs(
      robot, job, options, budget, view, [&](const Problem& one, ProblemView* its_view) {
        return OrderSearch(robot, one, options, budget, one_branch, its_view).plan();
      });
}

}  // namespace swivel
