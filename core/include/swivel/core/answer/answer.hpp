// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/motion.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/answer/refined.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// A part of what an arm does: a run of a stroke, or a transition between runs.
struct Part {
  /// The run of a stroke that the part is; unset where the part is a transition.
  std::optional<StrokeRun> run;
  double cost = 0;  ///< of the rows
  /// The rows of a run are at the layers of its problem (problem_of_run()). Those of a transition,
  /// at least two, are the joint configurations between which the joints move straight; their s,
  /// phi and branch mean nothing.
  std::vector<TrajectoryRow> rows;
  /// Two bodies that bar the straight move, where a transition goes around them by corners.
  std::optional<std::array<std::string, 2>> barred_by = {};
};

/// Returns for each row of a part whether it lies on its stroke, rather than on the lines of
/// approach and retract or in a transition. The stroke of the part must be one of the arm's.
[[nodiscard]] std::vector<bool> process_of_rows(const Part& part, const Problem& problem);

/// What was asked and found about the transitions of an arm.
struct TransitionCounters {
  std::int64_t pairs = 0;     ///< transitions of which it was asked whether they are free
  std::int64_t searches = 0;  ///< searches for a way around obstacles
  std::int64_t rounds = 0;    ///< candidates tried
};

/// Why there is no answer though each run has a path by itself: the transition for which no way was
/// found.
struct NoTransition {
  /// Index in ArmAnswer::runs of the run to which the transition leads; runs.size(): home.
  std::size_t to = 0;
  /// Where two bodies come nearer to each other than transitions may: on the straight move, or
  /// already at home, wherever the run before may end, or wherever the run to which it leads may
  /// begin.
  enum class Where { kBetween, kHome, kEndBefore, kBegin };
  Where where = Where::kBetween;
  std::optional<std::array<std::string, 2>> bodies = {};
};

/// Returns the name of a place in files: "between", "home", "end", "begin".
[[nodiscard]] const char* to_string(NoTransition::Where where);
/// Returns why there is no transition, in words. `runs` has words for each run of the arm, as in
/// "stroke 'ring' backwards".
[[nodiscard]] std::string words(const NoTransition& none, const std::vector<std::string>& runs);

/// A lift-off of an answer, and why the run before it does not go on to the stroke's end.
struct LiftOffAnswer : LiftOff {
  /// Arc length of the stroke, m, that the longest run from the begin of the one before reaches.
  double reached = 0;
  Cause cause;  ///< what ends every run there; Kind::kNone where no single cause is known
};

/// What was found for one arm.
struct ArmAnswer {
  std::string name;  ///< of one arm of two
  bool given =
      false;  ///< its motion was given (ArmTask::given), and its rows are that, bit for bit
  /// Runs and transitions in the order in which they are executed; empty unless solved.
  std::vector<Part> parts;
  /// The parts of the cheapest answer known, where time was up before one was proved; valid rows
  /// from the first layer on, where one arm of two has no path by itself. Maybe none.
  std::vector<Part> partial;
  std::vector<RunAnswer> runs;  ///< in the order in which they are executed
  /// The places where the tool lifts off within strokes: with_lift_offs() makes of these the
  /// problem of which `parts` and `runs` are.
  std::vector<LiftOffAnswer> lift_offs;
  std::optional<NoTransition> no_transition;  ///< where there is no answer for want of a transition
  Counters counters;
  TransitionCounters transitions;
  std::array<std::string, kDof> joint_names;
  std::vector<HeldJoint> held;  ///< joints between base and tip that are not planned
  /// Pairs that touch in every posture, which are not kept apart.
  std::vector<SpecialPair> dropped_pairs;
  /// Pairs near each other by design, which must keep less.
  std::vector<SpecialPair> reduced_pairs;
  std::vector<std::string> warnings;  ///< of one arm of two; else Answer::warnings

  /// Returns the rows of the first part: all rows of an arm that does one stroke and nothing else.
  /// Empty unless solved.
  [[nodiscard]] const std::vector<TrajectoryRow>& rows() const;
  /// Returns the cost of all parts.
  [[nodiscard]] double cost() const;
  /// Returns what was found about the first run, the only one of an arm that does one stroke.
  [[nodiscard]] const RunAnswer& run() const { return runs.front(); }
  [[nodiscard]] RunAnswer& run() { return runs.front(); }
};

/// A place where two arms bar each other: a layer, or the motion from it to the next, and two
/// bodies.
struct ArmConflict {
  int layer = 0;
  bool of_motion = false;
  std::array<double, 2> s{};          ///< of either arm at the layer, m
  std::array<std::string, 2> bodies;  ///< of arm 0 and of arm 1
};

/// How two arms were decided.
enum class PairSearch { kNone, kArmsAlone, kRegions, kProduct };
/// Returns "none", "arms alone", "regions" or "pairs of nodes".
[[nodiscard]] const char* to_string(PairSearch search);

