// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "options/placement_options.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/problem/held_joint.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel::cli {

/// Exit codes, as the README lists them.
enum ExitCode { kOk = 0, kNo = 1, kBadInput = 2, kStopped = 3, kInternalError = 5 };

/// Each adds a subcommand; its callback sets `exit_code`.
void add_plan(CLI::App& app, int& exit_code);
void add_campaign(CLI::App& app, int& exit_code);
void add_place(CLI::App& app, int& exit_code);
void add_merge(CLI::App& app, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_time(CLI::App& app, int& exit_code);
void add_info(CLI::App& app, int& exit_code);
void add_fit(CLI::App& app, int& exit_code);
void add_schema(CLI::App& app, int& exit_code);

/// The episode of a campaign, and the placement, that plan, check and time can be asked for.
struct EpisodeChoice {
  std::optional<std::uint64_t> seed, episode;
  PlacementOptions placement;
  void add_to(CLI::App& command);
  [[nodiscard]] Problem apply(const Problem& problem) const;
  /// "episode 33 of seed 1"; "" of none.
  [[nodiscard]] std::string words() const;
};

/// Throws InputError where the text printed so far has not reached standard output: it is full or
/// closed.
void flush_standard_output();

/// Says on standard error which joints between base and tip stand still though `hold` does not say
/// where.
void warn_of_held(const std::vector<HeldJoint>& held);

/// Says on standard error that earlier files are gone, and why.
void report_removed(const std::vector<std::filesystem::path>& files, const std::string& reason);

/// Throws InputError where the name of a file that holds CSV ends as another format of Swivel's
/// does. `what` is in it, `instead` is what else is allowed.
void require_table_name(const std::string& option, const std::string& file, const std::string& what,
                        const std::string& instead);

/// Calls `work`; what the library finds wrong there is said in the name of the option.
template <class Work>
auto in_the_name_of(const std::string& option, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    throw InputError(option + ": " + error.what());
  }
}

}  // namespace swivel::cli
