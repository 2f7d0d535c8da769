// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"

namespace swivel {

/// The kinematic chain that is planned, and its class, which says how its self-motion is computed.
struct PlanningArm {
  ArmModel model;
  ArmClass kind;
};
/// Builds the chain of a robot and classifies it. Throws InputError for an unknown link or an arm
/// that is not supported.
[[nodiscard]] PlanningArm planning_arm(const Robot& robot);

}  // namespace swivel
