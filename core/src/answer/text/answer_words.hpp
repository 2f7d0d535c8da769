// SPDX-License-Identifier: BSD-3-Clause
// What answer_text() says of each kind of problem.
#pragma once
#include <string>

#include "swivel/core/answer/answer_text.hpp"

namespace swivel {

/// Returns the answer of an arm that runs several strokes, or one with transitions.
[[nodiscard]] std::string text_of_strokes(const Answer& answer, const Problem& problem);
/// Returns the answer of two arms.
[[nodiscard]] std::string text_of_two_arms(const Answer& answer);

}  // namespace swivel