/// What the search of two arms asked and did.
struct PairCounters {
  std::int64_t rounds = 0;  ///< regions of conflict by which pairs of paths were divided
  std::int64_t pops = 0;    ///< pairs of nodes taken by A*
  std::int64_t node_pairs = 0, move_pairs = 0;  ///< questions about both arms
};

/// What was found about two arms together.
struct PairAnswer {
  PairSearch decided_by = PairSearch::kNone;
  /// The first conflict that was met, where each arm has a path by itself and both together have
  /// none.
  std::optional<ArmConflict> conflict;
  /// The row of the trajectories and the bodies of both arms with the least margin. None where no
  /// pair is near, and unless measured.
  std::optional<LeastMargin> nearest;
  bool measured = false;  ///< `nearest` was asked for by Evidence::postures, and is known
  PairCounters counters;
  /// Returns whether `nearest` is known.
  [[nodiscard]] Known nearest_status() const { return known(measured, nearest.has_value()); }
};

/// The answer to a problem: what each of its arms does, or why there is no such motion.
struct Answer {
  PlanStatus status = PlanStatus::kInfeasible;
  /// Cost of all parts of all arms: of the rows of runs, and of the joint moves of transitions in
  /// the same metric; and of lift-offs.
  double cost = 0;
  /// Cost that the search minimised, to which the bounds compare: as `cost`, but of the nodes of
  /// runs in their lattices, which their rows may miss by a little.
  double lattice_cost = 0;
  /// No answer of the lattices' nodes in this order of strokes has a smaller lattice_cost, if its
  /// transitions are those that the planner finds.
  double bound = 0;
  /// No answer of the lattices' nodes in this order of strokes has a smaller lattice_cost, whatever
  /// its transitions. Both bounds are of answers with the same lift-offs.
  double bound_any = 0;
  /// No answer of the lattices' nodes in any order of strokes that the problem allows has a smaller
  /// lattice_cost, if its transitions are those that the planner finds. Of a problem that gives the
  /// order it is `bound`. Of S-R-S arms it is of the knots that strokes have by themselves: steps
  /// halved for a job in one order may make a branch near, and cheap, that they had not.
  double bound_orders = 0;
  bool checked = false;  ///< the parts were verified by check_job() or check_workcell()
  bool refined = false;  ///< the rows are refined ones
  /// What refining brought, where it was asked for and there are rows. Then cost, rows and measures
  /// are those of the refined rows; lattice_cost, bounds and RunAnswer::lattice stay those of the
  /// lattices' paths.
  std::optional<RefinedRuns> refinement;
  /// How a motion in time was asked for; `speed` is 0 where each stroke has its own.
  std::optional<TimingOptions> timing;
  /// The motion, where one was asked for, there are rows, and time was left to make it.
  std::optional<MotionTiming> motion;
  /// There are rows, but time ran out before the refinement or the motion that was asked for.
  bool stopped = false;
  /// One for each arm of the problem. Rows of one number of two arms are simultaneous.
  std::vector<ArmAnswer> arms = std::vector<ArmAnswer>(1);
  PairAnswer pair;  ///< of two arms
  std::string planner;
  int threads = 1;
  std::map<std::string, double> time_ms;  ///< by stage
  std::vector<std::string> warnings;

  /// Returns the only arm, or the first of two.
  [[nodiscard]] const ArmAnswer& arm() const { return arms.front(); }
  [[nodiscard]] ArmAnswer& arm() { return arms.front(); }
  /// Returns whether there are rows: a motion of all arms was found, and where proofs are asked
  /// for, proved.
  [[nodiscard]] bool has_rows() const { return !arms.front().parts.empty(); }
  /// Returns the number of the arm whose motion was given, if one was.
  [[nodiscard]] std::optional<std::size_t> given_arm() const;
  /// Returns the motion in time, if there is one; else null.
  [[nodiscard]] const Motion* timed() const {
    return motion && motion->motion ? &*motion->motion : nullptr;
  }
  /// Returns whether all that was asked for is there: rows, and a motion where one was asked for.
  [[nodiscard]] bool is_whole() const { return has_rows() && (!timing || timed() != nullptr); }
};

/// Returns the answer to a problem of one path.
[[nodiscard]] Answer answer_of(PlanResult result);

/// Returns the names of both arms.
[[nodiscard]] std::array<std::string, 2> names_of_arms(const Answer& answer);
/// Returns the names of the joints of both arms.
[[nodiscard]] std::array<std::array<std::string, kDof>, 2> joint_names_of_arms(
    const Answer& answer);
/// Returns the rows of both arms, each of which does one stroke. Empty unless solved.
[[nodiscard]] std::array<std::vector<TrajectoryRow>, 2> rows_of_arms(const Answer& answer);

/// Returns the problem of which the parts and runs of an answer are: `problem`, with the answer's
/// lift-offs.
[[nodiscard]] Problem executed_problem(const Problem& problem, const Answer& answer);

}  // namespace swivel
