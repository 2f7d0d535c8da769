// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/problem/job.hpp"

namespace swivel::cli {

/// Verifies the trajectory of a job as check_job() does and prints what it found. Returns the exit
/// code. Throws InputError for a file that is no trajectory of this job.
int check_job_file(const Job& job, const std::string& trajectory);

}  // namespace swivel::cli
