// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>

#include "swivel/core/problem/problem.hpp"

namespace swivel::cli {

/// Verifies the trajectory or the motion of a job in a file, and prints the verdict. `speed`, m/s,
/// is that of the tool along strokes instead of those of the job, of motions alone. Returns the
/// exit code. Throws InputError.
int check_job_file(const Problem& job, const std::string& trajectory, std::optional<double> speed);

}  // namespace swivel::cli
