// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/kinematics/srs/srs.hpp"

namespace swivel {

/// Arm angle of joints in a plane of the path (docs/model.md), rad, (-pi, pi].
[[nodiscard]] double arm_angle(const SrsArm& arm, const ArmPlane& plane, const Config& q);
/// Arm angle as vendors and Shimizu 2008 measure it: between the base's vertical and the elbow, in the plane normal to S->W; rad,
/// (-pi, pi].
[[nodiscard]] double conventional_arm_angle(const SrsArm& arm, const Pose& tool, const Config& q);
/// Whether joints are of a branch, as far as their signs tell: near a singular pose, both are.
[[nodiscard]] bool is_of_branch(const SrsArm& arm, const Config& q, int branch);

}  // namespace swivel
