// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "kinematics/self_motion/self_motion_data.hpp"

namespace swivel {

/// The points of a curve in order, tangents along it; they may be changed.
using VisitCurve = std::function<void(std::vector<self_motion::Point>& points, bool closed)>;

/// Visits every curve of self-motion at a pose, limits ignored; of those that come in pairs (`data.flip`) one of two. SelfMotion
/// says how they are found, and what `known` is.
void find_curves(const SelfMotionData& data, const Pose& tool, std::span<const Config> known, const VisitCurve& visit);

}  // namespace swivel
