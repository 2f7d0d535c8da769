// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "plan/require_no_hooks.hpp"
#include "study/changes.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/advise.hpp"
#include "workcell/plan_and_measure.hpp"

namespace swivel {

namespace {

/// Makes the follower lead: both tools pass the same poses at their waypoints.
void let_follower_lead(Problem& cell, std::size_t follower) {
  Task &leads = cell.arms[follower].path(), &follows = cell.arms[1 - follower].path();
  for (std::size_t k = 0; k < leads.waypoints.size(); ++k) {
    Waypoint &on_tool = leads.waypoints[k], &tool = follows.waypoints[k];
    const Quaterniond turn = on_tool.orientation.normalized();
    const Quaterniond leader = tool.orientation.normalized();
    const Vector3d at = on_tool.position;
    on_tool.position = tool.position + leader * at;
    on_tool.orientation = leader * turn;
    tool.position = -(turn.conjugate() * at);
    tool.orientation = turn.conjugate();
  }
  leads.path_frame = follows.path_frame;
  follows.path_frame = cell.arms[follower].name;
  std::swap(leads.smooth, follows.smooth);
}

/// Moves the paths that are given in the base frame or in that of an object, or the one of the arm
/// that the advice names, by its offset in the base frame.
void move_paths(Problem& cell, const Advice& advice) {
  for (std::size_t k = 0; k < 2; ++k) {
    ArmTask& arm = cell.arms[k];
    if (cell.leader_of(k) >= 0 || (!advice.arm.empty() && arm.name != advice.arm)) continue;
    Vector3d in_frame = advice.offset;
    for (const SceneObject& object : cell.scene)
      if (object.name == arm.path().path_frame)
        in_frame = object.pose.linear().transpose() * advice.offset;
    for (Waypoint& waypoint : arm.path().waypoints) waypoint.position += in_frame;
  }
}

/// Makes the change of the arms that it is about, where it is no change of paths.
void change_arms(Problem& cell, const Advice& advice) {
  for (ArmTask& arm : cell.arms) {
    if (!advice.arm.empty() && arm.name != advice.arm) continue;
    // a limit of both arms is the stricter one of either: the other one may be relaxed already
    const bool relaxed = advice.arm.empty() && advice.to &&
                         *place_of(advice.change).get(arm.path().limits) <= *advice.to;
    if (relaxed) continue;
    Resolution& resolution = arm.path().resolution;
    if (advice.change == Change::kFiner && !resolution.arc) resolution.arc = kArcOfLayers;
    change_arm(advice, arm, arm.path());
  }
}

/// Returns the workcell with the change.
Problem changed_workcell(const Problem& cell, const Advice& advice) {
  Problem changed = cell;
  if (is_of_scene(advice.change))
    change_scene(advice, changed.scene, changed.vary);
  else if (advice.change == Advice::Change::kMovePaths)
    move_paths(changed, advice);
  else if (advice.change == Advice::Change::kLeads)
    let_follower_lead(changed, cell.arms[0].name == advice.arm ? 0 : 1);
  else
    change_arms(changed, advice);
  return changed;
}

/// Plans changed workcells within one time-out.
class WorkcellTrials {
 public:
  WorkcellTrials(const Problem& cell, const Answer& result, const PlanOptions& options)
      : cell_(cell),
        options_(options),
        end_(Clock::now() +
             std::chrono::duration_cast<Clock::duration>(
                 std::chrono::duration<double>(std::min(options.timeout_s.value_or(1.0), 1e6)))) {
    options_.check = false;
    options_.evidence = {};
    options_.progress = {};
    for (std::size_t k = 0; k < 2; ++k)
      if (result.arms[k].run().status == PlanStatus::kInfeasible) without_path_.push_back(k);
  }

