// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "kinematics/self_motion/self_motion_data.hpp"

namespace swivel {

/// Adds to `arcs` the arcs that the joint limits leave of a curve at the pose `tool`, given by its
/// points in order.
void cut_at_limits(const SelfMotionData& data, const Pose& tool,
                   const std::vector<self_motion::Point>& points, bool closed,
                   std::vector<SelfMotionArc>& arcs);

/// Returns true if a comes before b lexicographically, the first joint first: the order of arcs by
/// their first points.
[[nodiscard]] bool less(const Config& a, const Config& b);

}  // namespace swivel
