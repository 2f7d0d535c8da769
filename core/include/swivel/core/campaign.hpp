// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/plan.hpp"

namespace swivel {

/// Every count-th episode from `index` on: the share of one process of a campaign.
struct Shard {
  std::uint64_t index = 0, count = 1;
  /// How many of the campaign's episodes are in this share.
  [[nodiscard]] std::uint64_t size(std::uint64_t episodes) const {
    return index < episodes ? (episodes - 1 - index) / count + 1 : 0;
  }
  /// Its k-th episode.
  [[nodiscard]] std::uint64_t episode(std::uint64_t k) const { return index + k * count; }
};

/// One line of RESULTS.csv, docs/formats.md. All but plan_ms is independent of threads and shards.
struct EpisodeRow {
  std::uint64_t episode = 0;
  PlanStatus status = PlanStatus::kInfeasible;
  std::optional<double> cost;  ///< set when solved, like the tool-path error
  double plan_ms = 0;
  std::int64_t nodes_checked = 0, fcl_calls = 0;
  std::optional<double> tool_path_error_mm_mean, tool_path_error_mm_max;
  std::optional<double>
      failed_s;        ///< m; where every path has ended; unset when solved, and where not even the first layer has a node
  std::string reason;  ///< what ends them there, or the message of an internal error; empty when solved

  EpisodeRow() = default;
  /// Evidence::tool_path_error must have been asked for.
  EpisodeRow(std::uint64_t episode, const PlanResult& result);
  /// An episode that ended with an internal error.
  EpisodeRow(std::uint64_t episode, std::string error_message);
};

/// Median and the range that holds nine tenths; zeros without values.
struct Spread {
  double median = 0, p5 = 0, p95 = 0;
};

struct CampaignSummary {
  std::uint64_t episodes = 0;  ///< asked for; less were answered if the campaign was interrupted
  std::uint64_t solved = 0, infeasible = 0, errors = 0;
  Spread plan_ms, nodes_checked, fcl_calls;
  [[nodiscard]] std::uint64_t answered() const { return solved + infeasible; }
};
[[nodiscard]] CampaignSummary summarize(const std::vector<EpisodeRow>& rows, std::uint64_t episodes);

}  // namespace swivel
