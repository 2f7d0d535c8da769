// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"

namespace swivel {

/// The chain that plans, and how its self-motion is explored.
struct PlanningArm {
  ArmModel model;
  ArmClass kind;
};
/// Throws InputError as PreparedRobot does.
[[nodiscard]] PlanningArm planning_arm(const Robot& robot);

}  // namespace swivel
