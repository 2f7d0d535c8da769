// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/study/campaign.hpp"
#include "swivel/io/files/files.hpp"
#include "swivel/io/tables/shards.hpp"

namespace swivel::cli {

/// Writes summary (--json) and page (--report) of a campaign's rows, and prints the summary where
/// standard output is free. `record`: which campaign, and which share of it, was asked for. What
/// else is to be written must have been.
void show_campaign(io::OutputFiles& outputs, const std::vector<EpisodeRow>& rows,
                   const io::ShardRecord& record);

/// The exit code that the rows deserve; internal errors are told.
[[nodiscard]] int campaign_exit_code(const std::vector<EpisodeRow>& rows,
                                     const io::ShardRecord& record);

}  // namespace swivel::cli
