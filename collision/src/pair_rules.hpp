// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "fcl_shapes.hpp"
#include "swivel/collision/world.hpp"

namespace swivel {

/// Pairs of robot bodies that no rule of the model takes out: the SRDF, one rigid group, parent and child. a < b.
[[nodiscard]] std::vector<BodyPair> candidate_robot_pairs(const RobotModel& robot, const std::vector<RobotBody>& bodies);

/// Drops the pairs that are below d in all of 1000 seeded samples inside the joint limits, where that rule applies: no SRDF, or an
/// attached body (which no SRDF knows). They are too near by design, not by motion.
[[nodiscard]] std::vector<BodyPair> drop_always_near(std::vector<BodyPair> pairs, bool has_srdf, const Chain& chain,
                                                     const std::vector<RobotBody>& bodies, const std::vector<FclShape>& shapes,
                                                     double d, const Budget& budget = {});

}  // namespace swivel
