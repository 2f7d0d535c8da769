// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/answer/answer.hpp"

namespace swivel {

/// Returns what refining the rows of an answer brought, for people: of one path a line, else a line
/// and one for each run or arm. Empty where no refinement was asked for. `problem` is
/// executed_problem() of the answer.
[[nodiscard]] std::string refined_text(const Answer& answer, const Problem& problem);

/// Returns the main figures of the motion of an answer for people, or why there is none. Empty
/// where no motion was made. Of one path a line; with `in_full` one for each rate of joints, each
/// stretch below the speed asked for, and each stop. Of strokes a line: how long the motion takes
/// on strokes (their lines of approach and retract included) and in transitions; or which part has
/// none. Of two arms always in full. `problem` is executed_problem() of the answer.
[[nodiscard]] std::string timed_text(const Answer& answer, const Problem& problem,
                                     bool in_full = false);

}  // namespace swivel
