// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/study/advise.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "study/changes.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

namespace {

using Change = Advice::Change;
using Outcome = Advice::Outcome;

class Adviser {
 public:
  Adviser(const Planner& planner, const RunAnswer& result, const PlanOptions& options)
      : problem_(planner.problem()), result_(result), options_(options), trial_(planner.clone()) {
    constexpr double kSeconds = 1;
    end_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
                              std::min(options.timeout_s.value_or(kSeconds), 1e6)));
    options_.evidence = {};
    options_.progress = {};
  }

  std::vector<Advice> run() {
    if (result_.status != PlanStatus::kInfeasible) return {};
    by_cause(result_.diagnosis->cause);
    for (const Cause& cause : result_.diagnosis->together) by_cause(cause);
    free_given();
    free_roll();
    finer();
    for (const SceneObject& object : problem_.scene)
      if (object.name != problem_.path_frame)
        try_once({.change = Change::kWithoutObject, .object = object.name});
    move(problem_.path_frame);
    hold_elsewhere();
    if (!problem_.start && !problem_.end) try_once({.change = Change::kTurnedOver});
    // Last, because it changes the process as well.
    if (!problem_.roll && !problem_.limits.step_error) {
      const ArmClass& arm = trial_.prepare().arm_class();
      if (arm.srs || !arm.redundant) try_once({.change = Change::kFreeRoll});
    }
    try_all();
    two_objects();
    std::stable_sort(advice_.begin(), advice_.end(), [](const Advice& a, const Advice& b) {
      if (a.outcome != b.outcome) return a.outcome < b.outcome;
      return a.outcome == Outcome::kFurther && a.reached_s > b.reached_s;
    });
    return std::move(advice_);
  }

 private:
  using Clock = std::chrono::steady_clock;

  /// Tries what by_cause() and run() have proposed, the expensive trials last, each for at most a
  /// third of the time that is left, so that no trial keeps others from being tried.
  void try_all() {
    std::vector<std::size_t> order(advice_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return dearness(advice_[a].change) < dearness(advice_[b].change);
    });
    for (const std::size_t k : order) {
      const Clock::time_point now = Clock::now();
      trial_end_ = now + (end_ - now) / 3;
      (this->*trials_[k])(advice_[k]);
    }
  }

  /// Proposes what may help against bodies that come too near or touch.
  void by_contact(const Cause& cause) {
    if (cause.kind == Cause::Kind::kPair && cause.limit && *cause.limit < 0)
      deepen(cause);
    else if (cause.kind == Cause::Kind::kPair)
      relax(Change::kClearance);
    free_given();
    free_roll();
    for (const std::string& body : cause.bodies) {
      move(body);
      if (is_object(body) && body != problem_.path_frame)
        try_once({.change = Change::kWithoutObject, .object = body});
    }
  }

  void by_cause(const Cause& cause) {
    switch (cause.kind) {
      case Cause::Kind::kPair:
      case Cause::Kind::kContact:
        by_contact(cause);
        break;
      case Cause::Kind::kLimit:
        free_given();
        free_roll();
        finer();
        relax(Change::kJointMargin);
        move(problem_.path_frame);
        break;
      case Cause::Kind::kReach:
      case Cause::Kind::kSingular:
        free_roll();
        move(problem_.path_frame);
        break;
      case Cause::Kind::kManipulability:
        relax(Change::kManipulability);
        break;
      case Cause::Kind::kArmSlope:
        relax(Change::kArmSlope);
        break;
      case Cause::Kind::kRollSlope:
        relax(Change::kRollSlope);
        free_roll();
        break;
      case Cause::Kind::kJointStep:
        finer();
        relax(Change::kJointStep);
        break;
      case Cause::Kind::kSpeed:
        relax(Change::kToolSpeed);
        relax(Change::kToolTurnSpeed);
        break;
      case Cause::Kind::kPathError:
        finer();
        relax(Change::kPathError);
        break;
      case Cause::Kind::kAngleError:
        finer();
        relax(Change::kAngleError);
        break;
      case Cause::Kind::kStepError:
        finer();
        relax(Change::kStepError);
        break;
      case Cause::Kind::kNotClosed:
        finer();
        break;
      case Cause::Kind::kNone:
      case Cause::Kind::kNotAsked:
      case Cause::Kind::kCheck:
        break;
    }
  }

  /// Proposes to give no start, and no end.
  void free_given() {
    if (problem_.start && !problem_.start_at) try_once({.change = Change::kFreeStart});
    if (problem_.end) try_once({.change = Change::kFreeEnd});
  }
  /// Proposes a free roll: what blocks the given rolls may not block others.
  void free_roll() {
    if (problem_.roll && !problem_.roll->circle() && !problem_.start && !problem_.end)
      try_once({.change = Change::kFreeRoll});
  }
  void finer() {
    if (result_.diagnosis->holds() != Diagnosis::Holds::kEveryResolution)
      try_once({.change = Change::kFiner});
  }

  [[nodiscard]] bool is_object(const std::string& name) const {
    return std::any_of(problem_.scene.begin(), problem_.scene.end(),
                       [&](const SceneObject& o) { return o.name == name; });
  }

  /// Returns how long the present trial may still take, s.
  [[nodiscard]] double seconds_left() const {
    return std::chrono::duration<double>(trial_end_ - Clock::now()).count();
  }

  /// Returns the problem with the change.
  [[nodiscard]] PathProblem changed_problem(const Advice& advice) const {
    PathProblem changed = problem_;
    if (is_of_scene(advice.change))
      change_scene(advice, changed.scene, changed.vary);
    else
      change_arm(advice, changed, changed);
    return changed;
  }

  /// Plans the problem with the change. The outcome is kUnknown if the time is up.
  void plan_changed(Advice& advice) {
    advice.outcome = Outcome::kUnknown;
    advice.cost.reset();
    advice.reached_s.reset();
    last_cause_ = {};
    options_.timeout_s = seconds_left();
    if (!(*options_.timeout_s > 0)) return;
    PathProblem changed = changed_problem(advice);
    PlanResult found;
    try {
      // another arm: its roll has other limits, its base stands elsewhere, or its tool
      if (dearness(advice.change) == dearness(Change::kFreeRoll)) {
        found = Planner(std::move(changed)).plan(options_);
      } else {
        trial_.set_problem(std::move(changed));
        found = trial_.plan(options_);
      }
      // The lattice is too fine for the memory, or a start does not fit the moved path.
    } catch (const InputError&) {
      advice.outcome = Outcome::kNoHelp;
      return;
    }
    if (found.status == PlanStatus::kSolved) {
      advice.outcome = Outcome::kSolved;
      advice.cost = found.cost;
    } else if (found.status == PlanStatus::kInfeasible) {
      last_cause_ = found.diagnosis->cause;
      advice.reached_s = found.diagnosis->reached_s;
      const double before = result_.diagnosis->reached_s.value_or(-1),
                   step = problem_.resolution.ds;
      advice.outcome = advice.reached_s.value_or(-1) > before + step * (1 + 1e-9)
                           ? Outcome::kFurther
                           : Outcome::kNoHelp;
    }
  }

  using Trial = void (Adviser::*)(Advice&);
  void propose(Advice advice, Trial trial) {
    const bool known = std::any_of(advice_.begin(), advice_.end(), [&](const Advice& other) {
      return other.change == advice.change && other.object == advice.object;
    });
    if (known) return;
    advice_.push_back(std::move(advice));
    trials_.push_back(trial);
  }

  void try_once(Advice advice) { propose(std::move(advice), &Adviser::plan_changed); }

  void relax(Change change) {
    Advice advice{.change = change};
    advice.from = place_of(change).get(problem_.limits);
    if (!advice.from || (relaxed_downwards(change) && *advice.from <= 0)) return;
    propose(std::move(advice), &Adviser::plan_relaxed);
  }

  /// Proposes that the cause's bodies may be deeper in each other, if their depth is what ends the
  /// paths.
  void deepen(const Cause& cause) {
    for (const std::string& name : cause.bodies)
      if (is_object(name))
        propose(
            {.change = Change::kDepth, .object = name, .from = cause.over.value_or(-*cause.limit)},
            &Adviser::plan_relaxed);
  }
  /// Returns the largest factor tried, up to 8, by which bodies can be deeper in the object at all.
  [[nodiscard]] double most_deeper(const std::string& name) const {
    const auto object = std::find_if(problem_.scene.begin(), problem_.scene.end(),
                                     [&](const SceneObject& o) { return o.name == name; });
    for (const double factor : {8., 4., 2., 1.5}) {
      const SceneObject changed = deeper(*object, factor);
      if (std::none_of(changed.allow.begin(), changed.allow.end(), [&](const Allowed& allowed) {
            return depth_fault(problem_, changed, allowed).has_value();
          }))
        return factor;
    }
    return 1.1;
  }

  /// Plans with the limit relaxed as far as is sensible, then for the strictest value that helps.
  void plan_relaxed(Advice& advice) {
    const double most = advice.change == Change::kDepth ? *advice.from * most_deeper(advice.object)
                                                        : most_relaxed(advice.change, *advice.from);
    relax_to_strictest(advice, most, [this](Advice& one) { plan_changed(one); });
  }

  void move(const std::string& name) {
    const bool given = problem_.start || problem_.end;  // which stay when the path moves
    if (!is_object(name) || (given && name == problem_.path_frame)) return;
    propose({.change = Change::kMoveObject, .object = name}, &Adviser::plan_moved);
  }

  void plan_moved(Advice& best) {
    find_shortest_move(best, kObjectMoves, directions_of_moves(problem_.scene, best.object),
                       [this](Advice& one) { plan_changed(one); });
  }

  /// Where no change of one object helps: tries two together, removed, and where paths come further
  /// with the first one moved, moved.
  void two_objects() {
    if (std::any_of(advice_.begin(), advice_.end(), [](const Advice& one) {
          return is_of_scene(one.change) && one.outcome == Outcome::kSolved;
        }))
      return;
    trial_end_ = end_;
    Advice gone{.change = Change::kWithoutObject};
    std::tie(gone.object, gone.also) = two_in_the_way();
    if (gone.also.empty()) return;
    plan_changed(gone);
    advice_.push_back(gone);
    const auto moved = further(Change::kMoveObject, gone.object);
    if (gone.outcome != Outcome::kSolved || moved == advice_.end()) return;
    Advice apart{.change = Change::kMoveObject,
                 .object = gone.object,
                 .offset = moved->offset,
                 .also = gone.also};
    find_shortest_move(
        apart, kObjectMoves, directions_of_moves(problem_.scene, apart.also),
        [this](Advice& trial) { plan_changed(trial); }, &Advice::also_offset);
    if (apart.outcome == Outcome::kSolved) advice_.push_back(apart);
  }
  /// Returns a change with which paths come further, of an object or of any.
  [[nodiscard]] std::vector<Advice>::const_iterator further(Change change,
                                                            const std::string& object = {}) const {
    return std::find_if(advice_.begin(), advice_.end(), [&](const Advice& one) {
      return one.change == change && one.outcome == Outcome::kFurther &&
             (object.empty() || one.object == object);
    });
  }
  /// Returns two objects that end paths: one without which paths come further, and the one that
  /// ends them then; or two that must go together. The second is empty where there are no such.
  [[nodiscard]] std::pair<std::string, std::string> two_in_the_way() {
    const auto gone = further(Change::kWithoutObject);
    if (gone != advice_.end()) {
      Advice one = *gone;
      plan_changed(one);
      return {one.object, object_of(last_cause_, one.object)};
    }
    std::string first = object_of(result_.diagnosis->cause), second;
    for (const Cause& cause : result_.diagnosis->together)
      if (first.empty())
        first = object_of(cause);
      else if (second.empty())
        second = object_of(cause, first);
    return {first, second};
  }
  /// Returns the object of a cause that may go, since it does not carry the path, and is not the
  /// one named `but`; an empty text where there is none.
  [[nodiscard]] std::string object_of(const Cause& cause, const std::string& but = {}) const {
    for (const std::string& name : {cause.object, cause.bodies[0], cause.bodies[1]})
      if (!name.empty() && name != but && name != problem_.path_frame && is_object(name))
        return name;
    return {};
  }

  /// Proposes to hold the joints between base and tip that are not planned elsewhere, where neither
  /// start nor end is given, which would have to stand elsewhere too.
  void hold_elsewhere() {
    if (problem_.start || problem_.end) return;
    for (const HeldJoint& held : trial_.prepare().arm().held)
      if (held.leader.empty())
        propose({.change = Change::kHold,
                 .object = held.name,
                 .slides = held.slides,
                 .from = held.position},
                &Adviser::plan_held);
  }

  /// Finds the position nearest to the present one at which the joint helps: a sixteenth, an
  /// eighth, a quarter, ... of its range away, rounded to 1 mrad or 1 mm.
  void plan_held(Advice& best) {
    const RobotModel& robot = *problem_.model;
    const Joint& joint = robot.joints[static_cast<std::size_t>(robot.find_joint(best.object))];
    const bool continuous = joint.type == Joint::Type::kContinuous;
    const double lower = continuous ? *best.from - kPi : joint.lower,
                 upper = continuous ? *best.from + kPi : joint.upper;
    const Advice unmoved = best;
    best.outcome = Outcome::kNoHelp;
    for (double share = 1.0 / 16; share <= 1 && best.outcome != Outcome::kSolved; share *= 2)
      for (const double way : {-share, share}) {
        Advice moved = unmoved;
        moved.to = std::round(1e3 * (*best.from + way * (upper - lower))) / 1e3;
        if (!(*moved.to >= lower && *moved.to <= upper)) continue;
        plan_changed(moved);
        if (moved.outcome == Outcome::kUnknown) {
          if (best.outcome == Outcome::kNoHelp) best = unmoved;
          return;
        }
        const bool better =
            moved.outcome < best.outcome ||
            (moved.outcome == best.outcome &&
             (moved.outcome == Outcome::kSolved    ? moved.cost < best.cost
              : moved.outcome == Outcome::kFurther ? moved.reached_s > best.reached_s
                                                   : false));
        if (better) best = moved;
      }
  }

  const PathProblem& problem_;
  const RunAnswer& result_;
  PlanOptions options_;
  Planner trial_;
  Clock::time_point end_, trial_end_;
  Cause last_cause_;            // of the trial that was planned last, where it has no path
  std::vector<Advice> advice_;  // equal outcomes are reported in this order
  std::vector<Trial> trials_;   // of each
};

}  // namespace

std::vector<Advice> advise(const Planner& planner, const RunAnswer& result, PlanOptions options) {
  return Adviser(planner, result, options).run();
}

}  // namespace swivel
