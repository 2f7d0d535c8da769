// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>

#include "swivel/core/study/campaign.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel {

struct CampaignOptions {
  std::uint64_t episodes = 100;  ///< of the whole campaign
  std::uint64_t seed = 1;
  Shard shard;
  std::uint64_t skip = 0;  ///< episodes of the shard that are answered already, from its first on
  PlanOptions plan;        ///< threads: episodes planned at once, each by one thread; evidence and progress are ignored
  /// Called by the planning threads, several at a time and in any order, with every answer, before its row.
  std::function<void(std::uint64_t episode, const PlanResult& result)> planned;
};

/// Plans the episodes of a shard and delivers their rows in episode order, one call at a time. Stops when cancelled or timed out;
/// what was delivered is then a beginning of the shard, without a gap. An internal error of an episode is its row, of status
/// kError, without a call of `planned`. Exceptions of the callbacks end the campaign and reach the caller. Throws InvalidArgument
/// as plan() does, InputError where an episode makes no sense, and for a problem without `vary` and more than one episode.
void run_campaign(const PreparedRobot& robot, const Problem& problem, const CampaignOptions& options,
                  const std::function<void(const EpisodeRow&)>& row_done);

}  // namespace swivel
