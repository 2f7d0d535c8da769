// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>

#include "swivel/core/study/campaign.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel {

/// Options of run_campaign().
struct CampaignOptions {
  std::uint64_t episodes = 100;  ///< in the whole campaign, all shards together
  std::uint64_t seed = 1;
  Shard shard;
  std::uint64_t skip = 0;  ///< leading episodes of the shard that are answered already
  /// threads: episodes planned at once, each by one thread. timeout_s: of all episodes together.
  /// The tool-path error is found always, the cause where it is asked for, no other evidence;
  /// progress is ignored.
  PlanOptions plan;
  /// Called with every answer before its row is delivered, from the planning threads, several at a
  /// time and in any order.
  std::function<void(std::uint64_t episode, const Answer& answer)> planned;
};

/// Plans the episodes of a shard and calls row_done with their rows in episode order, one call at a
/// time. Stops when cancelled or timed out; the rows delivered are then the beginning of the shard,
/// without a gap. An internal error of an episode becomes its row, of status kError, without a call
/// of `planned`. Exceptions of the callbacks end the campaign and reach the caller. Throws
/// InvalidArgument as plan() does; InputError for an episode whose problem is invalid, and for a
/// problem without `vary` if there is more than one episode.
void run_campaign(const PreparedRobot& robot, const PathProblem& problem,
                  const CampaignOptions& options,
                  const std::function<void(const EpisodeRow&)>& row_done);
/// Plans the episodes of a shard of a problem of one arm: strokes as plan_job() does with one
/// thread. Throws InvalidArgument and InputError as that does.
void run_campaign(const PreparedRobot& robot, const Problem& problem,
                  const CampaignOptions& options,
                  const std::function<void(const EpisodeRow&)>& row_done);
/// Plans the episodes of a shard of any problem: two arms as plan_workcell() does with one thread.
/// An episode in which the given motion of an arm does not keep its limits is infeasible. Throws
/// InvalidArgument and InputError as plan_workcell() does.
void run_campaign(const Problem& problem, const CampaignOptions& options,
                  const std::function<void(const EpisodeRow&)>& row_done);

}  // namespace swivel