  AdviceList advise() {
    if (without_path_.empty())
      advise_on_conflict();
    else
      advise_on_arms();
    propose_of_both();
    try_all();
    std::stable_sort(advice_.changes.begin(), advice_.changes.end(),
                     [](const auto& a, const auto& b) { return a.outcome < b.outcome; });
    return std::move(advice_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Change = Advice::Change;
  using Outcome = Advice::Outcome;
  using Trial = void (WorkcellTrials::*)(Advice&);

  /// Where both arms have a path by themselves: what lets either of them give way.
  void advise_on_conflict() {
    for (const ArmTask& arm : cell_.arms) {
      if (!arm.given.empty()) continue;
      if (arm.path().start && !arm.path().start_at) propose_of_arm(arm, Change::kFreeStart);
      if (arm.path().end) propose_of_arm(arm, Change::kFreeEnd);
      if (arm.roll && !arm.roll->circle() && !arm.path().start && !arm.path().end)
        propose_of_arm(arm, Change::kFreeRoll);
    }
    relax_both(Change::kClearance);
    for (const ArmTask& arm : cell_.arms)
      if (arm.given.empty()) relax(Change::kJointMargin, arm.name, arm.path().limits.joint_margin);
    for (std::size_t k = 0; k < 2; ++k)
      if (!is_given() && cell_.leader_of(0) < 0 && cell_.leader_of(1) < 0 && !on_one_object())
        propose_moved_paths(cell_.arms[k].name);
  }
  /// Proposes a limit of both arms relaxed, of which the stricter one holds.
  void relax_both(Change change) {
    const LimitPlace place = place_of(change);
    relax(
        change, "",
        std::max(*place.get(cell_.arms[0].path().limits), *place.get(cell_.arms[1].path().limits)));
  }
  void relax(Change change, const std::string& arm, double from) {
    if (!(from > 0)) return;
    Advice advice;
    advice.change = change;
    advice.arm = arm;
    advice.from = from;
    propose(advice, &WorkcellTrials::plan_relaxed);
  }
  /// Returns true if both paths are given in the frame of one object.
  [[nodiscard]] bool on_one_object() const {
    return cell_.arms[0].path().path_frame == cell_.arms[1].path().path_frame &&
           std::any_of(cell_.scene.begin(), cell_.scene.end(), [&](const SceneObject& object) {
             return object.name == cell_.arms[0].path().path_frame;
           });
  }

  /// Where arms have no path by themselves: what gives them one, in half the time.
  void advise_on_arms() {
    const std::optional<PreparedWorkcell> prepared = prepare(cell_, end_);
    if (!prepared) return;
    const Clock::time_point half = Clock::now() + (end_ - Clock::now()) / 2;
    for (std::size_t n = 0; n < without_path_.size(); ++n) {
      const std::size_t k = without_path_[n];
      const Clock::time_point now = Clock::now();
      PlanOptions options = options_;
      options.timeout_s = seconds_until(now + (half - now) / (without_path_.size() - n));
      if (!(*options.timeout_s > 0)) continue;
      // The pointer does not own the robot, which outlives the planner.
      Planner planner(
          std::shared_ptr<const PreparedRobot>(std::shared_ptr<void>(), &prepared->robot(k)),
          prepared->problem(k));
      const PlanResult alone = planner.plan(options);
      options.timeout_s = std::min(*options.timeout_s, seconds_until(half));
      if (!(*options.timeout_s > 0)) continue;
      AdviceAlone& of_arm = advice_.alone.emplace_back(AdviceAlone{cell_.arms[k].name, true, {}});
      of_arm.advice = swivel::advise(planner, alone, options);
      std::erase_if(of_arm.advice, [&](const Advice& one) { return !holds_alone(k, one); });
    }
    if (without_path_.size() > 1) {
      relax_both(Change::kClearance);
      relax_both(Change::kJointMargin);
      return;
    }
    if (advice_.alone.empty()) return;
    for (const Advice& one : advice_.alone.front().advice) {
      Advice of_cell = one;
      if (!is_of_scene(one.change)) of_cell.arm = advice_.alone.front().name;
      of_cell.reached_s.reset();
      of_cell.cost.reset();
      if (one.outcome == Outcome::kFurther) of_cell.outcome = Outcome::kNoHelp;
      if (of_cell.outcome == Outcome::kNoHelp)
        of_cell.offset.setZero(), of_cell.also_offset.setZero();
      // what does not help the arm by itself does not help it beside the other one
      propose(of_cell, one.outcome == Outcome::kSolved ? &WorkcellTrials::plan_changed
                                                       : &WorkcellTrials::leave);
    }
  }
  /// Returns false for a change of an arm that the workcell does not make, or not so: the steps
  /// between its layers are those of both arms, an arm with an arm angle takes no roll, and an
  /// object may carry the other arm's path.
  [[nodiscard]] bool holds_alone(std::size_t arm, const Advice& one) const {
    // A joint that is held may carry both arms.
    if (one.change == Change::kFiner || one.change == Change::kHold) return false;
    if (one.change == Change::kFreeRoll) return cell_.arms[arm].roll.has_value();
    // A leader's tool carries the other arm's path.
    if (one.change == Change::kTurnedOver) return cell_.leader_of(1 - arm) < 0;
    return (one.object.empty() || !carries_path(one.object)) &&
           (one.also.empty() || !carries_path(one.also));
  }

  /// Proposes what changes both arms, or the scene.
  void propose_of_both() {
    for (const SceneObject& object : cell_.scene) {
      Advice of_object;
      of_object.object = object.name;
      of_object.change = Change::kMoveObject;
      const bool carried = carries_path(object.name);
      if (!carried || !is_given()) propose(of_object, &WorkcellTrials::plan_moved);
      of_object.change = Change::kWithoutObject;
      if (!carried) propose(of_object, &WorkcellTrials::plan_changed);
    }
    if (!is_given()) propose_moved_paths("");
    for (std::size_t k = 0; k < 2; ++k)
      if (cell_.leader_of(k) >= 0 && may_lead(k)) propose_of_arm(cell_.arms[k], Change::kLeads);
    Advice finer;
    finer.change = Change::kFiner;
    if (!cell_.given_arm()) propose(finer, &WorkcellTrials::plan_changed);
  }
  void propose_moved_paths(const std::string& arm) {
    Advice moved;
    moved.change = Change::kMovePaths;
    moved.arm = arm;
    propose(moved, &WorkcellTrials::plan_moved);
  }
  [[nodiscard]] bool carries_path(const std::string& object) const {
    return std::any_of(cell_.arms.begin(), cell_.arms.end(),
                       [&](const ArmTask& arm) { return arm.path().path_frame == object; });
  }
  /// Returns true if a start, an end or a motion is given, which stays where paths are moved.
  [[nodiscard]] bool is_given() const {
    return cell_.given_arm() ||
           std::any_of(cell_.arms.begin(), cell_.arms.end(),
                       [](const ArmTask& arm) { return arm.path().start || arm.path().end; });
  }
  [[nodiscard]] bool may_lead(std::size_t follower) const {
    const ArmTask &arm = cell_.arms[follower], &leader = cell_.arms[1 - follower];
    return !cell_.given_arm() && !arm.roll && !leader.roll && !arm.path().start_at &&
           !leader.path().start_at;
  }

  void propose(const Advice& advice, Trial trial) {
    const bool known =
        std::any_of(advice_.changes.begin(), advice_.changes.end(), [&](const Advice& other) {
          return other.change == advice.change && other.object == advice.object &&
                 other.also == advice.also && other.arm == advice.arm;
        });
    if (known) return;
    advice_.changes.push_back(advice);
    trials_.push_back(trial);
  }
  void propose_of_arm(const ArmTask& arm, Change change) {
    Advice advice;
    advice.change = change;
    advice.arm = arm.name;
    propose(advice, &WorkcellTrials::plan_changed);
  }

  /// Tries what was proposed, the expensive trials last, each for at most a third of the time that
  /// is left, so that no trial keeps others from being tried.
  void try_all() {
    std::vector<std::size_t> order(advice_.changes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return dearness(advice_.changes[a].change) < dearness(advice_.changes[b].change);
    });
    for (const std::size_t k : order) {
      const Clock::time_point now = Clock::now();
      trial_end_ = now + (end_ - now) / 3;
      (this->*trials_[k])(advice_.changes[k]);
    }
  }

  [[nodiscard]] static double seconds_until(Clock::time_point end) {
    return std::chrono::duration<double>(end - Clock::now()).count();
  }
  /// Returns the workcell prepared; nothing if the time is up before.
  [[nodiscard]] std::optional<PreparedWorkcell> prepare(const Problem& cell,
                                                        Clock::time_point end) const {
    PlanOptions options = options_;
    options.timeout_s = seconds_until(end);
    if (!(*options.timeout_s > 0)) return std::nullopt;
    try {
      return PreparedWorkcell(cell, options.budget());
    } catch (const Stopped&) {
      return std::nullopt;
    }
  }

  void leave(Advice&) {}

  /// Plans the workcell with the change. The outcome is kUnknown if the time is up.
  void plan_changed(Advice& advice) {
    advice.outcome = Outcome::kUnknown;
    advice.cost.reset();
    try {
      const std::optional<PreparedWorkcell> prepared =
          prepare(changed_workcell(cell_, advice), trial_end_);
      PlanOptions options = options_;
      options.timeout_s = seconds_until(trial_end_);
      if (!prepared || !(*options.timeout_s > 0)) return;
      const Answer found = decide_workcell(*prepared, options, options.budget());
      if (found.status == PlanStatus::kSolved) {
        advice.outcome = Outcome::kSolved;
        advice.cost = found.cost;
      } else if (found.status == PlanStatus::kInfeasible) {
        advice.outcome = Outcome::kNoHelp;
      }
      // The lattice is too fine for the memory, or the form of a workcell does not allow the
      // change.
    } catch (const InputError&) {
      advice.outcome = Outcome::kNoHelp;
    } catch (const InvalidArgument&) {
      advice.outcome = Outcome::kNoHelp;
    }
  }
  void plan_relaxed(Advice& advice) {
    relax_to_strictest(advice, most_relaxed(advice.change, *advice.from),
                       [this](Advice& one) { plan_changed(one); });
  }
  void plan_moved(Advice& advice) {
    const bool paths = advice.change == Change::kMovePaths;
    find_shortest_move(advice, paths ? kPathMoves : kObjectMoves,
                       directions_of_moves(cell_.scene, advice.object),
                       [this](Advice& one) { plan_changed(one); });
  }

  const Problem& cell_;
  PlanOptions options_;
  Clock::time_point end_, trial_end_;
  std::vector<std::size_t> without_path_;  // arms that have none by themselves
  AdviceList advice_;
  std::vector<Trial> trials_;  // of each advice on the workcell
};

}  // namespace

AdviceList advise_workcell(const Problem& cell, const Answer& result, PlanOptions options) {
  require_no_hooks(options);
  if (result.status != PlanStatus::kInfeasible) return {};
  return WorkcellTrials(cell, result, options).advise();
}

}  // namespace swivel
