// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/stated.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {

/// Proves the rates of a motion of at least two rows, as check_motion() says, and returns them.
/// Calls `fail` with one line for each rate that is not kept. `tools` holds the tool's pose at each
/// row, base frame. Returns none if times do not ascend, because then there are no rates. Throws
/// InputError as joint_rates() does.
[[nodiscard]] std::optional<CheckResult::Motion> examine_rates(
    const Chain& chain, const Limits& limits, const std::string& source,
    const std::vector<TimedRow>& rows, const std::vector<Pose>& tools,
    const std::function<void(const std::string&)>& fail);

/// Computes what the file of a motion does not state of the speeds and accelerations of its rows,
/// rad/s and rad/s^2: those of the joints over the times, at rest before the first row and after
/// the last. examine_rates() compares stated ones with these. Times must ascend.
void complete_rates(std::vector<TimedRow>& rows, const Stated& stated);

}  // namespace swivel
