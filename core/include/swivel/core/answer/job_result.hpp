// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// A part of a planned job: a run of a stroke, or a transition.
struct JobPart {
  /// The run; of a transition, none.
  std::optional<StrokeRun> run;
  double cost = 0;
  /// Of a run: at the layers of its problem (problem_of_run()). Of a transition: the joint
  /// configurations between which the joints move straight, at least two; s, phi and branch mean
  /// nothing.
  std::vector<TrajectoryRow> rows;
  /// Of a transition with corners: two bodies that bar the straight move.
  std::optional<std::array<std::string, 2>> barred_by = {};
};

/// Returns for each row of a part of a job whether it lies on its stroke, rather than on the lines
/// of approach and retract or in a transition. The stroke of the part must be one of the job's.
[[nodiscard]] std::vector<bool> process_of_rows(const JobPart& part, const Problem& job);

/// What a job's plan found out about one run.
struct RunResult {
  StrokeRun run;
  PlanStatus status = PlanStatus::kSolved;  ///< whether the run by itself has a path
  double least_cost = 0;                    ///< of the run by itself, if it has a path
  LatticeInfo lattice;
  Measures measures;                        ///< of the job's rows
  std::optional<Diagnosis> diagnosis = {};  ///< of a run that has no path by itself
};

/// What was asked and found about the transitions of a job.
struct TransitionCounters {
  std::int64_t pairs = 0;     ///< transitions of which it was asked whether they are free
  std::int64_t searches = 0;  ///< searches for a way around obstacles
  std::int64_t rounds = 0;    ///< candidate jobs tried
};

/// Why there is no job though each run has a path by itself: the transition for which no way was
/// found.
struct NoTransition {
  /// Index in JobResult::runs of the run to which the transition leads; runs.size(): home.
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
/// Returns why there is no transition, in words. `runs` has words for each run of the job, as in
/// "stroke 'ring' backwards".
[[nodiscard]] std::string words(const NoTransition& none, const std::vector<std::string>& runs);

/// A lift-off of an answer, and why the run before it does not go on to the stroke's end.
struct LiftOffResult : LiftOff {
  /// Arc length of the stroke, m, that the longest run from the begin of the one before reaches.
  double reached = 0;
  Cause cause;  ///< what ends every run there; Kind::kNone where no single cause is known
};

/// The result of planning a job.
struct JobResult {
  PlanStatus status = PlanStatus::kInfeasible;
  /// Cost of all parts: of the rows of runs, and of the joint moves of transitions in the same
  /// metric; and of lift-offs.
  double cost = 0;
  /// Cost that the search minimised, to which the bounds compare: as `cost`, but of the nodes of
  /// runs in their lattices, which their rows may miss by a little.
  double lattice_cost = 0;
  /// No job of the lattices' nodes in this order has a smaller lattice_cost, if its transitions are
  /// those that the planner finds.
  double bound = 0;
  /// No job of the lattices' nodes in this order has a smaller lattice_cost, whatever its
  /// transitions. Both bounds are of jobs with the same lift-offs.
  double bound_any = 0;
  /// Where the tool lifts off within strokes: with_lift_offs() makes of these the job of which
  /// `parts` and `runs` are.
  std::vector<LiftOffResult> lift_offs;
  /// Transitions and runs of the answer in the order in which they are executed; empty unless
  /// solved.
  std::vector<JobPart> parts;
  /// Where time was up before an answer was proved: the parts of the cheapest job known, unproved,
  /// with its cost in `cost`; maybe none.
  std::vector<JobPart> partial;
  std::vector<RunResult> runs;                ///< in the order in which they are executed
  std::optional<NoTransition> no_transition;  ///< where there is no job for want of a transition
  std::string planner;
  int threads = 1;
  Counters counters;
  TransitionCounters transitions;
  std::map<std::string, double> time_ms;  ///< by stage
  bool checked = false;                   ///< the parts were verified by check_job()
  std::array<std::string, kDof> joint_names;
  std::vector<HeldJoint> held;
  std::vector<SpecialPair> dropped_pairs, reduced_pairs;
  std::vector<std::string> warnings;
};

/// Returns the job of which the parts and runs of a result are: `job`, with the result's lift-offs.
[[nodiscard]] Problem executed_job(const Problem& job, const JobResult& result);

}  // namespace swivel
