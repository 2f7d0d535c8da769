// SPDX-License-Identifier: BSD-3-Clause
// Reads workcells: problem files with two arms. docs/formats.md "Workcells".
#pragma once
#include <filesystem>
#include <variant>

#include "swivel/core/problem/job.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/workcell.hpp"

namespace swivel::io {

/// Loads a problem file with `arms` and the files that it names. Throws InputError.
[[nodiscard]] Workcell load_workcell(const std::filesystem::path& yaml);

/// Loads a file as what its keys make it: with `arms` a workcell, with `strokes` a job, else a
/// problem. It reads the file once, which may be a pipe. Throws InputError.
[[nodiscard]] std::variant<PathProblem, Job, Workcell> load_problem_file(
    const std::filesystem::path& yaml);

}  // namespace swivel::io
