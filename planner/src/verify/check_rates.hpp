// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

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

/// The speed and acceleration of the joints at one row, rad/s and rad/s^2.
struct RowRates {
  Config v, a;
};
/// Returns speed and acceleration at each row of a motion of at least two rows, by its joints and
/// times. examine_rates() compares the stated ones with these. Times must ascend.
[[nodiscard]] std::vector<RowRates> rates_of_joints(const std::vector<TimedRow>& rows);

}  // namespace swivel
