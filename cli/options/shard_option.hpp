// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "options/search_options.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"

namespace swivel::cli {

/// What --shard says: I/N, or auto for the share of this task of a Slurm job array. Throws
/// InputError.
[[nodiscard]] Shard shard_from_string(const std::string& text);

/// What rows hang on in every command: version, how is planned, and the contents of all files that
/// were read. Neither threads nor names of outputs.
[[nodiscard]] io::RunSettings run_settings(const std::string& problem_file, const Problem& problem,
                                           const SearchOptions& search,
                                           const std::vector<io::InputFiles::File>& inputs);

}  // namespace swivel::cli
