// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>
#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/lattice/kinds/unused_keys.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel::cli {

/// The options of `plan`, `campaign` and `check` that choose the lattice.
struct LatticeOptions {
  std::string edges;
  std::optional<double> ds, dphi, knot;
  std::optional<bool> arcs;
  void add_to(CLI::App& command);
  /// Replaces values of the problem file by those that the command line gives.
  void apply(Task& task) const;
  /// Throws InputError for options that are given and of which no lattice makes use.
  void require_used(const std::vector<UnusedKey>& unused) const;
};

/// The options of `plan` and `campaign` that say how to search.
struct SearchOptions : LatticeOptions {
  std::string planner = "parallel";
  int threads = 0;
  bool no_check = false;
  void add_to(CLI::App& command);
  /// Returns plan options with the planner and the threads, and with Ctrl-C as the cancel flag.
  /// Throws InputError.
  [[nodiscard]] PlanOptions plan_options() const;
  /// Returns the options that change answers as words of a command line, with a space before each;
  /// the planner is always among them.
  [[nodiscard]] std::string words() const;
};

/// Returns the keys of problem files that no lattice of a robot's arm reads. `source` is the file
/// for messages.
[[nodiscard]] std::vector<UnusedKey> unused_keys_of(const Robot& robot, const std::string& source);

/// Returns the shortest digits that read back as the same number.
[[nodiscard]] std::string shortest(double value);

/// Returns a word quoted so that a POSIX shell reads it back.
[[nodiscard]] std::string quoted(const std::string& word);

/// Throws InputError if this program was built without the pages of --report.
void require_pages();

/// Returns `value`. Throws InputError, which names the option, unless it is finite and above 0.
double positive(double value, const char* option);

/// Set by Ctrl-C (SIGINT) and SIGTERM after catch_interrupts(). A second signal ends the program at
/// once.
extern std::atomic<bool> interrupted;
void catch_interrupts();

}  // namespace swivel::cli
