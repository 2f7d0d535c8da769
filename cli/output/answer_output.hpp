// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>

#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/planner/problem/problem_planner.hpp"

namespace swivel::cli {

/// Prints an answer with the times and the work of its plan, its certificate, of a size in bytes,
/// and its advice on standard output, and its warnings on standard error.
void print_answer(const Answer& answer, const Problem& problem,
                  const std::optional<AdviceList>& advice,
                  const std::optional<AnyCertificate>& certificate, std::size_t bytes);

/// Prints what timing made of an answer: its refinement unless `quiet`, the main figures of its
/// motion or why there is none, and the warnings of the motion on standard error. `problem` is
/// executed_problem() of the answer.
void print_timed(const Answer& answer, const Problem& problem, bool quiet);

}  // namespace swivel::cli
