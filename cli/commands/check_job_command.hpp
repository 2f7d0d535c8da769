// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/problem/job.hpp"

namespace swivel::cli {

/// Verifies the trajectory or the motion of a job in a file, and prints the verdict. Returns the
/// exit code. Throws InputError.
int check_job_file(const Job& job, const std::string& trajectory);

}  // namespace swivel::cli
