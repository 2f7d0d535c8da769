// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/study/campaign.hpp"
#include "swivel/io/files/files.hpp"
#include "swivel/io/tables/shards.hpp"

namespace swivel::cli {

/// Writes the summary (--json) and the page (--report) of a campaign's rows, and prints the summary
/// if no output goes to standard output. All other outputs must have been written before. `record`:
/// which campaign, and which share of it, was asked for.
void show_campaign(io::OutputFiles& outputs, const std::vector<EpisodeRow>& rows,
                   const io::ShardRecord& record);

/// Returns the exit code for these rows. Prints internal errors that they report.
[[nodiscard]] int campaign_exit_code(const std::vector<EpisodeRow>& rows,
                                     const io::ShardRecord& record);

}  // namespace swivel::cli
