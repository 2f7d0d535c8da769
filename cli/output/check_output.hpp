// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/answer/given_answer.hpp"
#include "swivel/planner/problem/prepared_problem.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel::cli {

/// Prints the verdict on an answer, what was proved of it, how near it is to failing, and one line
/// for each kind of failure.
void print_check(const AnswerCheck& check, const GivenAnswer& given,
                 const PreparedProblem& prepared);

}  // namespace swivel::cli
