// SPDX-License-Identifier: BSD-3-Clause
// The shards of a campaign, or of placements, and how they become one again. docs/formats.md
// "Shards".
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "swivel/core/study/campaign.hpp"
#include "swivel/core/study/placement.hpp"
#include "swivel/io/tables/campaign.hpp"

namespace swivel::io {

/// What the first line of a shard's results says: which run it is a share of.
struct ShardRecord {
  std::string command;  ///< "campaign" or "place"
  RunSettings settings;
  Shard shard;
  std::uint64_t total = 0;  ///< rows of all shards together
  std::string problem,
      plan_command;  ///< as the page of the run has them: CampaignFacts, PlacementFacts
  std::vector<HeldJoint> held = {};  ///< joints between base and tip that stand still in all rows
  /// Of the settings; "" where there is none.
  [[nodiscard]] std::string setting(const std::string& name) const;
};
/// The line, with its end. The table follows as in the results of a whole run.
[[nodiscard]] std::string to_line(const ShardRecord& record);

using EpisodeRows = std::vector<EpisodeRow>;
using PlacementRows = std::vector<PlacementRow>;

/// A shard's results, or those of a whole run: shard 0 of 1.
struct ShardResults {
  std::string file;  ///< for messages
  ShardRecord record;
  std::variant<EpisodeRows, PlacementRows> rows;
};
/// Throws InputError for anything but a finished shard: one with all its rows, in order.
[[nodiscard]] ShardResults load_shard(const std::filesystem::path& csv);
/// The results of the whole run, with the names that shard 0 has. Throws InputError where one of
/// its shards is missing or there twice, or is of other settings.
[[nodiscard]] ShardResults join_shards(std::vector<ShardResults> shards);

}  // namespace swivel::io
