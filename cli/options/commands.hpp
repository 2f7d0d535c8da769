// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "options/placement_options.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/problem/held_joint.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/io/files/files.hpp"

namespace swivel::cli {

enum ExitCode { kOk = 0, kNo = 1, kBadInput = 2, kStopped = 3, kNoSetUp = 4, kInternalError = 5 };
/// What each exit code says. The README lists them as well.
inline constexpr std::pair<ExitCode, const char*> kExitCodes[] = {
    {kOk, "solved, or passed"},
    {kNo, "no path, or failed"},
    {kBadInput, "bad input: one line says where, what, and what is allowed"},
    {kStopped, "time-out, or cancelled"},
    {kNoSetUp, "set-up failed (of the script that builds the program)"},
    {kInternalError, "an internal error: please report it"}};
/// Returns kExitCodes for people.
[[nodiscard]] std::string exit_codes_text();

/// Each function adds a subcommand to `app`. The callback of the subcommand sets `exit_code`.
void add_plan(CLI::App& app, int& exit_code);
void add_campaign(CLI::App& app, int& exit_code);
void add_place(CLI::App& app, int& exit_code);
void add_merge(CLI::App& app, int& exit_code);
void add_check(CLI::App& app, int& exit_code);
void add_time(CLI::App& app, int& exit_code);
void add_info(CLI::App& app, int& exit_code);
void add_fit(CLI::App& app, int& exit_code);
void add_schema(CLI::App& app, int& exit_code);
/// Adds the command that prints a completion script of all commands of `app`, which must live as
/// long as it.
void add_completion(CLI::App& app, int& exit_code);

/// The options by which plan, check and time can be asked for one episode of a campaign or for one
/// placement.
struct EpisodeChoice {
  std::optional<std::uint64_t> seed, episode;
  PlacementOptions placement;
  void add_to(CLI::App& command);
  /// Returns the problem with its objects as the episode and the placement say. Throws InputError.
  [[nodiscard]] Problem apply(const Problem& problem) const;
  /// Returns words such as "episode 33 of seed 1"; "" if no episode is chosen.
  [[nodiscard]] std::string words() const;

 private:
  /// Throws InputError where the seed or the episode is given without the other, or both for a file
  /// in which nothing varies.
  void require_episodes(const std::vector<Variation>& vary) const;
};

/// Flushes standard output. Throws InputError if it does not take the text, because it is full or
/// closed, and io::ReaderLeft if its reader has left.
void flush_standard_output();

/// Warns on standard error of joints between base and tip that stand still although `hold` does not
/// say where.
void warn_of_held(const std::vector<HeldJoint>& held);

/// Tells on standard error that earlier files were removed, and why.
void report_removed(const std::vector<std::filesystem::path>& files, const std::string& reason);

/// Writes the texts of the outputs beside their targets, calls `print`, and then puts the texts in
/// place: if printing fails, nothing is written. `reason` says why earlier files are removed.
void deliver(io::OutputFiles& outputs, const std::string& reason,
             const std::function<void()>& print);

/// Throws InputError if the name of a file that is to hold CSV has the extension of another format
/// of Swivel's. `option` names the option, `what` the contents, and `instead` what else is allowed.
void require_table_name(const std::string& option, const std::string& file, const std::string& what,
                        const std::string& instead);

/// Calls `work`, and puts the name of the option before the message of an InputError.
template <class Work>
auto in_the_name_of(const std::string& option, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    throw InputError(option + ": " + error.what());
  }
}

}  // namespace swivel::cli
