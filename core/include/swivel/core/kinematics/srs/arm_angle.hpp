// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/kinematics/srs/srs.hpp"

namespace swivel {

/// Returns the arm angle of joints q (rad) in a plane of the path (docs/model.md): the angle of the
/// fitted arm's elbow axis about the line from shoulder to wrist centre, in [-pi, pi] rad.
[[nodiscard]] double arm_angle(const SrsArm& arm, const ArmPlane& plane, const Config& q);
/// Returns the arm angle of joints q as vendors and Shimizu et al. 2008 measure it: between the
/// base's vertical and the elbow, in the plane normal to the line from shoulder to wrist centre, in
/// [-pi, pi] rad. `tool` is the tool's pose in the base frame.
[[nodiscard]] double conventional_arm_angle(const SrsArm& arm, const Pose& tool, const Config& q);
/// Returns true if joints q belong to an IK branch (BranchBit), as far as their signs tell: near a
/// singular pose they belong to both of its branches.
[[nodiscard]] bool is_of_branch(const SrsArm& arm, const Config& q, int branch);

}  // namespace swivel
