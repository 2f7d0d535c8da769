// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// Throws InvalidArgument for a value that makes no sense in any problem: NaN and infinity anywhere, sizes that are not positive,
/// rotations that are none (1e-6), limits below 0, weights other than 0 and 1e-6 to 1e6, names that are empty, taken or unknown, a
/// robot or mesh that is null. Called by everything that takes a problem; what the robot, the path and the lattice then find wrong
/// together is InputError. The model of the robot is not looked into: it does not change once it is loaded.
void validate(const Problem& problem);
/// The same of a robot model: indices, one parent a link, no loops, unit axes, limits, shapes.
void validate(const RobotModel& robot);
/// The same of an object's pose.
void validate(const Pose& pose, const std::string& object);

/// Why one of the scene object's Allowed::depth cannot be kept apart from others, and what can be asked for; none where it can.
struct DepthFault {
  std::string what, allowed;  ///< "...: <what>: allowed is <allowed>"
};
[[nodiscard]] std::optional<DepthFault> depth_fault(const Robot& robot, const SceneObject& object, const Allowed& allowed);

/// 0 (the joint moves at no cost), or 1e-6 to 1e6.
[[nodiscard]] bool weight_allowed(double weight);
inline constexpr const char* kAllowedWeights = "0, or a number from 1e-6 to 1e6";

}  // namespace swivel
