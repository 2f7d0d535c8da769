// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/workcell.hpp"

namespace swivel {

/// Returns the problems that the arms of a workcell pose by themselves (PreparedWorkcell::problem).
/// Throws InputError where the arms share a joint or a link, and as ToolPath does; Stopped.
[[nodiscard]] std::array<Problem, 2> problems_of_arms(const Workcell& cell, const Budget& budget);

}  // namespace swivel
