// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {

/// Proves the rates of a motion of at least two rows, as check_motion() says, or calls `fail` with one line for each that is not
/// kept. `tools`: the tool at each row. None where times do not ascend: nothing can be said of rates then. Throws InputError as
/// joint_rates() does.
[[nodiscard]] std::optional<CheckResult::Motion> examine_rates(const Chain& chain, const Limits& limits, const std::string& source,
                                                               const std::vector<TimedRow>& rows, const std::vector<Pose>& tools,
                                                               const std::function<void(const std::string&)>& fail);

/// Speed and acceleration at each row of a motion of at least two, rad/s and rad/s^2, as its joints and times say: what
/// examine_rates() holds those that are stated against. Times must ascend.
struct RowRates {
  Config v, a;
};
[[nodiscard]] std::vector<RowRates> rates_of_joints(const std::vector<TimedRow>& rows);

}  // namespace swivel
