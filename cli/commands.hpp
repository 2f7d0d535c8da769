// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "swivel/core/problem.hpp"

namespace swivel::cli {

/// Exit codes, design.md 4.
enum ExitCode { kOk = 0, kNo = 1, kBadInput = 2, kStopped = 3 };

/// Each adds a subcommand; its callback sets `exit_code`.
void add_plan(CLI::App& app, int& exit_code);
void add_campaign(CLI::App& app, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_info(CLI::App& app, int& exit_code);

/// The episode of a campaign that plan and check can be asked for.
struct EpisodeChoice {
  std::optional<std::uint64_t> seed, episode;
  void add_to(CLI::App& command);
  [[nodiscard]] Problem apply(const Problem& problem) const;
};

}  // namespace swivel::cli
