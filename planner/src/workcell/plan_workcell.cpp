// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/workcell/plan_workcell.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "measure/measure_rows.hpp"
#include "plan/answer.hpp"
#include "plan/layout/told_turns.hpp"
#include "plan/require_no_hooks.hpp"
#include "plan/search.hpp"
#include "plan/search_settings.hpp"
#include "plan/stopwatch.hpp"
#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/kinds/unused_keys.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/graph/eager/eager_validity.hpp"
#include "swivel/graph/search/pair_search.hpp"
#include "swivel/parallel/executor.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/plan/problem_view.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/check_workcell.hpp"
#include "validity/collision_validity.hpp"
#include "workcell/arm_in_cell.hpp"
#include "workcell/between_arms.hpp"
#include "workcell/plan_and_measure.hpp"

namespace swivel {

namespace {

/// One arm with what its search needs. It is searched by one thread at a time.
struct PlannedArm : ArmInCell {
  PlannedArm(const PreparedWorkcell& prepared, std::size_t arm, const Budget& budget)
      : ArmInCell(prepared, arm, budget) {
    require_joints_that_move(robot, problem);
  }
  std::unique_ptr<CostToGo> cost_to_go;
  Executor alone{1};
  GivenValidity sound;                        // of an arm whose motion is given
  std::optional<CollisionValidity> validity;  // of an arm that is planned
  std::optional<EagerValidity> eager;         // of an arm that an eager planner plans
  /// What was found out about its nodes by all searches of the lattice; for a view alone.
  std::optional<Verdicts> noted;
  /// The path that a view shows: the answer, or else that of the arm by itself.
  std::vector<int> shown;
  /// Has planned the arm by itself, where it has no path.
  std::unique_ptr<Planner> without_path;
  PairArm in_pair() {
    if (eager) return {cost_to_go.get(), &*eager};
    return {cost_to_go.get(), is_given ? static_cast<Validity*>(&sound) : &*validity};
  }
  [[nodiscard]] PlanView view() const {
    if (without_path) return without_path->view();
    return {robot, problem, *lattice, world, &*noted, shown, of_lattice.resolution};
  }
};
using PlannedArms = std::array<std::unique_ptr<PlannedArm>, 2>;

/// Throws InputError if the given motion does not keep the limits of its arm by itself.
void require_sound(const PreparedWorkcell& prepared, const Budget& budget) {
  if (const auto fault = fault_of_given_motion(prepared, budget))
    throw InputError(prepared.problem(*prepared.given_arm()).source,
                     "given motion: " + *fault +
                         ": allowed is a motion that keeps the limits; `limits` of the arm may be "
                         "wider than the file's");
}

class WorkcellPlan {
 public:
  /// `view`: filled with what was found out, or null.
  WorkcellPlan(const PreparedWorkcell& prepared, const PlanOptions& options, const Budget& budget,
               ProblemView* view)
      : prepared_(prepared),
        options_(options),
        budget_(budget),
        executor_(threads_for(options)),
        view_(view) {}

