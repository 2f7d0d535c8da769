// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/answer/job_result.hpp"

namespace swivel::cli {

/// Returns the answer of a job for people: first the verdict, then a table with a line for each
/// stroke, in the order in which they are run, and a line about the transitions. Where there is no
/// motion it says which stroke has no path and why, or between which two there is no way.
[[nodiscard]] std::string job_text(const JobResult& result, const Job& job);

}  // namespace swivel::cli
