// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "kinematics/self_motion/self_motion_data.hpp"

namespace swivel {

/// Receives the points of a curve in order, tangents along it; it may change them.
using VisitCurve = std::function<void(std::vector<self_motion::Point>& points, bool closed)>;

/// Visits every self-motion curve at a pose, joint limits ignored; of curves that come in pairs
/// (`data.flip`) one of two. SelfMotion says how curves are found, and what `known` is.
void find_curves(const SelfMotionData& data, const Pose& tool, std::span<const Config> known,
                 const VisitCurve& visit);

}  // namespace swivel
