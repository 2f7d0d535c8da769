// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <vector>

#include "swivel/core/problem/robot_model.hpp"

namespace swivel::io {

/// Returns the indices of the joints that carry a link, fixed ones among them, from the root on.
[[nodiscard]] inline std::vector<int> joints_to(const RobotModel& robot, int link) {
  std::vector<int> joints;
  for (;;) {
    const int joint = robot.links[static_cast<std::size_t>(link)].parent_joint;
    if (joint < 0) break;
    joints.push_back(joint);
    link = robot.joints[static_cast<std::size_t>(joint)].parent_link;
  }
  std::reverse(joints.begin(), joints.end());
  return joints;
}

}  // namespace swivel::io
