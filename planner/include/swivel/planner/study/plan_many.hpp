// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <optional>

#include "swivel/core/study/campaign.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

class PreparedRobot;

/// Options of plan_many().
struct ManyOptions {
  /// threads: problems planned at once, each by one thread. timeout_s: of all plans together, from
  /// the call on. The tool-path error is found always, the cause where it is asked for, no other
  /// evidence; progress is ignored.
  PlanOptions plan;
  std::optional<double> timeout_each_s;  ///< of each plan, s, > 0
  Shard shard;                           ///< of the problems
  std::uint64_t skip = 0;                ///< leading problems of the shard that are answered
  /// Called with every answer before its row is delivered, from the planning threads, several at a
  /// time and in any order.
  std::function<void(std::uint64_t number, const Answer& answer)> planned;
};

/// Returns the problem of a number. Threads call it at the same time.
using ProblemOf = std::function<Problem(std::uint64_t number)>;

/// Plans problems 0 ... `count` - 1 of one robot, of one arm, and calls row_done with their rows in
/// that order, one call at a time; EpisodeRow::episode is the number. A row is what plan() or
/// plan_job() has for its problem, whatever the others are, at any number of threads; only
/// plan_ms is not. Problems with equal tasks share the lattice and the cost-to-go without
/// obstacles, unless problems with more than some 60 other tasks come between them.
///
/// `like`: a problem of the same kind and robot, for which `robot` was prepared. A plan that takes
/// longer than its own time has a row of status kTimeout. Bad input in one problem and an internal
/// error become a row of status kError, without a call of `planned`. Cancelled, or out of time for
/// all, it returns: the rows delivered are then the first ones, without a gap. Exceptions of the
/// callbacks end the run and reach the caller. Throws InvalidArgument for what validate() refuses
/// in `like`, for a robot prepared otherwise, and for options that its kind does not have.
void plan_many(const PreparedRobot& robot, const Problem& like, std::uint64_t count,
               const ProblemOf& problem_of, const ManyOptions& options,
               const std::function<void(const EpisodeRow&)>& row_done);
/// Plans problems of any kind so; those of two arms as plan_workcell() does with one thread.
void plan_many(const Problem& like, std::uint64_t count, const ProblemOf& problem_of,
               const ManyOptions& options, const std::function<void(const EpisodeRow&)>& row_done);

}  // namespace swivel
