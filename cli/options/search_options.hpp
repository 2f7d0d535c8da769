// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>
#include <atomic>
#include <optional>
#include <string>

#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel::cli {

/// Which lattice, the same words for `plan`, `campaign` and `check`.
struct LatticeOptions {
  std::string edges;
  std::optional<double> ds, dphi;
  std::optional<bool> arcs;
  void add_to(CLI::App& command);
  /// What the command line says instead of the problem file.
  void apply(Problem& problem) const;
};

/// How to search, the same words for `plan` and `campaign`.
struct SearchOptions : LatticeOptions {
  std::string planner = "parallel";
  int threads = 0;
  void add_to(CLI::App& command);
  /// Planner and threads, and Ctrl-C as the cancel flag.
  [[nodiscard]] PlanOptions plan_options() const;
  /// The options that change answers, as words of a command line, with a space before each; the
  /// planner always.
  [[nodiscard]] std::string words() const;
};

/// The shortest digits that read back as the same number.
[[nodiscard]] std::string shortest(double value);

/// A share in words, as "37 %" or "0.042 %": never 0 of what is more.
[[nodiscard]] std::string percent(double share);

/// A word as a POSIX shell reads it back.
[[nodiscard]] std::string quoted(const std::string& word);

/// Throws InputError where this program was built without the pages of --report.
void require_pages();

/// Throws InputError in the name of the option.
double positive(double value, const char* option);

/// Set by Ctrl-C (SIGINT) and SIGTERM, once they are caught; a second one ends the program at once.
extern std::atomic<bool> interrupted;
void catch_interrupts();

}  // namespace swivel::cli