  /// `explained`: whether the trajectories are measured, or arms without a path diagnosed.
  Answer plan(bool explained) {
    const TraceSpan span("plan workcell");
    result_.planner = to_string(options_.planner);
    result_.threads = executor_.threads();
    result_.arms.assign(2, {});
    for (std::size_t k = 0; k < 2; ++k) {
      result_.arms[k].name = prepared_.name(k);
      result_.arms[k].given = prepared_.given_arm() == k;
      result_.arms[k].runs.emplace_back();
    }
    try {
      Stopwatch watch;
      lay_out();
      result_.time_ms["lattice"] = watch.lap();
      search();
      result_.time_ms["search"] = watch.lap();
      result_.time_ms["plan"] = result_.time_ms["lattice"] + result_.time_ms["search"];
      if (result_.has_rows())
        prove_answer(options_, budget_, result_, [&] {
          require_passed(check_workcell(prepared_, rows_of_arms(result_),
                                        {.margins = false, .budget = budget_}));
        });
      watch.lap();
      if (explained) {
        explain();
        result_.time_ms["report"] = watch.lap();
      }
      if (view_) give_view();
    } catch (const Stopped&) {
      if (!result_.has_rows()) result_.status = stopped_status(budget_);
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] DistanceProofs distance_proofs() const { return distance_proofs_of(options_); }
  [[nodiscard]] ParallelFor work() {
    return {executor_.threads(),
            [this](int parts, const auto& body) { executor_.for_each(parts, body); }};
  }

  void lay_out() {
    const auto given = prepared_.given_arm();
    executor_.for_each(2, [&](int arm, int) {
      const auto k = static_cast<std::size_t>(arm);
      if (given == k) require_sound(prepared_, budget_);
      arms_[k] = std::make_unique<PlannedArm>(prepared_, k, budget_);
    });
    if (arms_[0]->path.size() != arms_[1]->path.size())  // one of them is cut off
      throw InputError(prepared_.problem(0).source,
                       "a path leads far beyond its arm's reach: are these millimetres? Lengths "
                       "are read as metres");
    for (std::size_t k = 0; k < 2; ++k) describe(*arms_[k], result_.arms[k]);
    result_.warnings = prepared_.between().warnings();
    warn_of_unused_keys();
    if (!given) return;
    const PlannedArm& planned = *arms_[1 - *given];
    if (const std::string warning =
            long_step_warning(planned.path, planned.problem.resolution, prepared_.name(1 - *given));
        !warning.empty())
      result_.warnings.push_back(warning);
  }
  /// Warns of keys that are given in vain: a key of one arm may stand with both.
  void warn_of_unused_keys() {
    std::array<std::vector<UnusedKey>, 2> unused;
    for (std::size_t k = 0; k < 2; ++k)
      unused[k] = unused_keys(arms_[k]->robot.arm().chain, arms_[k]->robot.arm_class());
    const auto keys = unused_by_both(unused[0], unused[1]);
    for (std::size_t k = 0; k < 2; ++k)
      for (const auto& vain : {keys, unused_knot("arms of two")})
        add_lines(unused_key_warnings(vain, arms_[k]->problem), result_.arms[k].warnings);
  }
  void describe(const PlannedArm& arm, ArmAnswer& result) const {
    const Chain& chain = arm.robot.arm().chain;
    result.joint_names = chain.joint_names;
    result.held = arm.robot.arm().held;
    result.warnings = robot_warnings(arm.robot, arm.problem);
    for (std::string& line : path_warnings(arm.robot, arm.problem, arm.path, arm.world))
      result.warnings.push_back(std::move(line));
    SpecialPairs pairs;
    pairs.add(arm.world);
    result.dropped_pairs = std::move(pairs.dropped);
    result.reduced_pairs = std::move(pairs.reduced);
  }

  /// Searches until the joints of both answers keep their limits without jumps of whole turns.
  void search() {
    for (;;) {
      make_searched();
      BetweenArms between(prepared_.between(), {arms_[0]->lattice.get(), arms_[1]->lattice.get()},
                          {arms_[0]->robot.radii(), arms_[1]->robot.radii()}, asks_moves(),
                          distance_proofs(), budget_);
      PairSearchOptions options;
      options.paths.batch = 8;
      options.work = work();
      for (std::size_t k = 0; view_ && k < 2; ++k)
        options.noted[k] = &arms_[k]->noted.emplace(*arms_[k]->lattice);
      const PairOutcome outcome =
          search_pair({arms_[0]->in_pair(), arms_[1]->in_pair()}, between, options);
      note(outcome, between);
      if (view_) note_for_view(outcome);
      if (outcome.paths[0].empty()) {
        for (std::size_t k = 0; k < 2; ++k)
          if (!turns_[k].empty()) result_.arms[k].warnings.push_back(turns_[k]);
        return;
      }
      if (tell_turns_apart(outcome)) continue;
      for (std::size_t k = 0; k < 2; ++k) {
        const Lattice& lattice = *arms_[k]->lattice;
        Part part{.run = StrokeRun(), .rows = lattice.path_rows(outcome.paths[k])};
        require_same_turns(lattice, part.rows, arms_[k]->problem.source);
        part.cost = cost_of_rows(lattice, outcome.paths[k], part.rows, outcome.costs[k]);
        result_.cost += part.cost - outcome.costs[k];
        result_.arms[k].run().lattice.cost = outcome.costs[k];
        result_.arms[k].parts.push_back(std::move(part));
      }
      result_.status = PlanStatus::kSolved;
      if (outcome.decided()) return;
      withdraw(result_);
      throw Stopped();
    }
  }
  [[nodiscard]] bool asks_moves() const {
    return std::any_of(arms_.begin(), arms_.end(), [](const auto& arm) {
      return arm->problem.limits.edges == EdgeMode::kContinuous;
    });
  }
  void make_searched() {
    executor_.for_each(2, [&](int k, int) {
      PlannedArm& arm = *arms_[static_cast<std::size_t>(k)];
      arm.eager.reset();
      arm.validity.reset();
      arm.cost_to_go = make_cost_to_go(*arm.lattice, pruning_of(*arm.lattice), budget_);
      if (arm.is_given) return;
      arm.validity.emplace(*arm.lattice, arm.world, arm.rule, arm.problem.limits.edges,
                           distance_proofs(), arm.alone, 1, budget_);
      if (is_eager(options_))
        arm.eager.emplace(*arm.lattice, *arm.validity, options_.planner == PlannerKind::kEager,
                          budget_);
    });
  }
  /// Replaces the lattice of an arm whose answer leaves the limits of joints that the lattice
  /// treats as circles by one that tells their turns apart. Returns true if there was one.
  bool tell_turns_apart(const PairOutcome& outcome) {
    bool any = false;
    for (std::size_t k = 0; k < 2; ++k) {
      const Lattice::Joints off = arms_[k]->lattice->off_limits(outcome.paths[k]);
      if (off == Lattice::Joints{}) continue;
      if (turns_[k].empty())
        turns_[k] = turns_note(*arms_[k]->lattice, outcome.paths[k], off, arms_[k]->problem,
                               "pair of paths");
      arms_[k]->eager.reset();
      arms_[k]->validity.reset();
      arms_[k]->cost_to_go.reset();
      arms_[k]->noted.reset();
      arms_[k]->lattice = arms_[k]->lattice->with_windings(off);
      any = true;
    }
    return any;
  }

  void note(const PairOutcome& outcome, BetweenArms& between) {
    result_.cost = result_.lattice_cost = outcome.paths[0].empty() ? 0 : outcome.cost;
    result_.bound = result_.bound_any = result_.bound_orders = outcome.bound;
    PairAnswer& pair = result_.pair;
    pair.decided_by = static_cast<PairSearch>(outcome.decided_by);
    pair.counters.rounds += outcome.rounds;
    pair.counters.pops += outcome.pops;
    pair.counters.node_pairs += outcome.node_pairs;
    pair.counters.move_pairs += outcome.move_pairs;
    for (std::size_t k = 0; k < 2; ++k) {
      count(*arms_[k], result_.arms[k]);
      RunAnswer& run = result_.arms[k].run();
      run.least_cost = outcome.least_costs[k];
      run.status = run.least_cost == kUnreachable ? PlanStatus::kInfeasible : PlanStatus::kSolved;
    }
    if (!outcome.decided() && outcome.paths[0].empty()) throw Stopped();
    result_.pair.conflict.reset();
    if (outcome.decided() && outcome.paths[0].empty() && !outcome.tree.empty() &&
        outcome.tree.front().region)
      note_conflict(*outcome.tree.front().region, outcome.alone, between);
  }
  void count(const PlannedArm& arm, ArmAnswer& result) const {
    Counters& sum = result.counters;
    sum.ik_nodes += arm.cost_to_go->ik_nodes();
    sum.edges += arm.cost_to_go->edges();
    if (arm.validity) add_counters(*arm.validity, sum);
    result.run().lattice = info_of(*arm.lattice, arm.robot.arm_class());
  }
  /// Notes where and by which bodies the arms bar each other on their cheapest paths, which meet in
  /// a region.
  void note_conflict(const ConflictRegion& region, const std::array<SlotPath, 2>& paths,
                     BetweenArms& between) {
    ArmConflict& conflict = result_.pair.conflict.emplace();
    conflict.layer = region.layer;
    conflict.of_motion = region.of_moves;
    std::optional<BodyPair> pair;
    if (region.of_moves) {
      MovePair moves{.layer = region.layer};
      for (std::size_t k = 0; k < 2; ++k) {
        moves.moves[k] = region.moves[k].front();
        moves.from[k] = *arms_[k]->lattice->node(region.layer, moves.moves[k].from);
        moves.to[k] = *arms_[k]->lattice->node(region.layer + 1, moves.moves[k].to);
      }
      pair = between.barred(moves);
    } else {
      NodePair nodes{.layer = region.layer};
      for (std::size_t k = 0; k < 2; ++k) {
        nodes.slots[k] = paths[k][static_cast<std::size_t>(region.layer)];
        nodes.q[k] = *arms_[k]->lattice->node(region.layer, nodes.slots[k]);
      }
      pair = between.barred(nodes);
    }
    if (pair) conflict.bodies = prepared_.between().names(*pair);
    for (std::size_t k = 0; k < 2; ++k) conflict.s[k] = arms_[k]->path.layer(region.layer).s;
  }

  /// Measures the trajectories, or finds out why an arm has no path by itself.
  void explain() {
    if (result_.has_rows()) {
      const auto& arms = result_.arms;
      for (std::size_t k = 0; k < 2; ++k)
        ask_for(options_.evidence, !arms_[k]->world.allowed().empty(), result_.arms[k].run());
      for (std::size_t k = 0; k < 2; ++k) {
        RunAnswer& run = result_.arms[k].run();
        measure_margins(arms_[k]->robot.arm().chain, arms_[k]->path, arms[k].rows(), run);
        measure_rows(arms_[k]->robot, arms_[k]->path, arms_[k]->world, arms[k].rows(),
                     options_.evidence, budget_, run);
      }
      if (options_.evidence.postures) measure_between_arms(prepared_, budget_, result_);
      return;
    }
    for (std::size_t k = 0; k < 2; ++k) {
      ArmAnswer& arm = result_.arms[k];
      if (arm.run().status != PlanStatus::kInfeasible) continue;
      PlanOptions alone = options_;
      alone.check = false;
      alone.timeout_s = budget_.seconds_left();
      // The pointer does not own the robot, which outlives the plan.
      auto planner = std::make_unique<Planner>(
          std::shared_ptr<const PreparedRobot>(std::shared_ptr<void>(), &prepared_.robot(k)),
          prepared_.problem(k));
      PlanResult found = planner->plan(alone);
      const bool known = found.status == PlanStatus::kInfeasible;
      if (!found.partial.empty())
        arm.partial = {{.run = StrokeRun(), .rows = std::move(found.partial)}};
      arm.run().diagnosis = diagnosis_alone(std::move(found));
      if (view_ && known) arms_[k]->without_path = std::move(planner);
    }
  }
  void note_for_view(const PairOutcome& outcome) {
    view_->alone = outcome.alone;
    view_->region.reset();
    for (std::size_t k = 0; k < 2; ++k)
      arms_[k]->shown = outcome.paths[k].empty() ? outcome.alone[k] : outcome.paths[k];
    if (outcome.tree.empty() || !outcome.tree.front().region) return;
    const ConflictRegion& region = *outcome.tree.front().region;
    view_->region = {region.layer, region.slots, {}};
    for (std::size_t k = 0; k < 2; ++k)
      for (const SlotMove& move : region.moves[k]) {
        view_->region->slots[k].push_back(move.from);
        view_->region->next[k].push_back(move.to);
      }
  }
  /// Hands both arms over to the view.
  void give_view() {
    const auto owner = std::make_shared<PlannedArms>(std::move(arms_));
    for (const auto& arm : *owner) {
      arm->eager.reset();
      arm->validity.reset();
      arm->cost_to_go.reset();
      view_->runs.push_back(arm->view());
    }
    view_->owner = owner;
  }

  const PreparedWorkcell& prepared_;
  const PlanOptions& options_;
  Budget budget_;
  Executor executor_;
  ProblemView* view_;
  PlannedArms arms_;
  std::array<std::string, 2> turns_;  // turns_note() of each arm's first path that did not fit
  Answer result_;
};

}  // namespace

std::optional<std::string> fault_of_given_motion(const PreparedWorkcell& prepared,
                                                 const Budget& budget) {
  const auto arm = prepared.given_arm();
  if (!arm) return std::nullopt;
  const CheckResult found =
      check_trajectory(prepared.robot(*arm), prepared.problem(*arm), prepared.given_rows(),
                       {.margins = false, .budget = budget});
  if (found.passed) return std::nullopt;
  std::string more;
  if (found.failure_count > 1)
    more = formatted(" (and %lld more)", static_cast<long long>(found.failure_count - 1));
  return found.failures.front() + more;
}

void measure_workcell(const PreparedWorkcell& prepared, const Evidence& wanted,
                      const Budget& budget, Answer& result) {
  for (std::size_t k = 0; k < 2; ++k)
    ask_for(wanted, !prepared.robot(k).world().allowed().empty(), result.arms[k].run());
  for (std::size_t k = 0; k < 2; ++k) {
    const PreparedRobot& robot = prepared.robot(k);
    const PathProblem& problem = prepared.problem(k);
    const ToolPath path = path_within_scale(problem, robot.arm().chain, budget);
    ArmAnswer& arm = result.arms[k];
    measure_margins(robot.arm().chain, path, arm.rows(), arm.run());
    measure_rows(robot, path, World(robot.world(), problem, budget), arm.rows(), wanted, budget,
                 arm.run());
  }
  if (wanted.postures) measure_between_arms(prepared, budget, result);
}

void measure_between_arms(const PreparedWorkcell& prepared, const Budget& budget, Answer& result) {
  InterArmWorld::Query query(prepared.between());
  std::optional<LeastMargin>& nearest = result.pair.nearest;
  nearest.reset();
  result.pair.measured = false;
  const std::vector<TrajectoryRow>&first = result.arms[0].rows(), &second = result.arms[1].rows();
  for (std::size_t row = 0; row < first.size(); ++row) {
    budget.poll();
    const auto found = query.clearance({first[row].q, second[row].q});
    if (!found) break;
    if (nearest && found->margin() >= nearest->margin) continue;
    nearest = {found->margin(), found->distance, found->required,
               prepared.between().names(found->pair), static_cast<int>(row)};
  }
  result.pair.measured = true;
}

Answer plan_workcell(const PreparedWorkcell& prepared, const PlanOptions& options,
                     ProblemView* view) {
  require_no_hooks(options);
  if (view) *view = {};
  return WorkcellPlan(prepared, options, options.budget(), view).plan(true);
}

Answer decide_workcell(const PreparedWorkcell& prepared, const PlanOptions& options,
                       const Budget& budget) {
  require_no_hooks(options);
  return WorkcellPlan(prepared, options, budget, nullptr).plan(false);
}

Answer plan_workcell(const Problem& cell, const PlanOptions& options) {
  require_no_hooks(options);
  return plan_workcell(PreparedWorkcell(cell), options);
}

}  // namespace swivel
