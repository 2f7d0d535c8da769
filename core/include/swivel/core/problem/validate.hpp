// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

/// Throws InvalidArgument for a value that makes no sense in any problem: numbers that are NaN or
/// infinite, sizes that are not positive, rotations off by more than 1e-6, limits below 0, weights
/// other than 0 and 1e-6 to 1e6, names that are empty, taken or unknown, a robot or mesh that is
/// null. Every function that takes a problem calls it. What is wrong only together with the robot,
/// the path or the lattice throws InputError later. The robot model itself is validated where it is
/// loaded, not here.
void validate(const PathProblem& problem);
/// Throws InvalidArgument for a robot model whose names, indices, rotations, axes, limits or shapes
/// make no sense, or whose links form no tree.
void validate(const RobotModel& robot);
/// Throws InvalidArgument, which names the object, for a pose that is not finite, further than 2 km
/// away, or no rigid transform (to 1e-6).
void validate(const Pose& pose, const std::string& object);

/// Says why the depth of an Allowed entry cannot be kept.
struct DepthFault {
  std::string what, allowed;  ///< in a message: "...: <what>: allowed is <allowed>"
};
/// Returns why the depth of `allowed`, an entry of the object's SceneObject::allow, cannot be kept:
/// a body without a collision shape, a mesh that is not closed, two meshes, or a depth that the two
/// cannot exceed. Returns none where it can be kept, or where no depth is given.
[[nodiscard]] std::optional<DepthFault> depth_fault(const Robot& robot, const SceneObject& object,
                                                    const Allowed& allowed);

/// Returns true if a cost weight is allowed: 0 (moving costs nothing), or 1e-6 to 1e6.
[[nodiscard]] bool weight_allowed(double weight);
/// Says what weight_allowed() allows, to complete a message "allowed is ...".
inline constexpr const char* kAllowedWeights = "0, or a number from 1e-6 to 1e6";

}  // namespace swivel
