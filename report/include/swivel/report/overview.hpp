// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "swivel/core/study/campaign.hpp"

namespace swivel {

/// What a campaign's page says besides the rows of RESULTS.csv.
struct CampaignFacts {
  std::string problem;         ///< file name
  std::uint64_t episodes = 0;  ///< of the whole campaign
  std::uint64_t seed = 0;
  Shard shard;
  std::string planner;
  std::string plan_command;              ///< plans one episode, but for "--episode K" at its end
  std::vector<std::string> coordinates;  ///< whose offsets the rows have
};

/// Returns one HTML file that needs nothing else: verdicts, times and costs, where episodes fail
/// and why, and every episode with the command that plans it again. It is made of the rows alone,
/// so a resumed campaign has the page of one that ran through. page_available() says whether this
/// build can make the file.
[[nodiscard]] std::string to_overview(const std::vector<EpisodeRow>& rows,
                                      const CampaignFacts& facts);

}  // namespace swivel
