// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "kinematics/self_motion/self_motion_data.hpp"

namespace swivel {

/// The arcs that the joint limits leave of a curve are added to `arcs`.
void cut_at_limits(const SelfMotionData& data, const Pose& tool, const std::vector<self_motion::Point>& points, bool closed,
                   std::vector<SelfMotionArc>& arcs);

/// The order of arcs: by their first points, the first joint first.
[[nodiscard]] bool less(const Config& a, const Config& b);

}  // namespace swivel
