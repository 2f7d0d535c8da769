// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// Every count-th episode of a campaign, or every count-th placement, from `index` on: the share of one process.
struct Shard {
  std::uint64_t index = 0, count = 1;
  /// How many of all episodes or placements are in this share.
  [[nodiscard]] std::uint64_t size(std::uint64_t episodes) const {
    return index < episodes ? (episodes - 1 - index) / count + 1 : 0;
  }
  /// The number of its k-th one.
  [[nodiscard]] std::uint64_t episode(std::uint64_t k) const { return index + k * count; }
};

/// The problem of episode `k` under seed `s`: objects named in `vary` moved (SplitMix64 seeded by (s, k) alone; in the order of
/// `vary`, x y z r p y; p' = p + d, R' = Rz Ry Rx R about the object's origin).
[[nodiscard]] Problem episode_problem(const Problem& problem, std::uint64_t seed, std::uint64_t episode);

/// The coordinates in which episodes differ, as "door.x", in the order of `vary` and x y z roll pitch yaw.
[[nodiscard]] std::vector<std::string> varied_coordinates(const std::vector<Variation>& vary);
/// By how much episode_problem() moves objects along them, m and rad.
[[nodiscard]] std::vector<double> episode_offsets(const std::vector<Variation>& vary, std::uint64_t seed, std::uint64_t episode);

/// One line of RESULTS.csv, docs/formats.md. All but plan_ms is independent of threads and shards, and, where
/// the path stays, but what was asked.
struct EpisodeRow {
  std::uint64_t episode = 0;
  PlanStatus status = PlanStatus::kInfeasible;
  std::optional<double> cost;  ///< set when solved, like the tool-path error
  double plan_ms = 0;
  std::int64_t nodes_checked = 0, fcl_calls = 0;
  std::optional<double> tool_path_error_mm_mean, tool_path_error_mm_max;
  std::optional<double>
      failed_s;                 ///< m; where every path has ended; unset when solved, and where not even the first layer has a node
  std::string cause;            ///< to_string(Cause::Kind) of what ends them there; empty when solved
  std::string by;               ///< subject_of() that cause
  std::string reason;           ///< the cause in words, or the message of an internal error; empty when solved
  std::vector<double> offsets;  ///< of the varied_coordinates(), m and rad

  EpisodeRow() = default;
  /// Evidence::tool_path_error must have been asked for. `problem`: any episode's.
  EpisodeRow(std::uint64_t episode, const PlanResult& result, const Problem& problem);
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
