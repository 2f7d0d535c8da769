// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/io/motions/motion.hpp"
#include "swivel/planner/job/time_job.hpp"

namespace swivel::cli {

/// The options of `time` and `plan` that say how fast a motion is and how it is written.
struct MotionOptions {
  std::optional<double> speed, turn_speed;
  std::optional<double> rate, chord;
  void add_to(CLI::App& command);
  /// Returns the timing that is asked for by --speed; nothing without it. Throws InputError if one
  /// of the other options is given without --speed.
  [[nodiscard]] std::optional<TimingOptions> asked_timing(const Limits& limits) const;
  /// Returns the timing that the options ask for, with the tool speeds of `limits` where none are
  /// given. Throws InputError if there is no speed.
  [[nodiscard]] TimingOptions timing(const Limits& limits) const;
  /// Returns the timing of strokes that the options ask for: with speed 0, for which strokes have
  /// that of the problem file, without --speed. Throws InputError.
  [[nodiscard]] TimingOptions timing_of_strokes() const;
  /// Returns true if a motion of a job is asked for, by --speed, --turn-speed, --rate or --chord.
  [[nodiscard]] bool ask_for_job_motion() const { return speed || turn_speed || rate || chord; }

 private:
  /// Returns --rate, or its default. Throws InputError.
  [[nodiscard]] double checked_rate() const;
};

/// Returns the speeds of the tool that bound a motion whose speed the command line does not give:
/// the limits of one path, and of two arms the lowest tool_speed that one has.
[[nodiscard]] Limits limits_of_speeds(const Problem& problem);

/// Adds the option --out, which may be given several times, each with one name.
void add_out_option(CLI::App& command, std::vector<std::string>& files, const std::string& help);

/// Throws InputError if the name of a file of --out has no extension that io::motion_text() knows.
void require_motion_formats(const std::vector<std::string>& files);

/// Throws InputError as require_table_name() does for a file of --out.
void require_table_names(const std::vector<std::string>& files, const std::string& what,
                         const std::string& instead);

/// Prints the warnings of a motion on standard error.
void warn_of(const Motion& motion);

}  // namespace swivel::cli
