// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "options/search_options.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"

namespace swivel::cli {

/// Returns the shard that --shard asks for: I/N, or `auto` for the share of this task of a Slurm
/// job array. Throws InputError.
[[nodiscard]] Shard shard_from_string(const std::string& text);

/// Returns what the rows of every command depend on: the version, how paths are planned, and the
/// contents of all files that were read. Threads and names of outputs are left out, since rows do
/// not depend on them.
[[nodiscard]] io::RunSettings run_settings(const std::string& problem_file,
                                           const PathProblem& problem, const SearchOptions& search,
                                           const std::vector<io::InputFiles::File>& inputs);

}  // namespace swivel::cli
