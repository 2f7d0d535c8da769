// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// The share of one process in a campaign or a placement study: every count-th episode or
/// placement, from `index` on.
struct Shard {
  std::uint64_t index = 0, count = 1;
  /// Returns how many of all episodes or placements are in this share.
  [[nodiscard]] std::uint64_t size(std::uint64_t episodes) const {
    return index < episodes ? (episodes - 1 - index) / count + 1 : 0;
  }
  /// Returns the number of the share's k-th episode or placement.
  [[nodiscard]] std::uint64_t episode(std::uint64_t k) const { return index + k * count; }
};

/// Returns the problem of an episode under a seed: the objects named in `vary` are moved. Offsets d
/// (m) and angles (rad) are drawn by SplitMix64 seeded by (seed, episode) alone, in the order of
/// `vary`, x y z roll pitch yaw: p' = p + d, R' = Rz Ry Rx R, about the object's origin.
[[nodiscard]] PathProblem episode_problem(const PathProblem& problem, std::uint64_t seed,
                                          std::uint64_t episode);
[[nodiscard]] Problem episode_problem(const Problem& problem, std::uint64_t seed,
                                      std::uint64_t episode);

/// Returns the names of the coordinates in which episodes differ, such as "door.x", in the order of
/// `vary` and x y z roll pitch yaw.
[[nodiscard]] std::vector<std::string> varied_coordinates(const std::vector<Variation>& vary);
/// Returns by how much episode_problem() moves objects along the varied_coordinates(), m and rad.
[[nodiscard]] std::vector<double> episode_offsets(const std::vector<Variation>& vary,
                                                  std::uint64_t seed, std::uint64_t episode);

/// One line of RESULTS.csv, docs/formats.md. All but plan_ms is that of a plan of the episode
/// alone.
struct EpisodeRow {
  std::uint64_t episode = 0;
  PlanStatus status = PlanStatus::kInfeasible;
  std::optional<double> cost;  ///< set when solved, like the tool-path errors
  double plan_ms = 0;
  std::int64_t nodes_checked = 0, fcl_calls = 0;
  std::optional<double> tool_path_error_mm_mean, tool_path_error_mm_max;
  std::optional<double>
      /// Furthest that a valid path comes, m along the path; none when solved, and where not even
      /// the first layer has a node.
      failed_s;
  std::string cause;  ///< to_string(Cause::Kind) of what ends paths there; empty when solved
  std::string by;     ///< what that cause is about, see subject_of()
  /// The cause in words, or the message of an internal error; empty when solved.
  std::string reason;
  std::optional<bool> checked;  ///< whether the answer was proved; none unless solved
  std::vector<double> offsets;  ///< of the varied_coordinates(), m and rad

  EpisodeRow() = default;
  /// Takes an episode's row from its answer, for which Evidence::tool_path_error must have been
  /// asked. Its plan_ms is the time that lattices, search and order took; its counters are those of
  /// all arms; its mean error is that of all runs, weighted by their steps. `problem` may be that
  /// of any episode.
  EpisodeRow(std::uint64_t episode, const Answer& answer, const Problem& problem);
  /// Makes the row of an episode that ended with an internal error.
  EpisodeRow(std::uint64_t episode, std::string error_message);
};

/// The median and the 5th and 95th percentile; zeros without values.
struct Spread {
  double median = 0, p5 = 0, p95 = 0;
};

/// How the episodes of a campaign ended, and how their figures spread.
struct CampaignSummary {
  /// Episodes asked for; fewer have rows if the campaign was interrupted.
  std::uint64_t episodes = 0;
  std::uint64_t solved = 0, infeasible = 0, errors = 0;
  Spread plan_ms, nodes_checked, fcl_calls;
  /// Returns how many episodes were solved or proved infeasible.
  [[nodiscard]] std::uint64_t answered() const { return solved + infeasible; }
};
/// Summarises the rows of a campaign of so many episodes.
[[nodiscard]] CampaignSummary summarize(const std::vector<EpisodeRow>& rows,
                                        std::uint64_t episodes);

}  // namespace swivel
