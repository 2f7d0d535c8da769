// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/graph/verdicts/parallel_for.hpp"
#include "swivel/graph/verdicts/validity.hpp"

namespace swivel {

/// A question how to get from the last configuration of a stroke to the first one of the next.
struct TransitionQuestion {
  /// 0: from home to the first stroke; k: from stroke k - 1 to stroke k; number of strokes: home.
  int transition = 0;
  Config from, to;  ///< joints of the two nodes' rows, rad
  /// True: a way around obstacles is searched for, if no straight one and none known is free.
  bool thorough = false;
};
/// The answer to a TransitionQuestion.
struct TransitionAnswer {
  /// kUnknown: neither the straight move nor a way known before is free, and none was searched for.
  /// kRemoved: a thorough search found no way.
  Verdict verdict = Verdict::kUnknown;
  double cost = 0;  ///< of the way that was found, if kValid; at least Transitions::distance()
};

/// What a job's search needs to know of transitions.
class Transitions {
 public:
  virtual ~Transitions() = default;
  /// Returns the cost of a straight move in joint space: a lower bound of what any transition
  /// costs, a multiple of 2^-40 Lattice::cost_unit().
  [[nodiscard]] virtual double distance(const Config& from, const Config& to) const = 0;
  /// Returns a lower bound of distance(from, to) for all `to` with lower <= to <= upper.
  [[nodiscard]] virtual double least_distance(const Config& from, const Config& lower,
                                              const Config& upper) const = 0;
  /// Sets barred[k] to 1 where no transition can begin or end at configurations[k], else to 0. Both
  /// spans have equal size. Throws Stopped.
  virtual void find_barred(std::span<const Config> configurations,
                           std::span<std::uint8_t> barred) = 0;
  /// Sets answers[k] to the answer to questions[k]. Both spans have equal size. The answers depend
  /// on the questions asked so far in their order alone. Throws Stopped.
  virtual void find(std::span<const TransitionQuestion> questions,
                    std::span<TransitionAnswer> answers) = 0;
};

/// A run of a stroke as the search of a job sees it.
struct SearchedRun {
  CostToGo* cost_to_go = nullptr;  ///< made with Pruning::kNone
  Validity* validity = nullptr;    ///< asked by one thread at a time
  /// Where to note at which steps between knots edges of candidate jobs are not valid, of a lattice
  /// that can halve them; null: nowhere. `bound` and `most` are not used.
  KnotSearch* knots = nullptr;
};

/// A stroke as the search of a job sees it: the runs of which the job takes one, such as forwards
/// and backwards; at least one.
struct SearchedStroke {
  std::vector<SearchedRun> runs;
};

/// How search_job() searches.
struct JobSearchOptions {
  PathFirstOptions paths;  ///< how each run is validated
  /// Most thorough searches for transitions; after these the cheapest job found so far is returned.
  int most_searches = 200;
  /// Most thorough searches that find no way, of all transitions: each takes long, and where some
  /// fail the others mostly do. After these the cheapest job found so far is returned, if any.
  int most_failed_searches = 8;
  /// Jobs that cost so much or more are of no interest: the search ends once none that is cheaper
  /// can be left.
  double most_cost = kUnreachable;
  /// Whether that is judged by what jobs cost whatever their transitions: a later search by the
  /// same Transitions may find cheaper ones.
  bool most_cost_of_any = false;
  ParallelFor work;  ///< shares runs among threads; the result is the same
};

/// A job that was found, or what is known of it.
struct JobOutcome {
  bool decided = false;  ///< false: stopped by the budget, or at narrow steps
  /// Whether steps between knots turned out to be narrow (SearchedRun::knots); false if stopped by
  /// the budget. The search ends without a job where a run finds no new ones for long
  /// (KnotSearch::patience).
  bool narrow = false;
  /// What a job cost at least when it was known first that steps are narrow.
  double narrow_from = kUnreachable;
  /// Index of the first stroke of which no run has a path by itself; none if all have one.
  std::optional<std::size_t> stroke_without_path;
  /// Index of the transition for which no way was found from any end to any begin.
  std::optional<std::size_t> transition_without_way;
  /// A pair of configurations of that transition between which no way was found.
  std::optional<std::array<Config, 2>> pair_without_way;
  /// Where that is so since the transition cannot leave the stroke before it, or reach the stroke
  /// behind it, at any of the nodes at which a run of it may end or begin: one of them.
  std::optional<Config> barred_end, barred_begin;
  std::vector<std::size_t> runs;  ///< taken of each stroke; empty if no job was found
  std::vector<SlotPath> paths;    ///< of these runs
  double cost = kUnreachable;     ///< of the job found
  /// No job whose transitions are those that Transitions finds costs less.
  double bound = 0;
  /// No job costs less whatever its transitions: 0 until all runs are known to be valid.
  double bound_any = 0;
  /// Least cost of each run of each stroke by itself; kUnreachable for a run without a path.
  std::vector<std::vector<double>> least_costs;
  std::vector<double> run_costs, transition_costs;  ///< of the job found
  std::int64_t rounds = 0, pairs = 0, searches = 0;
};

/// Finds the cheapest job: a path through one run of each stroke, the strokes in their order,
/// joined by transitions, from `home` and back to it where it is given. Works as path_first() does,
/// on the runs' lattices joined to one: a backward program over the strokes gives each end node the
/// least cost of the rest of the job (Verdicts::raise_exit_costs()), the cheapest job is taken, its
/// nodes and edges are validated, then its transitions, what fails is removed or raised, and so on.
/// Values only ever rise, so the value of the best job that is left is a lower bound throughout. A
/// greedy job, which runs each stroke at the least cost after the one before, is found first; the
/// result never costs more. Does not throw Stopped: `outcome` then has the cheapest job known.
[[nodiscard]] JobOutcome search_job(std::span<const SearchedStroke> strokes,
                                    Transitions& transitions, const std::optional<Config>& home,
                                    const JobSearchOptions& options);

}  // namespace swivel
