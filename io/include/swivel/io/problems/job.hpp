// SPDX-License-Identifier: BSD-3-Clause
// Reads jobs: problem files with several strokes. docs/formats.md "Jobs".
#pragma once
#include <filesystem>
#include <string>
#include <variant>

#include "swivel/core/problem/job.hpp"

namespace swivel::io {

/// Returns true if a problem file has the key `strokes`, or allows lift-offs, which makes it a job:
/// load_job() reads it, and load_problem() does not. Throws InputError for a file that is no
/// problem file at all.
[[nodiscard]] bool is_job(const std::filesystem::path& yaml);

/// Loads a job and the files that it names, docs/formats.md "Jobs". A problem file with `path`
/// instead of `strokes` is a job of one stroke named "path". Throws InputError.
[[nodiscard]] Job load_job(const std::filesystem::path& yaml);

/// Returns the text of a problem file that gives this job when it is loaded as `file`, as
/// problem_text() of a problem does. Throws as that does.
[[nodiscard]] std::string problem_text(const Job& job, const std::filesystem::path& file);

/// Writes problem_text() to a file, which is replaced as a whole or left as it was. Throws as
/// problem_text() does, and InputError if the file cannot be written.
void save_problem(const Job& job, const std::filesystem::path& file);

/// Loads a file by load_job() if is_job(), else by load_problem(). It reads the
/// file once, which may be a pipe. Throws InputError.
[[nodiscard]] std::variant<PathProblem, Job> load_problem_or_job(const std::filesystem::path& yaml);

}  // namespace swivel::io
