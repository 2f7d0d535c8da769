// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/collision/world/world.hpp"

namespace swivel::detail {

/// Returns the pairs of robot bodies (a < b, indices into `bodies`) that are candidates for
/// self-collision: all but those that the SRDF disables, those in one rigid group, and those on a
/// parent link and its child link.
[[nodiscard]] std::vector<BodyPair> candidate_robot_pairs(const RobotModel& robot,
                                                          const std::vector<RobotBody>& bodies);

}  // namespace swivel::detail
