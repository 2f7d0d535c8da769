// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "swivel/core/problem/job.hpp"

namespace swivel::cli {

/// Throws InputError for the first of these options, by name, that is given (true): only problems
/// with one path take them. `kind` says what `file` is one of: "jobs" or "workcells".
void refuse_options(const std::string& kind, const std::string& file,
                    const std::vector<std::pair<bool, const char*>>& options);

/// Throws InputError for a planner that only problems with one path have.
void require_planner_of(const std::string& kind, const SearchOptions& search);

/// Returns the job with the lattice, the episode and the placement that the command line chooses.
/// Throws InputError.
[[nodiscard]] Job chosen_job(Job job, const LatticeOptions& lattice, const EpisodeChoice& episode);

}  // namespace swivel::cli
