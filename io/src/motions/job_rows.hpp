// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/job_result.hpp"

namespace swivel::io {

/// Returns for every row of a part of a job whether it lies on its stroke, rather than on the lines
/// of approach and retract or in a transition.
[[nodiscard]] std::vector<bool> process_of_rows(const JobPart& part, const Job& job);

/// Returns true if a row of a stroke of the job has a roll other than 0.
[[nodiscard]] bool any_rolls(const JobResult& result);

}  // namespace swivel::io
