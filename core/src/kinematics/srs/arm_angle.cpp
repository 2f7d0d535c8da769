// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/srs/arm_angle.hpp"

#include <cmath>
#include <utility>

#include "swivel/core/base/angle.hpp"

namespace swivel {

double arm_angle(const SrsArm& arm, const ArmPlane& plane, const Config& q) {
  return plane.angle_of(arm.elbow_axis(q));
}

double conventional_arm_angle(const SrsArm& arm, const Pose& tool, const Config& q) {
  // Axis 4 stands at a right angle to the elbow, to the side that the sign of the elbow says.
  return wrap_angle(arm_angle(arm, first_plane(arm, tool), q) +
                    (std::sin(arm.elbow_angle(q)) > 0 ? kPi : 0));
}

bool is_of_branch(const SrsArm& arm, const Config& q, int branch) {
  if (branch < 0 || branch >= kBranches) return false;
  const double sign_tells = std::sin(arm.exact ? 0.01 : 0.05);
  const std::pair<BranchBit, double> angles[] = {{kShoulderBit, arm.shoulder_angle(q)},
                                                 {kWristBit, arm.wrist_angle(q)},
                                                 {kElbowBit, arm.elbow_angle(q)}};
  for (const auto& [bit, angle] : angles)
    if (std::abs(std::sin(angle)) > sign_tells && ((branch & bit) != 0) != (std::sin(angle) < 0))
      return false;
  return true;
}

}  // namespace swivel
