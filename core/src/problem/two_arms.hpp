// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// Returns true if a stroke without a name is all that the arm does: neither lines nor speeds nor
/// moves before and after it are set.
[[nodiscard]] bool is_path_alone(const ArmTask& arm);

/// Throws InvalidArgument for a problem of two arms that makes no sense whatever the robot
/// (validate(Problem)).
void validate_two_arms(const Problem& problem);

}  // namespace swivel
