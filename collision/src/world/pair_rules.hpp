// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/collision/world/world.hpp"

namespace swivel::detail {

/// Pairs of robot bodies that no rule of the model takes out: the SRDF, one rigid group, parent and child. a < b.
[[nodiscard]] std::vector<BodyPair> candidate_robot_pairs(const RobotModel& robot, const std::vector<RobotBody>& bodies);

}  // namespace swivel::detail
